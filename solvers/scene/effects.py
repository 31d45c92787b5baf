"""Registry of all effects: what a scene can request beside the bare method, with requirements and results.

An effect is compiled in only where a scene has it (``solvers.scene.kernel_options``), so that one that is off costs
nothing. A new one is an :class:`Effect` here and its code, under ``ti.static(on.NAME)`` in a problem's step or as a
sampler (:func:`samplers`). Its numbers are declared only here: JSON objects, the output of ``mpm-lab run``, the page's
readout, rows and tables of sweeps, and lessons' claims use this list. Modules named in the environment variable
``MPM_LAB_EXTENSIONS`` can add more with :func:`register`.
"""

import functools
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from solvers.scene import extension_modules
from solvers.scene.error_causes import COLUMNS
from solvers.scene.validation import SceneError
from solvers.translatable_message import Message

PER_CENT = "%"  # the unit of a number that is displayed in per cent
Series = Mapping[str, np.ndarray]


@dataclass(frozen=True)
class Number:
    """A number that an effect computes from the samples of a run.

    ``key`` is its name in JSON objects, behind that of its effect; "" for one that stands there for its effect.
    ``of`` returns from the series its value after the last sample (``solvers.solver.samples.read_rows``); unknown where
    not finite. ``unit`` is in SI, "" for none, :data:`PER_CENT` for one that is displayed in per cent; ``kind`` is int
    for a count; ``bounds`` are the sizes from which the page marks it as noticeable, and as alarming.
    """

    key: str
    of: Callable[[Series], Any]
    unit: str = ""
    kind: type = float
    bounds: tuple[float, float] | None = None


@dataclass(frozen=True)
class OutputLine:
    """Line of output about an effect: its ``name``, and a template, ``words``, with places for the effect's numbers,
    ``{drift}``, or ``{0}`` for the first. ``hint`` explains the numbers. A line without a name is left out."""

    name: str
    words: str = "{0}"
    hint: str = ""


@dataclass(frozen=True)
class Effect:
    """Diagnostic that a scene can request.

    ``name`` is its name in scenes and, as ``on.NAME``, in kernels; ``label`` that on the page, and ``explanation`` what
    it does, in the imperative. It ``needs`` at least one of these effects; with ``needs_solution`` also a built-in
    exact solution. ``timed_alone`` is whether a study can time it by itself.

    ``columns`` are its own in the samples, there only where it is on: a kernel finds one by
    ``ti.static(column_index("spin/torque", on))`` (``solvers.solver.samples``), a number's ``of`` in
    ``series["spin/torque"]``. ``samplers`` are functions that fill them, by problem, for problems without their own:
    see :func:`samplers`.

    ``numbers`` are its results, ``key`` is their key in JSON objects, by default its name; ``text`` and ``readout`` are
    the lines of ``mpm-lab run`` and of the page, where they are not the label and all numbers; ``elsewhere`` is what a
    problem without it offers instead, with ``{problem}`` for its name.
    """

    name: str
    label: str
    explanation: str
    needs: tuple[str, ...] = ()
    needs_solution: bool = False
    timed_alone: bool = True
    columns: tuple[str, ...] = ()
    numbers: tuple[Number, ...] = ()
    key: str = ""
    text: OutputLine | None = None
    readout: OutputLine | None = None
    samplers: Mapping[str, Callable] = field(default_factory=dict)
    elsewhere: str = ""

    @property
    def json_key(self) -> str:
        """Key of its numbers in JSON objects."""
        return self.key or self.name

    @property
    def default_output_line(self) -> OutputLine:
        """Line with the effect's label and all its numbers, each behind its key."""
        words = ", ".join(f"{number.key} {{{at}}}".strip() for at, number in enumerate(self.numbers))
        return OutputLine(self.label, words, self.explanation)

    @np.errstate(over="ignore", invalid="ignore", divide="ignore")  # for unstable runs
    def values(self, series: Series) -> dict[str, Any]:
        """Returns the effect's numbers by key, None for unknown ones, from the ``series`` of a run that had it on."""
        made = {number.key: (number.kind, number.of(series)) for number in self.numbers}
        return {key: kind(value) if math.isfinite(value) else None for key, (kind, value) in made.items()}

    def json_value(self, series: Series) -> Any:
        """Returns the effect's numbers as in JSON objects: a mapping by key, or the only number itself."""
        values = self.values(series)
        return values.get("", values)


def _total_energy(series: Series) -> np.ndarray:
    return series["kinetic"] + series["strain"]


def _energy_drift(series: Series) -> float:
    """Returns (E - W - E0)/E0 at the end: E is kinetic plus strain energy, E0 the first, W the body force's work."""
    total = _total_energy(series)
    return (total[-1] - series["work"][-1] - total[0]) / total[0]


def _relative_angular_momentum_gain(series: Series, against: str) -> float:
    """Returns the run's gain of angular momentum minus that of the column ``against``, over the initial momentum."""
    momentum, known = series["spin/momentum"], series[against]
    return ((momentum[-1] - momentum[0]) - (known[-1] - known[0])) / momentum[0]


EFFECTS: dict[str, Effect] = {effect.name: effect for effect in (
    Effect("truth", "true error", "compare every particle with the exact solution", needs_solution=True),
    Effect("estimate", "estimate", "run the estimators that are chosen", timed_alone=False),
    Effect("crossings", "grid crossings", "count and mark particles that cross a cell boundary", key="grid_crossings",
           numbers=(Number("", lambda series: series["crossings"][-1], kind=int),), readout=OutputLine("")),
    Effect("energy", "energy", "follow kinetic and strain energy and the work of the body force", numbers=(
               Number("initial", lambda series: _total_energy(series)[0], "J"),
               Number("final", lambda series: _total_energy(series)[-1], "J"),
               Number("drift", _energy_drift, PER_CENT, bounds=(0.05, 0.5))),
           text=OutputLine("energy drift", "{drift}"),
           readout=OutputLine("energy", "out of balance by {drift}",
                              "kinetic and strain energy less the work of the body force, over the largest energy")),
    Effect("acceleration", "acceleration error", "keep each particle's acceleration, to compare and to estimate it",
           needs=("truth", "estimate")),
    Effect("soundness", "contradictions", "look for contradictions in the motion itself that show a run to be lost"),
    Effect("margin", "step margin", "compare the time step with the stability bound of the present configuration"),
)}
#: Effects that only some problems have: a scene's ``OWN_EFFECTS`` names them.
OWN: dict[str, Effect] = {effect.name: effect for effect in (
    Effect("spin", "angular momentum", "follow the angular momentum and the torque of the body force",
           # About the centre; the impulse of the body force's torque; what the exact solution has. In N m s.
           columns=("momentum", "torque", "exact_momentum"), key="angular_momentum", numbers=(
               Number("initial", lambda series: series["spin/momentum"][0], "N m s"),
               Number("final", lambda series: series["spin/momentum"][-1], "N m s"),
               Number("drift", lambda series: _relative_angular_momentum_gain(series, "spin/torque"), PER_CENT),
               Number("error", lambda series: _relative_angular_momentum_gain(series, "spin/exact_momentum"),
                      PER_CENT)),
           text=OutputLine("angular momentum",
                           "off its balance by {drift}, off the exact one by {error}, of what it was at first"),
           readout=OutputLine("turning", "balance {drift}, error {error}",
                              "angular momentum: beyond the torque of the body "
                              "force, and beyond the exact, over that at the start")),
    Effect("budget", "error budget", "divide the error between its causes: crossings, the coarse grid, the body force "
           "and the time step; against the exact solution, or without it against the estimator companion",
           needs=("truth", "estimate"), columns=COLUMNS,
           elsewhere="its budget is found on demand, by mpm-lab budget {problem}"),
)}
ALL = {**EFFECTS, **OWN}


def register(effect: Effect) -> None:
    """Makes an effect known to scenes, solvers, page and tables. Raises RuntimeError where the solver of a problem in
    its ``samplers`` has been imported already."""
    extension_modules.require_before_solver_import(effect.name, effect.samplers)
    ALL[effect.name] = effect
    effects_of.cache_clear()


@functools.cache  # used by every scene
def effects_of(problem: str, own: tuple[str, ...]) -> tuple[str, ...]:
    """Returns the names of the effects of a problem: those of every problem, its ``own``, and registered ones. Raises
    :class:`~solvers.scene.extension_modules.ExtensionError` where an extension cannot be imported."""
    extension_modules.load_extensions()
    return tuple(name for name, effect in ALL.items() if name in EFFECTS or name in own or problem in effect.samplers)


def require_offered(chosen: object, problem: str, offered: tuple[str, ...]) -> None:
    """Raises :class:`SceneError` for a ``chosen`` effect of other problems that is none of those ``offered`` here."""
    for name in chosen if isinstance(chosen, tuple) else ():
        effect = ALL.get(name) if isinstance(name, str) else None
        if effect and name not in offered:
            instead = " (" + Message(effect.elsewhere, problem=problem) + ")" if effect.elsewhere else ""
            raise SceneError("effects", name, "is no effect of the {problem}{instead}; give one of {offered}",
                             Message(problem), instead, ", ".join((*offered, "none")))


def samplers(problem: str, own: Mapping[str, Callable]) -> dict[str, Callable]:
    """Returns the functions that fill a problem's effects' columns, by name: its ``own`` and registered ones, Taichi
    functions (state, row, step, on) that write a row of ``state.samples``; ``step`` counts the steps taken."""
    extension_modules.load_extensions()
    extension_modules.COMPILED_PROBLEMS.add(problem)
    return {**own, **{name: effect.samplers[problem] for name, effect in ALL.items() if problem in effect.samplers}}


def output_lines_by_effect(line_of: Callable[[Effect], OutputLine | None]) -> dict[str, OutputLine]:
    """Returns the output line of each effect with numbers, by name: what ``line_of`` returns, or the usual one."""
    lines = {name: line_of(effect) or effect.default_output_line for name, effect in ALL.items() if effect.numbers}
    return {name: line for name, line in lines.items() if line.name}
