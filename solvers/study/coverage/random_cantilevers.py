"""Random cantilevers under gravity, and how their estimates and error bars compare with a much finer companion.

Each is one row. Its keys::

    schema, key, problem ("body"), seed, number, solvers, status, reason, seconds
    cantilever: {length (m), slope (static deflection of the tip over the length), poissons_ratio, offset (of the body
                 against the grid, in cells), method, cells_per_metre, ppc}
    particles, estimated (part of the run with an estimate, 0 to 1)
    estimates: {quantity: {delta, trust, index}}       index: estimated over true error, in sums over the samples; known
                                                       too where the estimate is withheld
    goals: {name: {value, bar, true, unit}}            bar: null where there is none

The true values are those of companions of a high order on elements that resolve the clamped corners."""

import math
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING

import numpy as np

from solvers.bodies.body import SAMPLES, Body
from solvers.bodies.goal import Goal
from solvers.bodies.patch import CLAMPED, FREE, Patch
from solvers.solver.soundness import OK
from solvers.study.coverage.random_draw import RandomDraw, draw_between
from solvers.study.json_schema import NUMBER, NUMBER_OR_NONE, MapOf

if TYPE_CHECKING:
    from solvers.bodies.run import BodyResult

PROBLEM = "body"
MEASURED = {"cantilever": dict, "particles": int, "estimated": NUMBER, "seconds": NUMBER,
            "estimates": MapOf({"delta": NUMBER, "trust": str, "index": NUMBER}),
            "goals": MapOf({"value": NUMBER_OR_NONE, "bar": NUMBER_OR_NONE, "true": NUMBER_OR_NONE, "unit": str})}
LENGTHS, SLOPES, POISSONS_RATIOS = (3.0, 4.0, 5.0), (0.03, 0.3), (0.0, 0.2, 0.3, 0.4)
METHODS, CELLS, PPC = ("ugimp", "cpgimp", "cpdi"), (4, 5, 6, 8), (1, 2, 2, 3)
DENSITY, GRAVITY, HEIGHT = 1050.0, 10.0, 1.0  # kg/m^3, m/s^2, m
BENDING = 3.516  # first root of a clamped bar squared: its frequency is that times sqrt(E I/(rho A L^4))
PERIODS = 1.4  # of a run; large deflections are slower than beam theory
#: Elements along and across of the truth: small at the clamped corners; and its order.
TRUE_CUTS, TRUE_ORDER = (np.array([0, 0.05, 0.2, 0.6, 1]), np.array([0, 0.2, 0.8, 1])), 8


@dataclass(frozen=True)
class Cantilever:
    """Beam of unit height that gravity bends; units as in the module docstring."""

    length: float
    slope: float
    poissons_ratio: float
    offset: float
    method: str
    cells_per_metre: int
    ppc: int

    def body(self) -> Body:
        """Returns the body: E is such that beam theory gives the static deflection, the run lasts 1.4 periods."""
        L, y = self.length, self.offset / self.cells_per_metre
        plane = 1.5 * DENSITY * GRAVITY * L**3 / (HEIGHT**2 * self.slope)  # E/(1 - nu^2)
        period = 2 * math.pi / BENDING * math.sqrt(12 * DENSITY * L**4 / (plane * HEIGHT**2))
        tip, top = (L, y + 0.5 * HEIGHT), y + HEIGHT
        return Body(
            patches=(Patch(((0.0, y), (L, y), (L, top), (0.0, top)), (FREE, FREE, FREE, CLAMPED)),),
            youngs_modulus=plane * (1 - self.poissons_ratio**2), poissons_ratio=self.poissons_ratio, density=DENSITY,
            gravity=(0.0, -GRAVITY), method=self.method, cells_per_metre=self.cells_per_metre, ppc=self.ppc,
            t_end=PERIODS * period, domain=((-1.0, y - L - 1), (L + 1, y + 3)),
            goals={"lowest": Goal("min y", tip), "period": Goal("time of return y", tip), "end": Goal("end y", tip),
                   "stress": Goal("max |sigma_xx|", (L / 4, top))})


class RandomCantilever(RandomDraw):
    """Random cantilever; its ``problem`` is "body"."""

    SCHEMA = "mpm-lab/body-coverage-row/1"

    @property
    def cantilever(self) -> Cantilever:
        chance = self.random_generator(0)
        return Cantilever(
            length=float(chance.choice(LENGTHS)), slope=draw_between(chance, *SLOPES),
            poissons_ratio=float(chance.choice(POISSONS_RATIOS)), offset=float(chance.uniform()),
            method=str(chance.choice(METHODS)), cells_per_metre=int(chance.choice(CELLS)), ppc=int(chance.choice(PPC)))

    @property
    def kind(self) -> str:
        """The method: all cantilevers of one share their compiled code."""
        return self.cantilever.method


def measure_in_worker(draw: dict, answer: Callable[[dict], None]) -> None:
    """Calls ``answer`` with the row of :func:`measure`, in a worker process, for the fields of a
    :class:`RandomCantilever`."""
    answer(RandomCantilever(**draw).row(measure))


def measure(draw: RandomCantilever) -> dict:
    """Returns the row of a random cantilever (keys: module docstring)."""
    from solvers.bodies.run import run_body  # here: a row can be read, kept and drawn without Taichi

    begun, body = time.perf_counter(), draw.cantilever.body()
    result = run_body(body)
    index, true = compare_with_truth(body, result) if result.status == OK else ({}, {})
    return {**draw.identity_columns(), "status": result.status, "reason": str(result.reason) or None,
            "cantilever": asdict(draw.cantilever), "particles": result.particles,
            "estimated": result.until / body.t_end,
            "estimates": {name: {"delta": one.delta, "trust": one.trust, "index": index[name]}
                          for name, one in result.estimate.items() if name in index},
            "goals": {name: {**one._asdict(), "true": true[name]} for name, one in result.goals.items()
                      if name in true}, "seconds": time.perf_counter() - begun}


def compare_with_truth(body: Body, result: "BodyResult", cuts: tuple[np.ndarray, np.ndarray] = TRUE_CUTS,
                       order: int = TRUE_ORDER) -> tuple[dict[str, float], dict[str, float | None]]:
    """Returns by quantity the index of a cantilever's finished run, over the samples that have an estimate, and the
    true values of its goals at its particles, from a companion of this ``order`` on elements with these ``cuts``."""
    from solvers.bodies.companion import BodyCompanion
    from solvers.bodies.estimate import QUANTITIES
    from solvers.bodies.material_points import MaterialPoints
    from solvers.bodies.particle_comparison import ParticleComparison

    run = MaterialPoints(body, SAMPLES, body.lattice_counts, half_start=True)
    truth = BodyCompanion(body, [cuts], order, body.t_end / SAMPLES)
    comparison, times, errors = ParticleComparison(run, [truth, truth], 0.0, body.goals), [0.0], []
    for _ in range(SAMPLES):
        run.advance()
        truth.advance()
        times.append(run.time)
        differences = comparison.compare()
        if run.time <= result.until:
            errors.append(differences.found)
    means = np.mean(errors, axis=0) if errors else ()
    return ({name: result.estimate[name].mean / float(mean) for name, mean in zip(QUANTITIES, means, strict=False)},
            {name: series.companion_value(np.array(times)) for name, series in comparison.goals.items()})
