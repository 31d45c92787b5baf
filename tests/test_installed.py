"""A wheel stands beside packages that are called as our folders are, and in folders that have such names, too."""

from __future__ import annotations

import json
import tarfile
import zipfile
from pathlib import Path

import pytest

from tests.installs import Environment, built, foreign_wheel

NAMES = ("app", "solvers", "lessons", "assets")
WHOSE = "import app, solvers, lessons, assets; print([m.OURS for m in (app, solvers, lessons, assets)])"
SCRIPT = """
from mpm_lab import BarScene, run, sweep

if __name__ == "__main__":
    print(run(BarScene(cells=8, periods=0.1)).error["x"]["max"])
    print([row["status"] for row in sweep("bar", cells=[8, 16], periods=0.1, repeats=0, workers=2)])
"""


@pytest.fixture(scope="module")
def builds(tmp_path_factory):
    """The sdist and the wheel that is built of it."""
    return built(tmp_path_factory.mktemp("builds"))


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """A project of somebody's, with folders and files that are called as ours and as one of Python's."""
    folder = tmp_path_factory.mktemp("project")
    for name in NAMES:
        (folder / name).mkdir()
        (folder / name / "__init__.py").write_text("raise RuntimeError('not ours')\n", encoding="utf-8")
    (folder / "json.py").write_text("raise RuntimeError('not Python itself')\n", encoding="utf-8")
    return folder


def beside_another(order, wheel, folder) -> Environment:
    """An environment where another package with all four names was installed ``before`` ours, or ``after``."""
    environment, other = Environment(folder / "env"), foreign_wheel(folder, NAMES)
    environment.install(*((other, wheel) if order == "before" else (wheel, other)))
    return environment


@pytest.fixture(scope="module")
def crowded(builds, tmp_path_factory):
    return beside_another("after", builds[1], tmp_path_factory.mktemp("crowded"))


def test_a_wheel_brings_one_name(builds):
    with zipfile.ZipFile(builds[1]) as wheel:
        names = {Path(name).parts[0] for name in wheel.namelist() if ".dist-info/" not in name}
    assert names == {"mpm_lab", "mpm_lab.pth"}
    with tarfile.open(builds[0]) as sdist:
        tops = {Path(name).parts[1] for name in sdist.getnames() if len(Path(name).parts) > 1}
    assert {*NAMES, "tests", "README.md", "CHANGELOG.md", "CONTRIBUTING.md", "pyproject.toml"} <= tops


def test_commands_run_beside_packages_and_in_folders_with_the_same_names(crowded, folder):
    done = crowded.run("mpm-lab", "run", "bar", "--cells", 8, "--periods", 0.1, "--json", "-", cwd=folder)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["status"] == "ok"


def test_python_has_solvers_of_ours_and_all_else_of_theirs(crowded, folder, tmp_path):
    (tmp_path / "script.py").write_text(SCRIPT, encoding="utf-8")
    (tmp_path / "solvers.py").write_text("raise RuntimeError('not ours')\n", encoding="utf-8")
    done = crowded.run("python", "script.py", cwd=tmp_path)
    assert done.returncode == 0 and "['ok', 'ok']" in done.stdout, done.stderr
    assert crowded.run("python", "-c", WHOSE, cwd=tmp_path.parent).stdout.strip() == "[False, False, False, False]"
    code = "import mpm_lab, app, solvers; print(app.OURS, solvers.run.__module__)"
    done = crowded.run("python", "-c", code, cwd=tmp_path)
    assert done.stdout.split() == ["False", "solvers.running.run"], done.stderr
    done = crowded.run("python", "-c", "import solvers, mpm_lab", cwd=tmp_path.parent)
    assert "another package called solvers" in done.stderr.splitlines()[-1]


@pytest.mark.parametrize("order", ["before", "after"])
def test_neither_package_takes_anything_from_the_other(order, builds, folder, tmp_path):
    environment = beside_another(order, builds[1], tmp_path)
    assert "04-grid-crossing" in environment.run("mpm-lab", "lesson", "list", cwd=folder).stdout
    assert environment.run("python", "-c", WHOSE, cwd=tmp_path).stdout.strip() == "[False, False, False, False]"
    environment.uninstall("mpm-lab")
    assert environment.run("python", "-c", WHOSE, cwd=tmp_path).stdout.strip() == "[False, False, False, False]"
    assert not [path.name for path in environment.packages.glob("mpm_lab*")]


def test_alone_it_has_its_names_for_all(builds, tmp_path):
    """As in a checkout, so that scripts and extensions need no other imports."""
    environment = Environment(tmp_path / "env")
    environment.install(builds[1])
    done = environment.run("python", "-c", "from solvers import run\nimport mpm_lab, app.cli, solvers.scene.registry\n"
                                           "print(run is mpm_lab.run, mpm_lab.HOME.name)", cwd=tmp_path)
    assert done.stdout.split() == ["True", "packages"], done.stderr


SHOWN = """
import mpm_lab
result = mpm_lab.run(mpm_lab.BarScene(cells=8, periods=0.1))
print(len(result.plot().axes) > 3, "<table" in result._repr_html_(), "<iframe" in mpm_lab.show(result)._repr_html_())
"""


def test_results_are_drawn_beside_another_app(crowded, tmp_path):
    done = crowded.run("python", "-c", SHOWN, cwd=tmp_path)
    assert done.stdout.split() == ["True"] * 3, done.stderr


def test_where_another_app_has_the_place_a_picture_says_so(crowded, tmp_path):
    code = "import app" + SHOWN.replace("result.plot()", "(print(result._repr_html_()) or result.plot())")
    done = crowded.run("python", "-c", code, cwd=tmp_path)
    assert done.stdout.split() == ["None"] and "another package called app" in done.stderr.splitlines()[-1]
