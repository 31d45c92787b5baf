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

    Parameters
    ----------
    memory
        Names of its numbers and arrays, each with the estimator's name in front, with their Taichi types.
    allocate : scene -> dict
        Their values at the start, by name.
    interval : scene -> int
        Steps of the run between two of its own.
    in_step(state, base, on) : Taichi function or None
        In every step that is a multiple of the interval, between the update of the nodes and that of the particles,
        when the step's weights and the nodes' new motion are known.
    after_step(state, base, step, on) : Taichi function or None
        At the end of these steps; ``step`` is the number of steps taken.
    report(state, base, step, on) : Taichi function or None
        Fill entries ``base`` to ``base + particles`` of the estimate arrays for the state after ``step`` steps, whether
        or not that is a multiple of the interval. The acceleration is the one that the last step used, which belongs to
        the time one step earlier. Called only for samples and frames.
    standalone : scene -> body, or None
        A body that the CPU solves in parallel to particles on a GPU (``solvers.problems.planar.plans``); None where the
        estimator needs particles on a CPU.
    report_at_once(state, base, step, on) : Taichi function or None
        On a GPU: fill the entries from that body's nodes, for all particles at once.
    verdict : (scene, memory) -> str or None
        From the arrays of a run, why the estimate cannot be trusted: one sentence that begins with "not valid here: ".
        Reasons that are known beforehand are in the scene's ``LIMITS``.
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
