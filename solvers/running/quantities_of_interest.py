"""Quantities of interest of a run, each with its true and estimated errors.

A goal is a functional J of the particles at the end. If the values q have the errors e, the goal has the error J(q) -
J(q - e), exactly and not only to first order. Errors of particles can cancel: a mean may be far more accurate."""

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from solvers.problems import PROBLEMS
from solvers.scene.scene import Scene
from solvers.scene.validation import SceneError
from solvers.solver.error_series import IGNORE_OVERFLOW, finite_or_none
from solvers.solver.particle_snapshot import TRUTH, ParticleFields, ParticleValues
from solvers.solver.rounding import largest_rounding_error

#: Length of the bar around a value over the estimated error. Not fitted: twice, as in two standard deviations.
#: How often such a bar contains the exact value is measured in ``assets/coverage.md``.
SAFETY = 2.0
DISPLACEMENT, STRESS, ENERGY = "displacement", "mean-stress", "kinetic-energy"
UNITS = {DISPLACEMENT: "m", STRESS: "Pa", ENERGY: "J"}
POINT_PATTERN = re.compile(rf"{DISPLACEMENT}@([^,@]+)(?:,([^,@]+))?")
#: Particles around a point, and the degree of the polynomial through them, by dimensions: the order of its error is
#: higher than that of the method, which is two.
AROUND, DEGREE = {1: 4, 2: 12}, {1: 3, 2: 2}


@dataclass(frozen=True)
class QuantityOfInterest:
    """Quantity of interest by its ``name``: "kinetic-energy", "mean-stress" (sigma along the bar, half the trace in the
    plane, averaged over the initial volume) or "displacement@X" ("displacement@X,Y" in the plane: its length), at the
    material point with these coordinates in m."""

    name: str
    point: tuple[float, ...] = ()

    @property
    def unit(self) -> str:
        return UNITS[self.name.partition("@")[0]]

    def functional(self, fields: ParticleFields) -> Callable[[ParticleValues], float]:
        """Returns the function that computes the quantity, in its unit, from values of the particles of ``fields``."""
        if self.point:
            weights = point_weights(fields.material_position, np.array(self.point))
            size: Callable = np.linalg.norm if len(self.point) > 1 else np.squeeze  # of one component with its sign
            return lambda q: float(size(weights @ q.displacement))
        if self.name == ENERGY:
            return lambda q: 0.5 * float(fields.mass @ np.sum(q.velocity**2, axis=1))
        return lambda q: float(np.average(q.stress[:, [0, -1]].mean(axis=1), weights=fields.volume))

    def rounding(self, scene: Scene, steps: int, value: float, mass: float) -> float:
        """Returns the largest error of ``value`` by rounding in so many steps, in its unit, for a ``mass`` in kg of all
        particles: energy is m v^2/2, and dE = m v dv."""
        if self.name == ENERGY:
            return math.sqrt(2 * abs(value) * mass) * float(largest_rounding_error(scene, "v", steps))
        return float(largest_rounding_error(scene, "x" if self.point else "sigma", steps))


def parse_goals(scene: Scene, names: Sequence[str]) -> list[QuantityOfInterest]:
    """Returns the goals with these names (:class:`QuantityOfInterest`), without duplicates. Raises :class:`SceneError`
    for an invalid name, and for a point outside the scene's body."""
    return [_parse_goal(scene, name) for name in dict.fromkeys(names)]


def _parse_goal(scene: Scene, name: str) -> QuantityOfInterest:
    if name in (STRESS, ENERGY):
        return QuantityOfInterest(name)
    coordinates = ["X", "X,Y"][scene.DIMENSIONS - 1]
    found = POINT_PATTERN.fullmatch(name) if isinstance(name, str) else None
    if found is None:
        raise SceneError("goal", name, f"is no goal; give {ENERGY}, {STRESS} or {DISPLACEMENT}@{coordinates} with the "
                                       "coordinates of a material point in m")
    try:
        point = tuple(float(word) for word in found.groups() if word is not None)
    except ValueError:
        point = ()
    if len(point) != scene.DIMENSIONS or not all(map(math.isfinite, point)):
        raise SceneError("goal", name, f"needs {scene.DIMENSIONS} coordinate{'s' * (scene.DIMENSIONS > 1)} in m: give "
                                       f"{DISPLACEMENT}@{coordinates}")
    if PROBLEMS[scene.problem].reference.is_outside(scene, np.array([point])).any():
        raise SceneError("goal", name, "is at no point of the body at rest: " + scene.SETTING.rstrip("."))
    return QuantityOfInterest(name, point)


@IGNORE_OVERFLOW
def evaluate_goal(goal: QuantityOfInterest, fields: ParticleFields, scene: Scene, steps: int) -> dict[str, Any]:
    """Returns a goal after ``steps`` steps as in the JSON object: ``value`` in its ``unit``, ``true_error``, the
    largest effect of ``rounding``, and by estimator the signed ``estimated_error`` and the ``bar``, :data:`SAFETY`
    times its size. None stands for unknown or infinite numbers."""
    number = goal.functional(fields)
    value = number(fields.values)
    errors = {name: finite_or_none(value - number(fields.values.minus_errors(e))) for name, e in fields.errors.items()}
    truth = errors.pop(TRUTH, None)
    bars = {name: None if error is None else SAFETY * abs(error) for name, error in errors.items()}
    return {"value": finite_or_none(value), "unit": goal.unit, "true_error": truth,
            "rounding": finite_or_none(goal.rounding(scene, steps, value, float(fields.mass.sum()))),
            "estimated_error": errors, "bar": bars}


def mask_refused(goals: Mapping[str, dict], refused: Mapping[str, str]) -> dict[str, dict]:
    """Returns goals by name, as of :func:`evaluate_goal`, with None as estimated error and bar of ``refused``
    estimators, which map to the reasons why they do not hold."""
    def mask(values: dict) -> dict:
        return {name: None if name in refused else value for name, value in values.items()}
    return {name: {**goal, "estimated_error": mask(goal["estimated_error"]), "bar": mask(goal["bar"])}
            for name, goal in goals.items()}


def point_weights(X: np.ndarray, point: np.ndarray) -> np.ndarray:
    """Returns weights (P,) that interpolate values at particles X (P, D) in m to a point (D,) in m, by a least-squares
    polynomial through the nearest particles."""
    dimensions = X.shape[1]
    away = X - point
    near = np.argsort(np.sum(away**2, axis=1), kind="stable")[:AROUND[dimensions]]
    scale = np.abs(away[near]).max() or 1.0
    terms = _monomials(away[near] / scale, DEGREE[dimensions])
    weights = np.zeros(len(X))
    weights[near] = np.linalg.pinv(terms)[0]  # the constant term is the value at the point
    return weights


def _monomials(away: np.ndarray, degree: int) -> np.ndarray:
    if away.shape[1] == 1:
        return away ** np.arange(degree + 1)
    x, y = away.T
    return np.stack([x**i * y**(total - i) for total in range(degree + 1) for i in range(total, -1, -1)], axis=1)
