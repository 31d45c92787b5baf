"""The README's lines for a Python that takes no packages, typed as they stand at one that has the mark."""

from __future__ import annotations

import importlib.util
import os
import re
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest

from tests.paths import ROOT
from tests.processes import HANG
from tests.texts import blocks

MARK = "EXTERNALLY-MANAGED"
REFUSED = "externally-managed-environment"
pytestmark = pytest.mark.skipif(os.name == "nt", reason="no Python of Windows has the mark")


@pytest.fixture(scope="module")
def marked(tmp_path_factory) -> Path:
    """The programs of a Python with pip and the mark, as Debian has it: the files of the one that runs the tests, which
    looks for its modules beside where it lies."""
    if importlib.util.find_spec("ensurepip") is None:
        (pytest.fail if os.environ.get("CI") else pytest.skip)("no ensurepip, which brings pip (Debian: python3-venv)")
    prefix = tmp_path_factory.mktemp("prefix")
    theirs = Path(sysconfig.get_path("stdlib"))
    programs, library = prefix / "bin", prefix / "lib" / theirs.name
    programs.mkdir()
    library.mkdir(parents=True)
    for path in theirs.iterdir():
        if path.name not in ("site-packages", "dist-packages", MARK):
            (library / path.name).symlink_to(path)
    shutil.copy(os.path.realpath(sys.executable), programs / "python3")
    (library / "site-packages").mkdir()
    done = typed("python3 -m ensurepip", programs, prefix)
    assert done.returncode == 0, done.stderr
    (programs / "pip").write_text('#!/bin/sh\nexec python3 -m pip "$@"\n')
    (programs / "pip").chmod(0o755)
    (library / MARK).write_text("[externally-managed]\nError=Ask the administrator.\n")
    return programs


def typed(line: str, programs: Path, home: Path, cwd: Path = ROOT) -> subprocess.CompletedProcess[str]:
    """What comes of a line in a shell that has these programs first, and no uv."""
    kept = {name: value for name, value in os.environ.items()
            if name not in ("VIRTUAL_ENV", "PYTHONPATH", "PYTHONHOME") and not name.startswith("UV_RUN")}
    kept |= {"HOME": str(home), "PATH": f"{programs}:/usr/bin:/bin", "PIP_DISABLE_PIP_VERSION_CHECK": "1"}
    return subprocess.run(["/bin/sh", "-c", line], cwd=cwd, env=kept, text=True, capture_output=True, timeout=HANG)


def line(beginning: str) -> str:
    """A line of a block of the README, as it stands."""
    found = [text.strip() for _, piece in blocks() if piece.page == "README.md" for text in piece.text.splitlines()
             if text.strip().startswith(beginning)]
    return found[0]


def test_a_python_with_the_mark_refuses_the_first_line(marked, tmp_path):
    first = line("pip install -q uv && uv run mpm-lab")
    done = typed(first, marked, tmp_path)
    assert done.returncode == 1 and REFUSED in done.stderr and f"*{REFUSED}*" in (ROOT / "README.md").read_text()


@pytest.mark.slow  # it fetches uv, and installs all that the lab needs
def test_and_takes_the_line_that_is_given_for_it(marked, tmp_path):
    """In a copy of the tree, which has no environment yet; with a command that ends in place of the page."""
    copy = tmp_path / "mpm-lab"
    left_out = shutil.ignore_patterns(".git", ".venv", ".*_cache", "__pycache__", "build", "dist", "uv.lock")
    shutil.copytree(ROOT, copy, ignore=left_out)
    given = line("pip install -q --target")
    assert given.endswith("uv run mpm-lab")
    cache = os.environ.get("UV_CACHE_DIR", os.path.expanduser("~/.cache/uv"))
    done = typed(f"export UV_CACHE_DIR='{cache}'; {given} run bar --cells 8 --json -", marked, tmp_path, copy)
    assert done.returncode == 0 and '"status": "ok"' in done.stdout, done.stderr
    assert (tmp_path / ".uv").is_dir() and not list(marked.parent.glob("lib/*/site-packages/uv*"))
    uv = re.search(r"&& (\S+) run", given)[1]
    done = typed(f"export UV_CACHE_DIR='{cache}'; {uv} run pytest -q -n 0 tests/test_groups.py", marked, tmp_path, copy)
    assert done.returncode == 0, done.stdout + done.stderr
