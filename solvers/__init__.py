"""The Material Point Method and its error estimates, without a user interface: Scene -> Solver -> Result.

What a user needs stands here, and is imported when it is first asked for::

    from solvers import BarScene, run

    print(run(BarScene(cells=80, estimators=("companion",))).error["x"]["max"], "m")
"""

import importlib
import os
from typing import TYPE_CHECKING

from solvers.kernels import kernel_cache_folder

if TYPE_CHECKING:
    from solvers.bodies.body import Body
    from solvers.bodies.body_file import read_body
    from solvers.bodies.goal import Goal
    from solvers.bodies.patch import Patch
    from solvers.bodies.run import run_body
    from solvers.judging.check import check
    from solvers.judging.judgement import judge
    from solvers.problems.bar.scene import BarScene
    from solvers.problems.ring import RingScene
    from solvers.problems.square import SquareScene
    from solvers.problems.vortex import VortexScene
    from solvers.running.cure_trials import try_cures
    from solvers.running.result import Result
    from solvers.running.run import run
    from solvers.scene.validation import SceneError
    from solvers.study.sweep import sweep
    from solvers.untrusted.quoting import FileError
else:
    _HOMES = {"BarScene": "problems.bar.scene", "RingScene": "problems.ring", "VortexScene": "problems.vortex",
              "SquareScene": "problems.square", "run": "running.run", "sweep": "study.sweep",
              "try_cures": "running.cure_trials", "judge": "judging.judgement", "check": "judging.check",
              "Body": "bodies.body", "Patch": "bodies.patch", "Goal": "bodies.goal", "read_body": "bodies.body_file",
              "run_body": "bodies.run",
              "Result": "running.result", "SceneError": "scene.validation", "FileError": "untrusted.quoting"}

    def __getattr__(name):
        if name not in _HOMES:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        return getattr(importlib.import_module(f"{__name__}.{_HOMES[name]}"), name)

__all__ = ["BarScene", "RingScene", "VortexScene", "SquareScene", "run", "try_cures", "sweep", "judge", "check",
           "Body", "Patch", "Goal", "read_body", "run_body", "Result", "SceneError", "FileError"]


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})


# For Taichi, at its first import: no banner, no request for its latest version at every start, and no collection of
# kernels' prints after each launch, which it does in notebooks, with a message; our kernels print nothing.
os.environ.setdefault("ENABLE_TAICHI_HEADER_PRINT", "0")
os.environ["TI_SKIP_VERSION_CHECK"] = "ON"
os.environ.setdefault("TI_ENABLE_PYBUF", "0")
# For numpy, unless it is imported already: matrices here are small, and a second thread would wait more than it
# computes, on busy CPUs for seconds.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
kernel_cache_folder.raise_cache_size()
kernel_cache_folder.ensure_writable_cache_folder()
