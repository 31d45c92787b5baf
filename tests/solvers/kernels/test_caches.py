"""A home that takes nothing costs the time to compile, and no run."""

import json
import os
import subprocess
import sys

import pytest

from solvers.kernels import kernel_cache_folder
from tests.support.paths import ROOT
from tests.support.processes import HANG


def blocked(tmp_path):
    """A folder in which nobody, not even root, can make another: there is a file in the way."""
    (tmp_path / ".cache").write_text("", encoding="utf-8")
    return tmp_path


def homes(tmp_path):
    home = blocked(tmp_path)
    return {"read only": {"HOME": str(home)}, "none": {},
            "named": {"HOME": str(home.parent), "TI_OFFLINE_CACHE_FILE_PATH": str(home / ".cache" / "kernels")}}


@pytest.mark.parametrize("kind", ["read only", *(pytest.param(kind, marks=pytest.mark.slow)
                                                 for kind in ("none", "named"))])
def test_a_run_ends_well_and_leaves_nothing(kind, tmp_path):
    room = tmp_path / "room"
    room.mkdir()
    kept = {name: value for name, value in os.environ.items()
            if name not in ("HOME", kernel_cache_folder.HOME, kernel_cache_folder.KERNELS,
                            kernel_cache_folder.PICTURES)}
    picture = ["--plot", str(tmp_path / "x.png")] if kind == "read only" else []
    done = subprocess.run([sys.executable, "-m", "app", "run", "bar", "--cells", "8", "--periods", "0.1", "--json", "-",
                           *picture], cwd=ROOT, capture_output=True, text=True, timeout=HANG,
                          env=kept | homes(tmp_path)[kind] | {"TMPDIR": str(room)})
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["status"] == "ok" and "Traceback" not in done.stderr
    assert list(room.glob("mpm-lab-*")) == [] and (tmp_path / "x.png").exists() == bool(picture)


def test_where_all_is_well_nothing_changes(tmp_path, monkeypatch):
    monkeypatch.setenv(kernel_cache_folder.HOME, str(tmp_path / "new"))
    monkeypatch.delenv(kernel_cache_folder.KERNELS, raising=False)
    before = dict(os.environ)
    kernel_cache_folder.ensure_writable_cache_folder()
    assert dict(os.environ) == before and not (tmp_path / "new").exists()
