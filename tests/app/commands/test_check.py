"""``mpm-lab check``: verdict, exit status, report in all forms, and claims."""

import json

import numpy as np
import pytest

from app.cli import main
from tests.solvers.judging.test_check import motion, stuck

KEYS = {"schema", "verdict", "files", "particles", "dimensions", "times", "quantities", "reference", "notes",
        "not_read", "spacing", "motion", "findings", "contradictions", "not_told", "never_told"}
OF_FINDINGS = {"finding", "verdict", "measured", "limit", "unit", "says", "t", "particle", "X"}


@pytest.fixture
def files(tmp_path):
    """A smooth motion, and the same with a particle that is stuck."""
    good, bad = motion(), motion()
    bad["x"] = stuck(bad["x"])
    for name, arrays in (("good", good), ("bad", bad)):
        np.savez(tmp_path / f"{name}.npz", **arrays)
    return str(tmp_path / "good.npz"), str(tmp_path / "bad.npz")


def test_a_consistent_motion_is_not_called_right(files, tmp_path, capsys):
    assert main(["check", files[0], "--quiet", "--json", "-"]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed.keys() == KEYS and printed["verdict"] == "consistent" and printed["contradictions"] == 0
    assert all(one.keys() == OF_FINDINGS for one in printed["findings"])
    assert main(["check", *files]) == 2 and "give each time once" in capsys.readouterr().err
    assert main(["check", files[0]]) == 0
    said = capsys.readouterr().out
    assert "No contradiction was found. That is not to say that the run is right." in said and "sigma" in said


def test_a_contradiction_is_exit_status_3_with_its_particle_and_place(files, tmp_path, capsys):
    out = tmp_path / "out"
    assert main(["check", files[1], "--out", str(out)]) == 3
    assert "(particle 77 at X = 0.5417, 0.4583)" in capsys.readouterr().out
    assert {path.name for path in out.iterdir()} == {"report.md", "report.html", "report.json", "places.png"}
    page = (out / "report.html").read_text(encoding="utf-8")
    assert "data:image/png" in page and "default-src 'none'" in page and "script-src" not in page


@pytest.mark.parametrize("which, claim, status", [(0, "contradictions == 0", 0), (1, "contradictions == 0", 1),
                                                  (1, "broken == 0", 0), (0, "particles > 1000", 1)])
def test_claims_decide_where_there_are_some(files, which, claim, status, capsys):
    assert main(["check", files[which], "--quiet", "--expect", claim]) == status
    assert ("DOES NOT HOLD" in capsys.readouterr().err) == (status == 1)
