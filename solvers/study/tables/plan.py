"""What the paper's tables consist of here: their rows, the runs that each takes, and what had to be chosen.

A row is up to three runs: ``errors`` with every estimator, sampled as often as the estimators step, so that sums
over samples are sums over steps; ``cost``, a tenth as long and sampled as a run is by default, for the price of each
estimator; and for Table 1 ``crossings``, longer and with nothing else switched on. Tables 2 and 3 share their runs.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from itertools import product

from solvers.problems.bar.scene import BarScene
from solvers.problems.ring.scene import RingScene
from solvers.scene.scene import Scene
from solvers.study.tables import paper
from solvers.study.tables.digits import short

NUMBERS = ("1", "2", "3")
COST_PART = 0.1  # of the run's length: shares of the time do not depend on it

BAR_CELLS = (20, 40, 80, 160)
#: Case of Table 1: modulus in Pa and amplitude in m.
BAR_CASES = {"small": (4.0, 2.5e-4), "large": (1000.0, 2.5e-2)}
BAR_FORCES = {"node": "body force at the nodes (the paper's)", "material": "body force at the material points"}

RING_CELLS = (12, 24, 48, 96)
RING_METHODS = ("ugimp", "cpgimp", "cpdi")
#: Set-up of Tables 2 and 3: amplitude in m, modulus in Pa, particles per cell and direction, and what it is.
RING_SETUPS = {"ours": (0.1, 1e7, 2, "our choice"), "fitted": (0.03, 4e7, 4, "the best fit to the paper's digits")}

INDEX_NOTE = ("Index: sum over time of the estimated RMS errors over that of the true ones (eq 35), 1 is perfect; "
              "sampled every tenth step, or more often where a wave crosses a cell in fewer than 20 steps. Distance: "
              "the same with the RMS of estimate minus truth above, 0 is perfect.")
COST_NOTE = ("Cost: the part of the running time that the estimator takes, reports included, measured beside the same "
             "steps without it in a run sampled as by default; it depends on the machine and its other work.")
BAR_SETUP = (
    "As in the paper: bar of unit length, linearity-preserving uGIMP, 4 particles per cell, dt = 2.5e-5 s; "
    "E = 4 Pa with A = 2.5e-4 m and E = 1000 Pa with A = 0.025 m.",
    "Left open there, chosen here: density 1 kg/m³, periodic ends, position update with the grid velocity. Errors are "
    "RMS over particles, the largest over time up to T = {end:g} s, which fits the paper's errors. The error of σ is "
    "that of E ln F. Grid crossings are counted up to {end:g} s and up to {long:g} s: the second fits the paper's "
    "count in the large case, so no single run gives both.",
    "The paper's force acts at the nodes' positions; the same rows are repeated with the force at the material points, "
    "beside the same printed numbers.",
    "The paper's index stands beside that of `transport`, which is its estimator. Our index of σ is that of the stress "
    "in the equation of motion, E(F − 1).")
RING_SETUP = (
    "As in the paper: ring of radii 0.4 m and 0.6 m, Poisson's ratio 0, dt = 2e-5 s, one period to t = {end:g} s.",
    "Left open there, chosen here: density 1000 kg/m³, a quarter ring with folded symmetry planes, polar lattice of "
    "particles, and two set-ups: A = 0.1 m, E = 1e7 Pa, 2 × 2 particles per cell (our choice), and A = 0.03 m, "
    "E = 4e7 Pa, 4 × 4, which of those tried fits the paper's digits best. Errors are RMS over particles.")
RING_CAPTION = "polar lattice, density 1000 kg/m³, Poisson's ratio 0, dt = 2e-5 s, t = {end:g} s"
ERROR_NOTE = ("Errors are those at the end; `Err A` is the RMS error of the acceleration over the nodes that carry "
              "mass. Indices of the same runs are in Table 3.")
RING_INDEX_NOTE = ("The printed index of the displacement error stands beside that of `transport`, which is the "
                   "paper's estimator and says nothing about the stress.")


@dataclass(frozen=True)
class Row:
    """One row. ``name`` names its file, ``part`` is the heading that it stands under, ``paper`` what is printed."""

    name: str
    part: str
    scenes: Mapping[str, Scene]
    paper: Mapping[str, float]

    @property
    def work(self) -> float:
        """Particle-steps, with something for each compilation: what the progress bar counts."""
        return sum(scene.particles * scene.steps + 1e6 for scene in self.scenes.values())


@dataclass(frozen=True)
class Table:
    """A table before anything has run. ``setup`` says in sentences what was taken and what was chosen, ``caption`` the
    numbers that all rows share."""

    number: str
    title: str
    caption: str
    setup: tuple[str, ...]
    rows: tuple[Row, ...]


def make(number: str, estimators: Mapping[str, Iterable[str]]) -> Table:
    """A table of the paper, with the estimators that each problem has."""
    makers: dict[str, Callable[..., Table]] = {"1": table_1, "2": table_2, "3": table_3}
    return makers[number](estimators)


def table_1(estimators: Mapping[str, Iterable[str]], cells: Iterable[int] = BAR_CELLS, end: float = 1.0,
            long: float = 10.0) -> Table:
    """The bar: errors, grid crossings and indices."""
    rows = []
    for case, force, n in product(BAR_CASES, BAR_FORCES, cells):
        modulus, amplitude = BAR_CASES[case]
        scene = BarScene(method="ugimp", linearity_preserving=True, cells=n, ppc=4, modulus=modulus, dt=2.5e-5,
                         amplitude=amplitude, t_end=end, body_force=force, estimators=tuple(estimators["bar"]))
        crossings = replace(scene, t_end=long, estimators=(), effects=("crossings",))
        part = f"E = {modulus:g} Pa, A = {short(amplitude)} m, {BAR_FORCES[force]}"
        rows.append(Row(f"bar-{case}-{force}-{n}", part, {**_errors_and_cost(scene), "crossings": crossings},
                        paper.bar(modulus, n)))
    setup = (*(line.format(end=end, long=long) for line in BAR_SETUP), INDEX_NOTE, COST_NOTE)
    caption = f"linearity-preserving uGIMP, 4 particles per cell, dt = 2.5e-5 s, T = {end:g} s"
    return Table("1", "Table 1. Vibrating bar: errors, grid crossings and error indices", caption, setup, tuple(rows))


def _ring_table(number: str, title: str, notes: tuple[str, ...], printed: Callable[[str, int], Mapping[str, float]],
                estimators: Mapping[str, Iterable[str]], cells: Iterable[int] = RING_CELLS,
                methods: Iterable[str] = RING_METHODS, end: float = 0.02) -> Table:
    """A table of the ring, with the numbers that the paper has ``printed`` for a method and so many cells."""
    rows = []
    for name, method, n in product(RING_SETUPS, methods, cells):
        amplitude, modulus, ppc, what = RING_SETUPS[name]
        scene = RingScene(method=method, cells=n, ppc=ppc, amplitude=amplitude, modulus=modulus, dt=2e-5, t_end=end,
                          estimators=tuple(estimators["ring"]))
        part = f"A = {amplitude:g} m, E = {short(modulus)} Pa, {ppc} × {ppc} particles per cell ({what})"
        rows.append(Row(f"ring-{name}-{method}-{n}", part, _errors_and_cost(scene), printed(method, n)))
    setup = (*(line.format(end=end) for line in RING_SETUP), *notes)
    return Table(number, title, RING_CAPTION.format(end=end), setup, tuple(rows))


table_2 = partial(_ring_table, "2", "Table 2. Expanding ring: errors at the end of the run", (ERROR_NOTE,),
                  paper.ring_errors)
table_3 = partial(_ring_table, "3", "Table 3. Expanding ring: error indices over the run",
                  (RING_INDEX_NOTE, INDEX_NOTE, COST_NOTE), paper.ring_index)


def _errors_and_cost(scene: Scene) -> dict[str, Scene]:
    return {"errors": replace(scene, sample_every=scene.estimate_interval),
            "cost": replace(scene, t_end=COST_PART * scene.end_time)}
