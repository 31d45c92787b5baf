"""Lessons and the README make claims; here they are run."""

from __future__ import annotations

import re
import textwrap

import pytest

from app.lessons.checking import checks
from app.lessons.outcomes import Outcomes, scene_texts
from app.lessons.shelf import lessons, names
from solvers.problems.bar.scene import BarScene
from solvers.problems.ring.scene import RingScene
from solvers.running.run import run
from tests.paths import LESSONS

LONG = ("07", "09")  # lessons that run what tests of the Cost tab and of each estimator run, for half a minute each


@pytest.fixture(scope="module")
def outcomes():
    """Runs are shared by the tests of this file; in the suite each lesson is checked with its first numbers."""
    found = Outcomes(processes=2)
    yield found
    found.close()


@pytest.mark.parametrize("name", [pytest.param(name, marks=pytest.mark.slow) if name[:2] in LONG else name
                                  for name in names()])
def test_every_claim_of_a_lesson_holds(name, outcomes):
    lesson = lessons()[name]
    outcomes.prepare(scene_texts(lesson, lesson.variants[0]), lambda done, total: None)
    found = list(checks(lesson, outcomes, variants=1))
    assert [str(check) for check in found if not check.holds] == []
    assert len(found) > 10


@pytest.mark.slow
@pytest.mark.parametrize("name", names())
def test_every_claim_holds_with_all_numbers(name, outcomes):
    assert [str(check) for check in checks(lessons()[name], outcomes) if not check.holds] == []


def edited(name: str, **values) -> str:
    """The text of a script with other parameters, as a student would write them."""
    text = (LESSONS / "scripts" / name).read_text(encoding="utf-8")
    for parameter, value in values.items():
        line = re.compile(rf"^{parameter} = [^#\n]*?(?=  #|$)", re.MULTILINE)
        text, times = line.subn(f"{parameter} = {value!r}", text)
        assert times == 1, f"{name} has no line for {parameter}"
    return text


BAR = dict(method="bspline", cells=10, ppc=2, amplitude=1e-3, modulus=9.0, density=2.0, cfl=0.2, periods=0.5,
           body_force="node", linearity_preserving=True)
RING = dict(method="ugimp", cells=8, ppc=1, amplitude=0.05, modulus=4e6, density=500.0, cfl=0.2, periods=0.25,
            body_force="material", layout="cartesian")


@pytest.mark.parametrize("name, scene, parameters", [
    ("bar.py", BarScene, {}), ("ring.py", RingScene, {}), ("bar.py", BarScene, BAR),
    pytest.param("ring.py", RingScene, RING, marks=pytest.mark.slow),
], ids=["bar", "ring", "bar, edited", "ring, edited"])
def test_scripts(name, scene, parameters, tmp_path, monkeypatch, capsys):
    """A script runs as it is and edited, obeys every parameter, prints what ``run`` finds and leaves a picture."""
    monkeypatch.chdir(tmp_path)
    done: dict = {}
    exec(compile(edited(name, **parameters), name, "exec"), done)
    assert all(getattr(done["scene"], parameter) == value for parameter, value in parameters.items())
    assert type(done["scene"]) is scene
    printed = capsys.readouterr().out
    result = run(done["scene"], prices=False)
    found = [result.errors()["x"]["max"], result.estimates(done["estimator"])["x"]["max"]]
    assert all(f"{value:.3e}" in printed for value in found)
    assert f"{result.index(done['estimator'])['x']:.3f}" in printed
    assert (tmp_path / done["picture"]).read_bytes().startswith(b"\x89PNG")


def test_python_lines_of_the_readme(capsys):
    """The first indented lines that begin with an import run as they stand."""
    text = (LESSONS.parent / "README.md").read_text(encoding="utf-8")
    block = re.search(r"(?:^    .*\n|^\n)+(?=\S)", text[text.index("    from solvers"):], re.MULTILINE)
    exec(textwrap.dedent(block.group()), {})
    assert re.fullmatch(r"largest error of x: \S+ m; estimated over true: (1\.00|0\.99)\d*\n", capsys.readouterr().out)
