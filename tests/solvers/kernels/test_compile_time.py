"""What the compiler has to work through, counted, because seconds depend on what else a machine does."""

import os
import re
import subprocess
import sys

import pytest

#: Statements that the compiler merges with an equal one, each with two walks through the whole kernel: most of its
#: time. Counted, with a tenth to spare: 2740 since the acceleration goes on by a parabola, of two steps before, and not
#: by a line that was wrong by three times its error; they were 6027 before numbers were read and written down once.
MOST_MERGED = 3000

COMPILE = """
import taichi as ti
from solvers.problems.ring.scene import RingScene
from solvers.running.run import build
build(RingScene(estimators=("recovered",))).advance(0)
ti.profiler.print_scoped_profiler_info()
"""


@pytest.mark.slow
def test_the_longest_kernel_stays_as_long_as_it_is():
    done = subprocess.run([sys.executable, "-c", COMPILE], capture_output=True, text=True, check=True,
                          env={**os.environ, "TI_OFFLINE_CACHE": "0"})
    plain = re.sub(r"\x1b\[[0-9;]*m", "", done.stdout)
    profile = plain[plain.index("compile_kernel"):]
    merged = re.search(r"whole_kernel_cse .*\n.* replace_all_usages_with +\[(\d+) x", profile)
    assert merged is not None
    assert 0 < int(merged[1]) <= MOST_MERGED
