"""What can only be seen on a machine with a GPU: ``python -m tests.real_gpu``. Prints what it finds.

The tests of ``tests/solvers/running/test_gpu.py`` and ``test_sorted_sums.py`` on that GPU, then how fast it is and
which of two ways to the nodes' sums is faster there, then a ring on 768 cells for a period with the companion beside
it, on the GPU and on the processor: estimates, index, errors and the seconds of both. Where sorted particles gain in
all rows, they are to become what ``PlanarSolver`` takes.
"""

import os
import sys
from dataclasses import replace

import pytest

from app.commands.bench.text import _gpu
from solvers.bench import gpu
from solvers.problems.ring.scene import RingScene
from solvers.running.run import run
from solvers.solver import devices

RING = RingScene(method="cpdi", cells=768, periods=1, estimators=("companion",), effects=("truth", "estimate"))


def sums(found: dict) -> str:
    """Which way to the nodes' sums is faster: that of runs, by atomic additions, or over sorted particles."""
    lines = ["sums of nodes, million particle-steps per second: by atomic additions, over sorted particles, and gained"]
    for row in found["rows"]:
        one, other = row["rates"]["gpu"], row["rates"]["sorted"]
        gained = "one of them went bad" if None in (one, other) else f"{one:10.1f} {other:10.1f} {other / one:8.2f}"
        lines.append(f"  {row['problem']} {row['method']} {row['particles']:,} particles: {gained}")
    return "\n".join(lines)


def main() -> int:
    for kind in devices.KINDS:
        print(kind, devices.found(kind))
    where = devices.place(devices.GPU)
    if where == devices.CPU:
        print("no GPU was found")
        return 1
    os.environ["MPM_LAB_TEST_GPU"] = where
    failed = pytest.main(["-n", "0", "-q", "--slow", "tests/solvers/running/test_gpu.py",
                          "tests/solvers/running/test_sorted_sums.py"])
    found = gpu.gpu(quick=False)
    print(_gpu(found))
    print(sums(found))
    scenes = {"GPU": replace(RING, arch=where), "processor": replace(RING, threads=os.cpu_count() or 1)}
    for name, scene in scenes.items():
        result = run(scene, prices=False)
        print(f"{name}: {scene.particles:,} particles, {result.steps:,} steps in {result.seconds.run:.1f} s, "
              f"{result.rate:.4g} million particle-steps/s, {result.status}, {result.not_valid or 'companion valid'}")
        print("  errors", result.error, "\n  index", result.index["companion"])
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
