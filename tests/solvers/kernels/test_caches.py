"""A home that takes nothing costs the time to compile, and no run."""

import json
import os
import subprocess
import sys

import pytest

from solvers.kernels import kernel_cache_folder
from tests.support.paths import ROOT
from tests.support.processes import HANG


def homes(tmp_path):
    """Homes in which nobody, not even root, can make the folder of the kernels: there is a file in the way. Of "lies"
    the folder above grants all rights."""
    for kind in ("read only/.cache", "lies/.cache/taichi"):
        (tmp_path / kind).parent.mkdir(parents=True)
        (tmp_path / kind).write_text("", encoding="utf-8")
    home = tmp_path / "read only"
    return {"read only": {"HOME": str(home)}, "none": {}, "lies": {"HOME": str(tmp_path / "lies")},
            "empty": {"HOME": ""}, "relative": {"HOME": str(tmp_path), kernel_cache_folder.HOME: "cache"},
            "named": {"HOME": str(tmp_path), kernel_cache_folder.KERNELS: str(home / ".cache" / "kernels")}}


KINDS = ("read only", "none", "lies", "empty", "relative", "named")
SET = ("HOME", kernel_cache_folder.HOME, kernel_cache_folder.KERNELS, kernel_cache_folder.PICTURES)


@pytest.mark.parametrize("kind", ["lies", *(pytest.param(kind, marks=pytest.mark.slow) for kind in ("none", "named"))])
def test_a_run_ends_well_and_leaves_nothing(kind, tmp_path):
    room = tmp_path / "room"
    room.mkdir()
    kept = {name: value for name, value in os.environ.items() if name not in SET}
    picture = ["--plot", str(tmp_path / "x.png")] if kind == "lies" else []
    done = subprocess.run([sys.executable, "-m", "app", "run", "bar", "--cells", "8", "--periods", "0.1", "--json", "-",
                           *picture], cwd=ROOT, capture_output=True, text=True, timeout=HANG,
                          env=kept | homes(tmp_path)[kind] | {"TMPDIR": str(room)})
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["status"] == "ok" and "Traceback" not in done.stderr
    assert done.stderr.count("Compiled kernels are not kept") == 1
    assert list(room.glob("mpm-lab-*")) == [] and (tmp_path / "x.png").exists() == bool(picture)


@pytest.mark.parametrize("kind", KINDS)
def test_kernels_go_to_a_temporary_folder(kind, tmp_path, monkeypatch):
    monkeypatch.setattr(kernel_cache_folder.atexit, "register", lambda *_: None)
    monkeypatch.setattr(kernel_cache_folder.tempfile, "tempdir", str(tmp_path))
    monkeypatch.setattr(os, "environ", dict(homes(tmp_path)[kind]))
    kernel_cache_folder.ensure_writable_cache_folder()
    [folder] = tmp_path.glob("mpm-lab-*")
    assert os.environ[kernel_cache_folder.HOME] == os.environ[kernel_cache_folder.PICTURES] == str(folder)
    assert kernel_cache_folder.KERNELS not in os.environ


def test_where_all_is_well_nothing_changes(tmp_path, monkeypatch):
    monkeypatch.setenv(kernel_cache_folder.HOME, str(tmp_path / "new"))
    monkeypatch.delenv(kernel_cache_folder.KERNELS, raising=False)
    before = dict(os.environ)
    kernel_cache_folder.ensure_writable_cache_folder()
    assert dict(os.environ) == before and not (tmp_path / "new").exists()
