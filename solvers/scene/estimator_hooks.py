"""Interface of an error estimator: its memory, its hooks in a step, and its report.

A problem's estimator is one :class:`EstimatorHooks`, called ``HOOKS``, at the end of its file. Several can run in a
scene; number e reports particle p's estimated errors in entry ``e * particles + p`` of the state's ``estimate`` arrays.
It may use whatever the method computes, the body force and the initial state; never the exact solution.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

NEVER = 2**31 - 1  # an interval that no step is a multiple of: the estimator is left out, to time the others


@dataclass(frozen=True)
class EstimatorHooks:
    """Hooks of one estimator for one problem. ``state`` are the arrays of a run, ``base`` is the estimator's first
    entry in ``state.estimate``, ``on`` are the compile-time options.

    ``memory`` has the names of its numbers and arrays, each with the estimator's name in front, with their Taichi
    types; ``allocate(scene)`` returns their values at the start, by name, ``interval(scene)`` the number of steps of
    the run between two of its own. The next three are Taichi functions, or None:

    * ``in_step(state, base, on)`` is called in every step that is a multiple of the interval, between the update of the
      nodes and that of the particles, when the step's weights and the nodes' new motion are known;
    * ``after_step(state, base, step, on)`` at the end of these steps; ``step`` is the number of steps taken;
    * ``report(state, base, step, on)``, only for samples and frames, fills entries ``base`` to ``base + particles`` of
      the estimate arrays for the state after ``step`` steps, whether or not that is a multiple of the interval. The
      acceleration is the one that the last step used, which belongs to the time one step earlier.

    ``standalone(scene)`` returns a body that the CPU solves in parallel to particles on a GPU
    (``solvers.problems.planar.plans``), from whose nodes ``report_at_once(state, base, step, on)``, a Taichi function,
    fills the entries for all particles at once; both are None where the estimator needs particles on a CPU.

    ``verdict(scene, memory)`` returns from the arrays of a run why the estimate cannot be trusted, one sentence that
    begins with "not valid here: ", or None. Reasons that are known beforehand are in the scene's ``LIMITS``.
    """

    memory: Mapping[str, object]
    allocate: Callable[[Any], dict]
    interval: Callable[[Any], int]
    in_step: Callable | None = None
    after_step: Callable | None = None
    report: Callable | None = None
    standalone: Callable[[Any], Any] | None = None
    report_at_once: Callable | None = None
    verdict: Callable[[Any, Mapping], str | None] = field(default=lambda scene, memory: None)
