"""Data of a run at one time: particles for frames, all fields with their errors; and the run's wall time."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

TRUTH = "truth"  # the name of the true errors among those of estimators


@dataclass(frozen=True)
class Snapshot:
    """P particles of a run at one time, in SI; columns of errors are x, v, sigma, a.

    Positions are (P,) for the bar and (P, 2) in the plane, F (P,) and (P, 2, 2). ``error`` (P, 4) is computed minus
    exact for the bar, the size of that in the plane, or None without the truth; ``estimate`` maps an estimator to (P,
    4), and ``difference`` to the sizes of estimate minus truth (P, 4), only where they were asked for and the truth is
    known; ``last_crossing`` (P,) is the step of each particle's last cell change (-1: never), or None. ``plotted`` (P,
    2) is the bar's field that was asked for and its deviation from the exact one, NaN where it is not known.
    """

    step: int
    time: float
    material_position: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    deformation_gradient: np.ndarray
    error: np.ndarray | None
    estimate: dict[str, np.ndarray]
    last_crossing: np.ndarray | None
    difference: dict[str, np.ndarray] = field(default_factory=dict)
    plotted: np.ndarray | None = None


class ParticleValues(NamedTuple):
    """Displacement (P, D) in m, velocity (P, D) in m/s and Cauchy stress (P, S) in Pa: sigma along the bar (S = 1); xx,
    xy, yy in the plane (S = 3). Or the errors of these, computed minus exact."""

    displacement: np.ndarray
    velocity: np.ndarray
    stress: np.ndarray

    def minus_errors(self, errors: "ParticleValues") -> "ParticleValues":
        """Returns the values corrected by their ``errors``, computed minus exact."""
        return ParticleValues(*(mine - theirs for mine, theirs in zip(self, errors, strict=True)))


@dataclass(frozen=True)
class ParticleFields:
    """Fields of P particles at one time: positions at rest (P, D) in m, masses in kg and initial volumes in m^D (P,),
    their values, and the errors of these by source: each estimator that ran, and :data:`TRUTH`."""

    material_position: np.ndarray
    mass: np.ndarray
    volume: np.ndarray
    values: ParticleValues
    errors: Mapping[str, ParticleValues] = field(default_factory=dict)


@dataclass(frozen=True)
class WallTimes:
    """Wall time in s: setting up, compiling (or loading from the cache), running, and each estimator's part."""

    setup: float
    compile: float
    run: float
    estimators: dict[str, float]

    @property
    def estimate(self) -> float | None:
        """Part of the run that all estimators took together; None without any."""
        return sum(self.estimators.values()) if self.estimators else None
