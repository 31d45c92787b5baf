"""run_body(body) -> BodyResult: the run of a body with its two companions, estimated errors and goals."""

import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from solvers.bodies.body import Body
from solvers.bodies.companion import BodyCompanion
from solvers.bodies.estimate import QUANTITIES, ErrorEstimate, ParticleFields, QuantityEstimate, cauchy_stress
from solvers.bodies.goal_values import GoalSeries, GoalValue
from solvers.bodies.material_points import MaterialPoints
from solvers.bodies.spectral_mesh import ORDERS, LatticeReader, default_cuts
from solvers.solver.base import CRUSHED, ESCAPED, INVERTED, SOUND
from solvers.translatable_message import Message

SAMPLES = 60
SCHEMA = "mpm-lab/body/1"
FAILURES = {INVERTED: Message("a particle has turned inside out"), CRUSHED: Message("a particle has been crushed"),
            ESCAPED: Message("a particle has left the domain; give a larger one")}


@dataclass(frozen=True)
class BodyResult:
    """Result of a body's run; times in s. ``status`` is "ok" or "unstable", ``reason`` a sentence why, ``until`` the
    time of the last estimate, ``estimate`` by quantity, ``goals`` by name; ``remarks`` are sentences on what limits the
    estimate, ``companion`` describes the companions."""

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
    seconds: dict[str, float]

    def to_dict(self) -> dict[str, Any]:
        """Returns the result as a JSON object, in SI units."""
        estimates = {name: {**one.to_dict(), "unit": QUANTITIES[name]} for name, one in self.estimate.items()}
        return {"schema": SCHEMA, "body": asdict(self.body), "status": self.status, "reason": self.reason or None,
                "t": self.time, "steps": self.steps, "particles": self.particles, "estimated_until": self.until,
                "estimate": estimates, "goals": {name: one._asdict() for name, one in self.goals.items()},
                "warnings": self.body.warnings(), "remarks": list(self.remarks), "companion": self.companion,
                "seconds": self.seconds}


def run_body(body: Body, on_progress: Callable[[float], None] | None = None) -> BodyResult:
    """Runs a body to its end, or until it becomes unstable, beside companions of orders 4 and 6 on the same elements;
    ``on_progress`` is called with the part done, 0 to 1."""
    interval, cuts = body.t_end / SAMPLES, default_cuts(body)
    loaded = bool(np.any(body.gravity)) or body.has_force
    begun = time.process_time()
    run = MaterialPoints(body, SAMPLES, body.lattice_counts, half_start=loaded)
    companions = [BodyCompanion(body, cuts, order, interval) for order in ORDERS]
    readers = [LatticeReader(one.mesh, run.lattice.lattices) for one in companions]
    estimate = ErrorEstimate(body)
    goals = {name: GoalSeries(goal, run.lattice.position) for name, goal in body.goals.items()}
    spent, times = {"compile": 0.0, "run": 0.0, "companions": time.process_time() - begun}, [0.0]
    for sample in range(SAMPLES):
        begun = time.process_time()
        run.advance()
        middle = time.process_time()
        if run.verdict[0] != SOUND:
            break
        own = ParticleFields(run.displacement, run.velocity, cauchy_stress(body, run.deformation_gradient))
        if estimate.sentence:  # nothing is asked of the companions any more
            coarse = fine = ParticleFields(*(np.full_like(one, np.nan) for one in own))
        else:
            for one in companions:
                one.advance()
            coarse, fine = (read_companion(body, *pair) for pair in zip(companions, readers, strict=True))
            found = np.isfinite(fine.x).all()
            stretch = companions[1].mesh.least_stretch(companions[1].u) if found else (1.0, np.zeros(2))
            estimate.add(run.time, own, coarse, fine, *stretch)
        for series in goals.values():
            series.add(own, coarse, fine)
        times.append(run.time)
        _count_seconds(spent, sample, middle - begun, time.process_time() - middle)
        if on_progress:
            on_progress((sample + 1) / SAMPLES)
    kind, step, _ = run.verdict
    sound = kind == SOUND
    reason = "" if sound else Message("{failure}, found at step {step:,}", FAILURES[kind], step)
    instants, has_bar = np.array(times), not estimate.sentence
    return BodyResult(
        body=body, status="ok" if sound else "unstable", reason=reason, time=times[-1],
        steps=run.steps * (len(times) - 1), particles=len(run.lattice.volume), until=estimate.until,
        estimate=estimate.quantities(),
        goals={name: one.evaluate(instants, has_bar) if sound else GoalValue(None, None, one.goal.unit)
               for name, one in goals.items()},
        remarks=tuple(estimate.remarks(min(len(one) - 1 for pair in cuts for one in pair))),
        companion={"orders": list(ORDERS), "elements": companions[0].mesh.elements,
                   "points": [len(one.mesh.points) for one in companions], "extrapolation": estimate.factor},
        seconds=spent)


def read_companion(body: Body, companion: BodyCompanion, reader: LatticeReader) -> ParticleFields:
    """Returns a companion's fields at the particles."""
    u, gradient = reader.values_and_gradients(companion.u)
    return ParticleFields(u, reader.values(companion.v), cauchy_stress(body, np.eye(2) + gradient))


def _count_seconds(spent: dict[str, float], sample: int, run: float, companions: float) -> None:
    """Adds processor time in s of one sample; the first also compiles, and counts as another one."""
    if sample == 1:
        spent["compile"] = max(0.0, spent["run"] + spent["companions"] - 2 * (run + companions))
        spent["run"], spent["companions"] = run, companions
    spent["run"] += run
    spent["companions"] += companions
