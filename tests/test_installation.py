"""A wheel stands beside packages that are called as our folders are, and in folders that have such names, too."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sysconfig
import tarfile
import venv
import zipfile
from pathlib import Path

import pytest

from tests.support.paths import ROOT
from tests.support.processes import HANG

NO_UV = "no uv found, which builds and installs: `uv run pytest` brings it and runs these tests"
SCRIPTS = "Scripts" if os.name == "nt" else "bin"
NAMES = ("app", "solvers", "lessons", "assets")
WHOSE = "import app, solvers, lessons, assets; print([m.OURS for m in (app, solvers, lessons, assets)])"
SCRIPT = """
from mpm_lab import BarScene, run, sweep

if __name__ == "__main__":
    print(run(BarScene(cells=8, periods=0.1)).error["x"]["max"])
    print([row["status"] for row in sweep("bar", cells=[8, 16], periods=0.1, repeats=0, workers=2)])
"""


def uv(*arguments: object) -> None:
    """Run uv; without a network where what it needs has been there before, as it has wherever it runs these tests."""
    program = os.environ.get("UV") or shutil.which("uv")
    if program is None:
        (pytest.fail if os.environ.get("CI") else pytest.skip)(NO_UV)
    for offline in (["--offline"], []):
        line = [program, "-q", *offline, *map(str, arguments)]
        done = subprocess.run(line, capture_output=True, text=True, timeout=HANG)
        if done.returncode == 0:
            return
    raise AssertionError(f"uv {' '.join(map(str, arguments))}: {done.stderr}")


def foreign_wheel(folder: Path) -> Path:
    """Somebody else's package, with modules that are called as ours."""
    path = folder / "other-1-py3-none-any.whl"
    files = {f"{package}/__init__.py": "OURS = False\n" for package in NAMES}
    files |= {"app/cli.py": "OURS = False\n", "solvers/running.py": "OURS = False\n"}
    about = "other-1.dist-info"
    files[f"{about}/METADATA"] = "Metadata-Version: 2.1\nName: other\nVersion: 1\n"
    files[f"{about}/WHEEL"] = "Wheel-Version: 1.0\nGenerator: by hand\nRoot-Is-Purelib: true\nTag: py3-none-any\n"
    files[f"{about}/RECORD"] = "".join(f"{name},,\n" for name in (*files, f"{about}/RECORD"))
    with zipfile.ZipFile(path, "w") as wheel:
        for name, text in files.items():
            wheel.writestr(name, text)
    return path


class Environment:
    """An environment of its own, which has its dependencies from the one that runs the tests, and no more."""

    def __init__(self, folder: Path):
        venv.create(folder, symlinks=os.name != "nt")
        self.folder = folder
        self.python = folder / SCRIPTS / "python"
        self.packages = next(folder.rglob("site-packages"))
        # Of a folder in a .pth the .pth files are not read: an editable install of ours stays out.
        (self.packages / "zz_dependencies.pth").write_text(sysconfig.get_path("purelib"), encoding="utf-8")

    def install(self, *wheels: Path) -> None:
        for wheel in wheels:  # one after the other: what comes last writes over what was there
            uv("pip", "install", "--no-deps", "-p", self.python, wheel)

    def uninstall(self, name: str) -> None:
        uv("pip", "uninstall", "-p", self.python, name)

    def run(self, *words: object, cwd: Path) -> subprocess.CompletedProcess[str]:
        """A command of it, as a person would type it in the folder ``cwd``."""
        kept = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "VIRTUAL_ENV")}
        return subprocess.run([str(self.folder / SCRIPTS / str(words[0])), *map(str, words[1:])], cwd=cwd, text=True,
                              env=kept, capture_output=True, timeout=HANG)


@pytest.fixture(scope="module")
def builds(tmp_path_factory):
    """The sdist and the wheel that is built of it."""
    out = tmp_path_factory.mktemp("builds")
    uv("build", "--out-dir", out, ROOT)
    return next(out.glob("*.tar.gz")), next(out.glob("*.whl"))


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
    environment, other = Environment(folder / "env"), foreign_wheel(folder)
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
    done = environment.run(
        "python", "-c", "from solvers import run\nimport mpm_lab, app.cli, solvers.scene.estimator_registry\n"
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
