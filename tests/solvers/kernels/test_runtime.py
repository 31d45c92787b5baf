"""Starting Taichi: without the network, and honestly about what runs."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest

from app.cli import main


@pytest.mark.parametrize("arch", ["cpu", "gpu"])
def test_arch_that_really_ran_is_recorded(arch, capsys):
    """Asking for a GPU where there is none is no crash: the run falls back and the result says so."""
    assert main(["run", "bar", "--cells", "8", "--periods", "0.1", "--json", "-", "--arch", arch]) == 0
    result = json.loads(capsys.readouterr().out)
    assert result["scene"]["arch"] == arch
    assert result["arch"] in (("x64", "arm64") if arch == "cpu" else ("x64", "arm64", "cuda"))


def test_no_network_at_run_time():
    """No socket to another machine is opened by starting Taichi and running a scene (Python's audit hook sees all)."""
    code = """
import sys, threading
asked = []
def hook(event, args):
    if event in ("socket.connect", "socket.getaddrinfo", "urllib.Request"):
        asked.append((event, args))
sys.addaudithook(hook)
from solvers.problems.bar.scene import BarScene
from solvers.running.run import run
run(BarScene(cells=8, periods=0.1, effects=(), estimators=()))
for thread in threading.enumerate():
    if thread is not threading.current_thread():
        thread.join(3)
sys.exit(str(asked) if asked else 0)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
