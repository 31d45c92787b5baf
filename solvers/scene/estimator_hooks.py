"""What an error estimator is to a solver: its memory, its moments in a step, and its report.

An estimator of a problem is one :class:`EstimatorHooks`, called ``HOOKS``, at the end of its file. Several can run in
one scene; number e reports the estimated errors of particle p in entry ``e * particles + p`` of the state's
``estimate`` arrays. It may use whatever the method itself computes, the body force and the initial state; never the
exact solution.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

NEVER = 2**31 - 1  # an interval that no step is a multiple of: the estimator is left out, to time the others


@dataclass(frozen=True)
class EstimatorHooks:
    """The hooks of one estimator for one problem.

    ``memory`` names its numbers and arrays, each with the estimator's name in front, and gives their Taichi types;
    ``allocate(scene)`` gives their values. ``interval(scene)`` is the number of steps between two of its own. The
    others are Taichi functions, or None:

    * ``in_step(state, base, on)``: in every step that is a multiple of the interval, between the update of the nodes
      and that of the particles, when the step's weights and the nodes' new motion are known;
    * ``after_step(state, base, step, on)``: at the end of these steps; ``step`` is the number of steps taken;
    * ``report(state, base, step, on)``: fill entries ``base`` to ``base + particles`` of the estimate arrays for the
      state after ``step`` steps, whether or not that is a multiple of the interval. The acceleration is the one that
      the last step used, which belongs to the time one step earlier. Called only when somebody looks.

    On a GPU there is only what can run beside the particles: ``standalone(scene)`` is then a body that the processor
    solves by itself (``solvers.estimators.beside_gpu``), and ``report_at_once(state, base, step, on)`` fills the
    entries from its nodes, for all particles at once. Both are None where an estimator needs a processor.

    ``verdict(scene, memory)`` may find, from the arrays of a run, that the estimate cannot be trusted: one sentence
    that begins with "not valid here: ". What is known beforehand is said by the problem's ``validity``.
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
