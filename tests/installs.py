"""Installed as others have it: a wheel of this tree in an environment of its own, beside others with the same names."""

from __future__ import annotations

import os
import shutil
import subprocess
import sysconfig
import venv
import zipfile
from collections.abc import Iterable
from pathlib import Path

import pytest

from tests.paths import ROOT
from tests.processes import HANG

NO_UV = "no uv found, which builds and installs: `uv run pytest` brings it and runs these tests"
SCRIPTS = "Scripts" if os.name == "nt" else "bin"


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


def built(out: Path) -> tuple[Path, Path]:
    """The sdist of this tree, and the wheel that is built of it."""
    uv("build", "--out-dir", out, ROOT)
    return next(out.glob("*.tar.gz")), next(out.glob("*.whl"))


def foreign_wheel(folder: Path, packages: Iterable[str]) -> Path:
    """Somebody else's package, with modules that are called as ours."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "other-1-py3-none-any.whl"
    files = {f"{package}/__init__.py": "OURS = False\n" for package in packages}
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

    def run(self, *words: object, cwd: Path, **environment: str) -> subprocess.CompletedProcess[str]:
        """A command of it, as a person would type it in the folder ``cwd``."""
        kept = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "VIRTUAL_ENV")}
        return subprocess.run([str(self.folder / SCRIPTS / str(words[0])), *map(str, words[1:])], cwd=cwd, text=True,
                              env=kept | environment, capture_output=True, timeout=HANG)
