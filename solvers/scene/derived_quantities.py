"""Defaults of a scene that most problems share, and that a problem overrides where it differs."""

import math
from abc import abstractmethod
from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from solvers.scene.displacement_moments import DisplacementMoments
from solvers.scene.validation import require_whole

MOST_PER_CELL = 64  # particles, along each direction


class DerivedSceneQuantities:
    """Properties of a scene whose motion oscillates at a wave's speed and whose cells hold whole numbers of
    particles."""

    #: Fields that only single runs and sweeps have, each with the reason why no other command has them.
    RUN_ONLY: ClassVar[Mapping[str, str]] = {}
    DIMENSIONS: ClassVar[int]
    TITLE: ClassVar[str]  # what the problem is called, in the words of its command's help
    STRAIN_PER_AMPLITUDE: ClassVar[float]  # largest strain of the exact solution over its amplitude, 1/m
    amplitude: float
    modulus: float
    density: float
    body_force: str
    ppc: float
    arch: str
    estimators: tuple[str, ...]

    @property
    def wave_speed(self) -> float:
        """Wave speed c = sqrt(E/rho), in m/s."""
        return math.sqrt(self.modulus / self.density)

    @property
    def angular_frequency(self) -> float:
        """Angular frequency w = c pi/l of the exact solution, in 1/s, l = 1 (eq 32)."""
        return self.wave_speed * math.pi

    @property
    @abstractmethod
    def not_valid(self) -> dict[str, str]:
        """Requested estimators that are known not to hold here and do not run, by name, each with a sentence why."""

    @property
    def first_estimator(self) -> str | None:
        """Name of the estimator to show first: the first requested one that is valid here, or just the first; None
        without any."""
        return next((name for name in self.estimators if name not in self.not_valid), next(iter(self.estimators), None))

    @property
    def motion_amplitude(self) -> float:
        """Largest displacement of the exact solution, in m."""
        return self.amplitude

    def size_of(self, quantity: str) -> float:
        """Returns the scale, in SI, of errors of "x", "v", "sigma" or "a": A, A w, E times the largest strain, A
        w^2."""
        A, w = self.motion_amplitude, self.angular_frequency
        return {"x": A, "v": A * w, "sigma": self.modulus * A * self.STRAIN_PER_AMPLITUDE, "a": A * w * w}[quantity]

    @abstractmethod
    def rms_of(self, quantity: str) -> float:
        """Returns the RMS over body and period of "x" (the displacement), "v", "sigma" or "a" of the exact motion, in
        SI; without a built-in solution, of the motion under the built-in force."""

    @abstractmethod
    def momentum_balance_moments(self, times: np.ndarray) -> DisplacementMoments:
        """Returns sums of displacements, at the times (T,) in s, of the motion that follows from the balance of
        momentum, for comparison with the samples of a run."""

    @property
    def neighbour_mismatch(self) -> float:
        """Largest RMS mismatch, in amplitudes, between the displacements of neighbours and the mean of their
        deformations in an exact motion, or in one that is half wrong, where particles are few."""
        return 0.0

    @property
    def known_weakness(self) -> str:
        """What is known to break runs of this scene, as part of a sentence; "" for nothing."""
        return ""

    @property
    def drift_speed(self) -> float:
        """Speed of the body as a whole, in m/s."""
        return 0.0

    @property
    def initial_stretch(self) -> float:
        """Stretch F at the start, no unit."""
        return 1.0

    @property
    def solution_known(self) -> bool:
        """Whether an exact solution is built in, so that the true error is known."""
        return self.body_force != "two-tone"

    @property
    def prefers_gpu(self) -> bool:
        """Whether the run uses a GPU if there is one; which inputs are valid does not depend on that."""
        return self.arch != "cpu" and self.DIMENSIONS > 1

    @property
    def title(self) -> str:
        """Name of the problem, in words."""
        return self.TITLE

    @property
    def motion_fields(self) -> tuple[str, ...]:
        """Names of the fields that define the motion."""
        return ("amplitude",)

    @property
    def swings(self) -> bool:
        """Whether the exact motion oscillates. Otherwise nothing deforms in the exact solution: no body force can be
        chosen, and cells need not contain whole numbers of particles."""
        return True

    @property
    def loss_limits(self) -> Mapping[str, float]:
        """Errors, in units of ``size_of``, from which on a run counts as lost: by quantity, without that of x."""
        return {}

    def _check_per_cell(self) -> None:
        """Raises SceneError for an invalid number of particles per cell."""
        require_whole("ppc", self.ppc, 1, MOST_PER_CELL)

    def _check_combinations(self) -> None:
        """Raises SceneError for inputs that cannot be combined."""
