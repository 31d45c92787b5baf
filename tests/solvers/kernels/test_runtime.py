"""Starting Taichi: without the network, and honestly about what runs."""

import subprocess
import sys


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
