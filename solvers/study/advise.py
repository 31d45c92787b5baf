"""The cheapest run for a tolerance: a best-first search over families of runs, with estimates only.

First one family of each method is refined up to the tolerance, for an answer that can be used during the search. Then
every family (method, particles per cell, step size) is measured on one coarse grid, with the optimistic assumption of
the fastest convergence. Then, repeatedly, the member with the lowest expected cost that meets the tolerance is
considered: if it is far beyond the measured members of its family, a coarser one is run first; otherwise it is run
itself. Each run changes the expectation, mostly for the worse, until the cheapest candidate has been run and its own
estimate meets the tolerance. So a family costs more than one coarse run only while it may still win.
"""

import math
import time
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import product

from solvers.scene.scene import Scene
from solvers.scene.validation import SceneError
from solvers.study.refinement_error_and_cost import HIGHEST_ORDER, RefinementFamily, RefinementPoint
from solvers.translatable_message import Message

REACH = 2.5  # times the finest measured grid to which an error may be carried on
MARGIN = 0.95  # of the tolerance as target, so that a run rarely misses it narrowly
CLOSE_ENOUGH = 1.05  # a candidate that has been run is taken when no other is expected to be better by this factor
PATIENCE = 3.0  # seconds of search, in the processor's time as runs are, that no run is too short for
SMALL_PART = 10  # of the budget, up to which runs are made to learn what cannot be met
MOST_LOOKS = 200  # beside those on coarse grids
COARSE = {1: 10, 2: 12}  # cells, by dimension, on which every family is measured
RUNNER_UP_LOOKS = 10  # that are made beside, for a second member of the family that lost
USUAL_PPC, USUAL_CFL = 2, 0.5  # of the family with which each method is tried first
SCOUTED_SECONDS = 0.2  # longest bare run that is made for a first answer


@dataclass(frozen=True)
class SearchGoal:
    """Goal of a search: the largest RMS error of ``quantity`` (x, v, sigma or a) over the run is at most ``tolerance``
    (in its SI unit), and a bare run, without estimators and diagnostics, takes at most ``budget`` seconds."""

    quantity: str
    tolerance: float
    budget: float


@dataclass(frozen=True)
class Candidate:
    """Run with ``cells`` of a family: largest RMS ``error`` and ``seconds`` of a bare run, expected or measured."""

    family: RefinementFamily
    cells: int
    error: float
    seconds: float

    @property
    def scene(self) -> Scene:
        return replace(self.family.scene, cells=self.cells)

    @property
    def is_measured(self) -> bool:
        return any(point.cells == self.cells for point in self.family.points)


@dataclass(frozen=True)
class Advice:
    """Result of a search. ``met`` is whether the estimated error of ``chosen`` meets the tolerance; if not, it is the
    best within the budget, as expected from coarser runs unless it has been run itself.

    ``runner_up`` is the cheapest of another method and ``why`` a sentence on why it lost; ``looks`` counts runs.
    """

    goal: SearchGoal
    met: bool
    chosen: Candidate
    predicted_error: float  # before it was run
    runner_up: Candidate | None
    why: str
    looks: int


def refinement_families(base: Scene, methods: Iterable[tuple[str, bool]], per_cell: Iterable[int],
                        courant_numbers: Iterable[float], quantity: str, corrected: str = "") -> list[RefinementFamily]:
    """Returns a family of runs like ``base`` for every combination that makes a valid scene: ``methods`` are names,
    each with whether it preserves linearity, ``per_cell`` is particles per cell and direction. Of each there is another
    if an estimator's name is given, with results ``corrected`` by it."""
    found = []
    multiple = 6 if base.DIMENSIONS == 2 else 2  # so that the ring's lattice divides evenly
    for (method, preserving), ppc, cfl in product(methods, per_cell, courant_numbers):
        with suppress(SceneError):
            scene = replace(base, method=method, linearity_preserving=preserving, ppc=ppc, dt=None, cfl=cfl)
            found += [RefinementFamily(scene, quantity, multiple, corrected=way)
                      for way in dict.fromkeys(("", corrected))]
    return found


def advise(choices: list[RefinementFamily], goal: SearchGoal,
           on_look: Callable[[int, int, Scene], None] = lambda looks, certain, scene: None,
           on_point: Callable[[RefinementFamily, RefinementPoint], None] = lambda family, point: None,
           recall: Callable[[RefinementFamily, int], RefinementPoint | None] = lambda family, cells: None) -> Advice:
    """Searches for the cheapest run that meets a goal; returns the best within reach if none does.

    ``choices`` are families to choose from (:func:`refinement_families`), at least one. ``on_look`` is called before
    every run with its number (from 1), the least number of runs that there will be, and its scene; ``on_point`` after
    every run, new or recalled, with its family and its measurement. ``recall`` returns the measurement of a family's
    run with so many cells if it is known, or None.
    """
    search = _Search(choices, goal, on_look, on_point, recall)
    search.refine_usual_families()
    search.measure_families_coarsely()
    best = search.measure_until_cheapest()
    met = best.is_measured and best.error <= goal.tolerance
    others = [family for family in choices if _way_name(family) != _way_name(best.family)]
    search.measure_runner_up(others)
    runner_up, why = _runner_up(others, best, goal, met)
    return Advice(goal, met, best, search.predicted.get((id(best.family), best.cells), best.error), runner_up, why,
                  search.looks)


class _Search:
    """State of a search for the cheapest run; arguments as in :func:`advise`."""

    def __init__(self, choices: list[RefinementFamily], goal: SearchGoal, on_look: Callable, on_point: Callable,
                 recall: Callable):
        self._choices, self._goal = choices, goal
        self._on_look, self._on_point, self._recall = on_look, on_point, recall
        self._certain = len(choices)
        self.looks = 0  # measured members: run, or recalled
        self.predicted: dict[tuple[int, int], float] = {}

    def refine_usual_families(self) -> None:
        """Finds a first answer early: runs the usual family of each method, later methods first, on finer and finer
        grids, as long as it promises to be cheaper than the best so far."""
        followed: list[RefinementFamily] = []
        for family in usual_family_per_method(self._choices):
            self._measure_member(family, COARSE[family.scene.DIMENSIONS])
            followed.append(family)
            while True:
                ranking, met = _ranking(followed, self._goal)
                best = _next_or_final_candidate(ranking, met, 0.0)
                if not met or best.is_measured or best.family.seconds(_next_cells(best)) > SCOUTED_SECONDS:
                    break
                self._certain += 1
                self._measure_member(best.family, _next_cells(best))

    def measure_families_coarsely(self) -> None:
        """Runs every family on one coarse grid, and with twice the cells where that run was unstable."""
        for family in self._choices:
            if not family.points:
                self._measure_member(family, COARSE[family.scene.DIMENSIONS])
        for family in self._choices:
            if len(family.points) == 1 and not math.isfinite(family.points[0].error):
                self._measure_member(family, 2 * family.points[0].cells)

    def measure_until_cheapest(self) -> Candidate:
        """Runs the candidate that is expected to be cheapest, until that one has been run; returns it."""
        goal, coarse, begun = self._goal, self.looks, time.process_time()
        while True:
            ranking, met = _ranking(self._choices, goal)
            spent = time.process_time() - begun
            best = _next_or_final_candidate(ranking, met, spent)
            if best.is_measured and met and spent <= PATIENCE + best.seconds:
                # If families converged at full order from now on: coarse grids often show less.
                hopes = (_cheapest(family, goal, HIGHEST_ORDER) for family in self._choices)
                best = min((c for c in hopes if c and not c.is_measured and CLOSE_ENOUGH * c.seconds < best.seconds),
                           key=lambda c: c.seconds, default=best)
            if best.is_measured or self.looks >= coarse + MOST_LOOKS:
                return best
            if not met and self._is_too_expensive(best):
                return best
            self._measure_member(best.family, _next_cells(best))

    def measure_runner_up(self, others: list[RefinementFamily]) -> None:
        """Runs a second member of the best of the families ``others``, those of other methods than the best one."""
        for _ in range(RUNNER_UP_LOOKS if others else 0):
            (other, *_), others_meet = _ranking(others, self._goal)
            if other.is_measured or len(other.family.points) > 1 or not others_meet or self._is_too_expensive(other):
                return
            self._measure_member(other.family, _next_cells(other))

    def _is_too_expensive(self, candidate: Candidate) -> bool:
        return candidate.family.seconds(_next_cells(candidate)) > self._goal.budget / SMALL_PART

    def _measure_member(self, family: RefinementFamily, cells: int) -> None:
        self.looks += 1
        if family.points:
            self.predicted[(id(family), cells)] = family.error(cells)
        known = self._recall(family, cells)
        if known is None:
            self._on_look(self.looks, self._certain, family.member(cells))
        self._on_point(family, family.measure(cells) if known is None else family.add_and_time_point(known))


def usual_family_per_method(choices: Iterable[RefinementFamily]) -> list[RefinementFamily]:
    """Returns for each method the family nearest to 2 particles per cell and the Courant number 0.5; methods listed
    last come first, because each corrects deficiencies of previous ones."""
    found: dict[str, RefinementFamily] = {}
    for family in choices:
        before = found.setdefault(_way_name(family), family)
        found[_way_name(family)] = min(before, family, key=lambda one: (
            abs(one.scene.ppc - USUAL_PPC), abs(one.scene.courant_number - USUAL_CFL)))
    return list(found.values())[::-1]


def _next_or_final_candidate(ranking: list[Candidate], met: bool, spent: float) -> Candidate:
    """Returns the best candidate that has been run, unless another promises to be clearly better and is worth a try:
    while the search has ``spent`` less CPU time (s) than the run that it may replace."""
    measured = next((c for c in ranking if c.is_measured), None)
    if measured is None:
        return ranking[0]
    price = "seconds" if met else "error"
    near = getattr(measured, price) <= CLOSE_ENOUGH * getattr(ranking[0], price)
    return measured if near or (met and spent > PATIENCE + measured.seconds) else ranking[0]


def _next_cells(candidate: Candidate) -> int:
    """Returns the cells to run next for a candidate: its own, or fewer where these are too far to extrapolate."""
    finest, multiple = candidate.family.points[-1].cells, candidate.family.multiple
    ratio = candidate.cells / finest
    if ratio <= REACH:
        return candidate.cells
    strides = math.ceil(math.log(ratio) / math.log(REACH))
    return multiple * round(finest * ratio ** (1 / strides) / multiple)


def _ranking(choices: list[RefinementFamily], goal: SearchGoal) -> tuple[list[Candidate], bool]:
    """Returns candidates, best first, and whether they meet the goal: by seconds if some do, else by error."""
    meeting = [c for c in (_cheapest(family, goal) for family in choices) if c is not None]
    if meeting:
        return sorted(meeting, key=lambda c: c.seconds), True
    within = [Candidate(f, cells, f.error(cells), f.seconds(cells)) for f in choices
              for cells in {f.cells_within(goal.budget), *(p.cells for p in f.points)}
              if f.seconds(cells) <= goal.budget or cells == f.points[0].cells]
    return sorted(within, key=lambda c: (c.error, c.seconds)), False


def _cheapest(family: RefinementFamily, goal: SearchGoal, hoped: float = 0.0) -> Candidate | None:
    """Returns the family's cheapest member that should meet the goal, or None; ``hoped``: least order to assume."""
    met = [point.cells for point in family.points if point.error <= goal.tolerance]
    cells = family.cells_for(MARGIN * goal.tolerance, hoped)
    if met and (cells is None or met[0] <= cells * 1.05):
        cells = met[0]
    if cells is None:
        return None
    seconds = family.seconds(cells)
    return Candidate(family, cells, family.error(cells), seconds) if seconds <= goal.budget else None


def _runner_up(others: list[RefinementFamily], best: Candidate, goal: SearchGoal,
               met: bool) -> tuple[Candidate | None, str]:
    """Returns the best candidate of ``others``, families of other methods, and a sentence on why it lost."""
    if not others:
        return None, Message("no other method was asked for")
    (other, *_), others_meet = _ranking(others, goal)
    name, scene = _way_name(other.family), other.scene
    if met and not others_meet:
        return other, Message("{name} does not meet the tolerance: its error is {error:.2g} at {cells} cells and falls "
                              "no further within the budget", name, other.error, other.cells)
    if not met:
        return other, Message("{name} only falls to {error:.2g}", name, other.error)
    size = Message("{cells} cells with {ppc} particle{plural} per cell, cfl {cfl:g}", other.cells, scene.ppc,
                   "s" * (scene.ppc != 1), scene.cfl)
    return other, Message("{name} needs {size}: {seconds:.2g} times the time", name, size, other.seconds / best.seconds)


def _way_name(family: RefinementFamily) -> str:
    """Returns a family's method, and the estimator that corrects its results."""
    scene = family.scene
    name = Message("linearity-preserving {method}", scene.method) if scene.linearity_preserving else scene.method
    return Message("{method} corrected by {estimator}", name, family.corrected) if family.corrected else name
