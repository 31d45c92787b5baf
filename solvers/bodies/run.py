"""run_body(body) -> BodyResult: the run of a body with its two companions, estimated errors and goals."""

import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from solvers.bodies.body import SAMPLES, Body
from solvers.bodies.companion import BodyCompanion
from solvers.bodies.estimate import QUANTITIES, ErrorEstimate, QuantityEstimate, extrapolation_factor
from solvers.bodies.goal_values import GoalValue
from solvers.bodies.material_points import MaterialPoints
from solvers.bodies.particle_comparison import ParticleComparison
from solvers.bodies.recovered_estimate import RecoveredEstimate
from solvers.bodies.rectangle import RECOVERED, check_estimator
from solvers.bodies.spectral_mesh import ORDERS, default_cuts
from solvers.scene.estimator_registry import COMPANION
from solvers.solver.base import CRUSHED, ESCAPED, INVERTED, SOUND
from solvers.translatable_message import Message

SCHEMA = "mpm-lab/body/1"
FAILURES = {INVERTED: Message("a particle has turned inside out"), CRUSHED: Message("a particle has been crushed"),
            ESCAPED: Message("a particle has left the domain; give a larger one")}


@dataclass(frozen=True)
class BodyResult:
    """Result of a body's run; times in s. ``status`` is "ok" or "unstable", ``reason`` a sentence why, ``until`` the
    time of the last estimate, ``estimate`` by quantity, ``goals`` by name; ``remarks`` are sentences on what limits the
    estimate, ``companion`` describes the companions, ``recovered`` is a second estimate (``RecoveredEstimate.to_dict``)
    if one was asked for. ``curves`` are, by goal, what it is about in each sample and its bar, None without one."""

    body: Body
    status: str
    reason: str
    time: float
    steps: int
    particles: int
    until: float
    estimate: dict[str, QuantityEstimate]
    goals: dict[str, GoalValue]
    remarks: tuple[str, ...]
    companion: dict[str, Any]
    recovered: dict[str, Any] | None
    seconds: dict[str, float]
    curves: dict[str, list[tuple[float, float | None]]]

    def to_dict(self) -> dict[str, Any]:
        """Returns the result as a JSON object, in SI units."""
        estimates = {name: {**one.to_dict(), "unit": QUANTITIES[name]} for name, one in self.estimate.items()}
        return {"schema": SCHEMA, "body": asdict(self.body), "status": self.status, "reason": self.reason or None,
                "t": self.time, "steps": self.steps, "particles": self.particles, "estimated_until": self.until,
                "estimate": estimates, "goals": {name: one._asdict() for name, one in self.goals.items()},
                "warnings": self.body.warnings(), "remarks": list(self.remarks), "companion": self.companion,
                "recovered": self.recovered, "seconds": self.seconds}


def run_body(body: Body, on_progress: Callable[[float], None] | None = None, estimator: str = COMPANION) -> BodyResult:
    """Runs a body to its end, or until it becomes unstable; ``on_progress`` is called with the part done, 0 to 1. With
    the ``estimator`` "recovered" a rectangle gets a second estimate beside that of the companions."""
    run = BodyRun(body, estimator)
    while run.advance():
        if on_progress:
            on_progress((len(run.times) - 1) / SAMPLES)
    return run.result()


class BodyRun:
    """Run of a body sample by sample, beside companions of orders 4 and 6 on the same elements. ``times`` in s of the
    samples so far, the start included, ``position`` (P, 2) in m at rest, ``curves`` by goal what it is about in each
    sample and its bar (None without one); ``error_sizes`` (P, 3) are those of the errors that were estimated at the
    particles in the last sample, in the order of ``QUANTITIES``."""

    def __init__(self, body: Body, estimator: str = COMPANION):
        check_estimator(body, estimator)
        self.body, self._cuts = body, default_cuts(body)
        loaded = bool(np.any(body.gravity)) or body.has_force
        begun = time.process_time()
        self._particles = MaterialPoints(body, SAMPLES, body.lattice_counts, half_start=loaded)
        self._companions = [BodyCompanion(body, self._cuts, order, body.t_end / SAMPLES) for order in ORDERS]
        self._comparison = ParticleComparison(self._particles, self._companions, extrapolation_factor(body),
                                              body.goals)
        self.position, self.times = self._particles.lattice.position, [0.0]
        self.recovered = RecoveredEstimate(body, self._particles) if estimator == RECOVERED else None
        self.estimate = ErrorEstimate(body)
        self.goals = self._comparison.goals
        self.curves = {name: [one.last_value_and_bar(True)] for name, one in self.goals.items()}
        self.error_sizes = self._comparison.error_sizes
        self._spent = {"compile": 0.0, "run": 0.0, "companions": time.process_time() - begun}

    @property
    def displacement(self) -> np.ndarray:
        """Displacement (P, 2) in m of the particles at the last sample."""
        return self._particles.displacement

    @property
    def largest_volume(self) -> float:
        """Largest volume of a particle at rest, in m^2."""
        return float(self._particles.lattice.volume.max())

    def advance(self) -> bool:
        """Advances to the next sample; returns False if the run has ended before or become unstable on the way."""
        if len(self.times) > SAMPLES:
            return False
        run, begun = self._particles, time.process_time()
        run.advance(*((self.recovered.interval, self.recovered.follow) if self.recovered else ()))
        middle = time.process_time()
        if run.verdict[0] != SOUND:
            return False
        if self.recovered:
            self.recovered.add_sample()
        self._add_to_estimate()
        for name, series in self.goals.items():
            self.curves[name].append(series.last_value_and_bar(self.has_bars))
        _count_seconds(self._spent, len(self.times) - 1, middle - begun, time.process_time() - middle)
        self.times.append(run.time)
        return True

    def _add_to_estimate(self) -> None:
        """Advances the companions to the sample and compares. Once the estimate has ended they are asked no more, and
        have no numbers."""
        if ended := bool(self.estimate.sentence):
            for one in self._companions:
                one.motion[:] = np.nan
        else:
            for one in self._companions:
                one.advance()
        differences, finer = self._comparison.compare(), self._companions[-1]
        if not ended:
            stretch = finer.mesh.least_stretch(finer.u) if np.isfinite(differences.apart).all() else (1.0, np.zeros(2))
            self.estimate.add(self._particles.time, differences, *stretch)

    @property
    def has_bars(self) -> bool:
        """Whether what goals are about has a bar now: not once the estimate has ended."""
        return not self.estimate.sentence

    def goal_values(self) -> dict[str, GoalValue]:
        """Returns the goals' values in the samples so far. Those decided before an end of the estimate have a bar; or,
        where the body may have folded, before it was pressed to less than half."""
        known = len(self.times) if self.has_bars else self.estimate.sound_samples
        return {name: one.evaluate(np.array(self.times), known) for name, one in self.goals.items()}

    def result(self) -> BodyResult:
        """Returns the result of the run so far."""
        run, (kind, step, _) = self._particles, self._particles.verdict
        sound, mesh = kind == SOUND, self._companions[0].mesh
        return BodyResult(
            body=self.body, status="ok" if sound else "unstable",
            reason="" if sound else Message("{failure}, found at step {step:,}", FAILURES[kind], step),
            time=self.times[-1], steps=run.steps * (len(self.times) - 1), particles=len(self.position),
            until=self.estimate.until, estimate=self.estimate.quantities(),
            goals=self.goal_values() if sound else {name: GoalValue(None, None, one.goal.unit)
                                                    for name, one in self.goals.items()},
            remarks=tuple(self.estimate.remarks(min(len(one) - 1 for pair in self._cuts for one in pair))),
            companion={"orders": list(ORDERS), "elements": mesh.elements,
                       "points": [len(one.mesh.points) for one in self._companions],
                       "extrapolation": self.estimate.factor},
            recovered=self.recovered.to_dict() if self.recovered else None,
            seconds=self._spent, curves=self.curves)


def _count_seconds(spent: dict[str, float], sample: int, run: float, companions: float) -> None:
    """Adds processor time in s of one sample; the first also compiles, and counts as another one."""
    if sample == 1:
        spent["compile"] = max(0.0, spent["run"] + spent["companions"] - 2 * (run + companions))
        spent["run"], spent["companions"] = run, companions
    spent["run"] += run
    spent["companions"] += companions
