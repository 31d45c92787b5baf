"""The exported file of a body's run: what it holds is what the run has found."""

import base64
import json
import re

import numpy as np
import pytest

from app.cli import main
from app.export.body_page import body_page
from solvers.bodies.body_file import library_text, read_body
from solvers.bodies.run import run_body
from tests.app.export.test_export import tracks

SECTOR = library_text("swinging_sector").replace("cells_per_metre = 16", "cells_per_metre = 8").replace(
    "t_end = 1\n", "t_end = 0.1\n")


def content(page: str) -> tuple[dict, dict[str, np.ndarray]]:
    """The data in a file, and the tracks of its run."""
    data = json.loads(re.search(r'id="data">(.*?)</script>', page, re.DOTALL)[1])
    packed = re.search(r'id="run-0">(.*?)</script>', page, re.DOTALL)[1]
    return data, tracks(data["runs"][0]["tracks"], base64.b64decode(packed))


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    made = tmp_path_factory.mktemp("body") / "<b>sector.toml"
    made.write_text(SECTOR)
    return str(made)


def test_it_holds_the_run(path):
    seen: list[float] = []
    page = body_page(path, seen.append)
    result, (data, found) = run_body(read_body(path)), content(page)
    assert seen[-1] == 1 and "<h1>&lt;b&gt;sector.toml</h1>" in page and page.count("<b>sector") == 0
    head = data["runs"][0]["head"]
    assert found["time"].shape == (61, 1) and found["position"].shape == (61, 2 * result.particles)
    assert found["time"][-1, 0] == pytest.approx(0.1)
    rms = np.sqrt((found["estimate.companion.x"][-1]**2).mean())
    assert rms == pytest.approx(result.estimate["x"].final, rel=0.01)
    goal = result.goals["end"]
    assert found["goal"].min(axis=0)[0] == pytest.approx(goal.value, abs=1e-4)
    assert head["summary"].startswith("End: (0, −0.75) sinks to y = −") and "±" in head["summary"]
    assert [row[0] for row in head["goals"]] == ["goal", "end"] and len(head["estimates"]) == 4
    assert len(head["facts"]["v"]) == len(head["notes"]["v"]) == 61


def test_a_run_that_breaks_is_written_up_to_then(tmp_path):
    """The block leaves its domain; there is no goal, and no curve."""
    file = tmp_path / "gone.toml"
    file.write_text(library_text("thrown_block").replace("[[-1, -1], [3, 2.5]]", "[[-0.1, -0.1], [1.1, 1.1]]")
                    .replace("cells_per_metre = 16", "cells_per_metre = 8").partition("[goals]")[0])
    data, found = content(body_page(str(file), lambda part: None))
    assert "left the domain" in data["runs"][0]["head"]["summary"]
    assert len(found["time"]) < 61 and "goal" not in found and data["runs"][0]["head"]["goal"] is None


def test_the_command(path, tmp_path, capsys):
    assert main(["export", path, "--out", str(tmp_path / "sector.html"), "--lang", "de", "--quiet"]) == 0
    assert "End: (0; −0,75) sinkt bis" in (tmp_path / "sector.html").read_text()
    for words, said in ((["--scorm"], "is a body; --scorm and --core are for lessons"), ([], "cannot be read")):
        name = path if words else "none.toml"
        assert main(["export", name, *words, "--out", str(tmp_path / "a.zip")]) == 2
        assert said in capsys.readouterr().err
