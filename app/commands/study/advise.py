"""``mpm-lab advise PROBLEM``: the cheapest run for a tolerance."""

from __future__ import annotations

import math
import sys
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from app.commands import lenient_flag_types
from app.commands.output import json_target, print_message, put_result
from app.commands.progress import record_interrupts, stdout_to_stderr
from app.names_and_units import command_line, particles_per_cell
from solvers.scene.estimator_registry import COMPANION, require_corrector
from solvers.scene.scene import Scene
from solvers.scene.validation import require_choice, require_number
from solvers.solver.error_series import finite_or_none
from solvers.solver.samples import QUANTITIES
from solvers.study.sweep_and_search_worker import COURANT_NUMBERS, PARTICLES_PER_CELL

if TYPE_CHECKING:
    from solvers.study.advise import Advice, Candidate

SCHEMA = "mpm-lab/advice/1"
OK, UNREACHABLE = 0, 1


@dataclass(frozen=True, kw_only=True)
class Advise:
    """Command ``mpm-lab advise``: flags of a search over cells and what is not given of method, ppc and cfl."""

    HELP: ClassVar[str] = """Find the cheapest run of the {title} whose own estimate meets a tolerance.

    Exit status: 0 ok, 1 nothing within the budget meets it (the best within reach is named), 2 bad input."""
    EXAMPLE: ClassVar[str] = "mpm-lab advise {problem} --tolerance 1e-3"
    SCENE: ClassVar[type[Scene]]

    tolerance: Annotated[lenient_flag_types.RealFlag, lenient_flag_types.default_hint("required")] = None
    """Largest RMS error that is allowed at any time of the run."""
    relative: bool = True
    """Whether the tolerance is a part of the quantity's own size (of A for x) or in its unit."""
    quantity: Annotated[Any, lenient_flag_types.several_of(QUANTITIES)] = ("x",)
    """What the tolerance is about: position, velocity, stress or acceleration."""
    budget: lenient_flag_types.RealFlag = 60.0
    """Longest run that may be recommended, s."""
    corrected: Annotated[lenient_flag_types.TextFlag, lenient_flag_types.default_hint("none")] = ""
    """Estimator, recovered or two-grid, of runs minus their estimates that are candidates too; their error is the true
    one, their time includes the estimator."""
    method: Any = ()
    ppc: Any = ()
    cfl: Any = ()
    amplitude: Any = None
    modulus: Any = None
    density: Any = None
    t_end: Any = None
    periods: Any = None
    body_force: Any = None
    json: Annotated[lenient_flag_types.PathFlag, lenient_flag_types.default_hint("a text is printed instead")] = None
    """File for the advice as a JSON object; - is standard output."""
    quiet: Annotated[lenient_flag_types.Switch, lenient_flag_types.default_hint("off")] = False
    """Nothing on standard error about the runs that are made."""

    def execute(self) -> int:
        physics = ("amplitude", "modulus", "density", "t_end", "periods", "body_force")
        base = self.SCENE(**{name: getattr(self, name) for name in physics}, estimators=(), effects=())
        if len(self.quantity) != 1 or self.quantity[0] not in QUANTITIES:
            raise lenient_flag_types.BadInput("quantity", " ".join(self.quantity),
                                              f"give one of {', '.join(QUANTITIES)}")
        quantity = self.quantity[0]
        if self.tolerance is None:
            raise lenient_flag_types.BadInput("tolerance", "", "give the error that is allowed, for example 1e-3")
        require_number("tolerance", self.tolerance, 0, math.inf)
        require_number("budget", self.budget, 0, math.inf)
        tolerance = self.tolerance * (base.size_of(quantity) if self.relative else 1.0)  # in the quantity's unit
        if self.corrected:
            require_corrector(self.corrected, tuple(name for name in base.choices("estimators") if name != COMPANION))
        target = json_target(self.json)
        begun = time.monotonic()
        with stdout_to_stderr(), record_interrupts() as check_interrupts:
            advice = self._search(base, quantity, tolerance, check_interrupts)
        values = as_dict(advice, base, self.tolerance, self.relative, time.monotonic() - begun)
        put_result(values, target, as_text)
        if not advice.met:
            print_message(values["reason"])
        return OK if advice.met else UNREACHABLE

    def _search(self, base: Scene, quantity: str, tolerance: float, check_interrupts) -> Advice:
        """Returns the advice for a tolerance in the quantity's unit; ``check_interrupts`` raises a recorded Ctrl-C."""
        from solvers.study.advise import SearchGoal, advise, refinement_families
        def report_run(looks: int, certain: int, scene: Scene) -> None:
            check_interrupts()
            if not self.quiet and sys.stderr.isatty():
                print_message(f"run {looks}: {scene.method}, {scene.cells} cells, "
                              f"{particles_per_cell(scene.problem, scene.ppc)}, cfl {scene.cfl:g}")

        for method in self.method:
            require_choice("method", method, base.choices("method"))
        methods = [pair for pair in self.SCENE.candidates() if not self.method or pair[0] in self.method]
        choices = refinement_families(base, methods, self._numbers("ppc", self.ppc, PARTICLES_PER_CELL),
                                      self._numbers("cfl", self.cfl, COURANT_NUMBERS), quantity, self.corrected)
        return advise(choices, SearchGoal(quantity, tolerance, self.budget), report_run)

    def _numbers(self, flag: str, words: tuple[str, ...], default: tuple[Any, ...]) -> tuple[Any, ...]:
        """Returns a flag's words as numbers, the default if there are none; raises SceneError for invalid ones."""
        parse = lenient_flag_types.parse_float_or_text if flag == "cfl" else lenient_flag_types.parse_number_or_text
        numbers = tuple(parse([word]) for word in words)
        for value in numbers:
            self.SCENE(**{flag: value})  # says what is wrong with it
        return numbers or default


def search_flags(scene: type[Scene]) -> dict[str, Any]:
    """Returns the types of the flags, by field, that take several values to search instead of one."""
    preserving = "; uGIMP with and without linearity preservation" * (("ugimp", True) in scene.candidates())
    per_cell_help = scene.__dataclass_fields__["ppc"].metadata["help"]
    choices_of = lenient_flag_types.choices_of
    return {"method": choices_of(scene.choices("method"), "all", f"Methods to choose from{preserving}."),
            "ppc": choices_of(("N",), _join(PARTICLES_PER_CELL), f"{per_cell_help} to choose from."),
            "cfl": choices_of(("X",), _join(COURANT_NUMBERS), "Lengths of the time step, dt c/h, to choose from.")}


def _join(numbers: tuple[float, ...]) -> str:
    return " ".join(f"{number:g}" for number in numbers)


def as_dict(advice: Advice, base: Scene, tolerance: float, relative: bool, spent: float) -> dict:
    """Returns the advice as one JSON object; ``tolerance`` as given, ``relative`` to the size of the quantity or in its
    unit; errors in both; ``spent`` is the search's time in s."""
    chosen, goal, other, size = advice.chosen, advice.goal, advice.runner_up, base.size_of(advice.goal.quantity)

    def errors(value: float) -> dict:
        return {"error": finite_or_none(value), "relative": finite_or_none(value / size)}

    return {
        "schema": SCHEMA, "status": "ok" if advice.met else "unreachable",
        "reason": None if advice.met else
        f"nothing that runs within {goal.budget:g} s is expected to meet {tolerance:g}{' of the size' * relative}: the "
        f"best within reach is {chosen.error:.3g} ({'measured' if chosen.is_measured else 'expected'}) in "
        f"{chosen.seconds:.2g} s",
        "problem": base.problem, "quantity": goal.quantity, "tolerance": tolerance, "relative": relative,
        "budget": goal.budget, "recommended": _inputs(chosen), "command": command_line(chosen.scene)
        + f" --corrected {chosen.family.corrected}" * bool(chosen.family.corrected),
        "predicted": {**errors(advice.predicted_error), "seconds": chosen.seconds},
        "verified": errors(chosen.error) if chosen.is_measured else None,
        "runner_up": other and {**_inputs(other), **errors(other.error),
                                "seconds": finite_or_none(other.seconds)},
        "why": advice.why, "runs": advice.looks, "seconds": spent}


def as_text(values: dict) -> str:
    """Returns the lines printed for the JSON object of :func:`as_dict`."""
    got, predicted = values["verified"] or values["predicted"], values["predicted"]
    corrected = values["recommended"]["corrected"]
    said = "expected, not run" if not values["verified"] else \
        f"what {corrected}'s estimate leaves of it" if corrected else "by its own estimate"
    timed = f"run and {corrected}" if corrected else "bare run"
    rows = [("run" if values["status"] == "ok" else "closest", values["command"]),
            (f"error of {values['quantity']}", f"{got['error']:.3g}, {got['relative']:.3g} of its size, {said}"
             + (f"; {predicted['error']:.3g} was expected" if values["verified"] else "")),
            ("time", f"{predicted['seconds']:.2g} s for the {timed} on one thread"),
            ("runner-up", values["why"]), ("search", f"{values['runs']} runs in {values['seconds']:.1f} s")]
    width = 1 + max(len(name) for name, _ in rows)
    return "\n".join(f"{name:<{width}}{text}" for name, text in rows)


def _inputs(candidate: Candidate) -> dict:
    values = candidate.scene.to_dict()
    return {key: values[key] for key in ("method", "linearity_preserving", "cells", "ppc", "dt", "cfl")} \
        | {"corrected": candidate.family.corrected or None}
