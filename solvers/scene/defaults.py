"""What holds for the scene of most problems, and what a problem that knows better replaces."""

import math
from abc import abstractmethod
from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from solvers.scene.momentum_balance import Moments
from solvers.scene.validation import require_whole

MOST_PER_CELL = 64  # particles, along each direction


class SceneDefaults:
    """Rules and facts of a scene whose motion swings to and fro, at a wave's speed, and whose cells hold whole numbers
    of particles."""

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

    @property
    def wave_speed(self) -> float:
        """c = sqrt(E/rho)."""
        return math.sqrt(self.modulus / self.density)

    @property
    def angular_frequency(self) -> float:
        """w = c pi/l of the exact solution, l = 1 (eq 32)."""
        return self.wave_speed * math.pi

    @property
    def motion_amplitude(self) -> float:
        """Largest displacement of the exact solution."""
        return self.amplitude

    def size_of(self, quantity: str) -> float:
        """What an error of x, v, sigma or a is compared with: A, A w, E times the largest strain, A w^2."""
        A, w = self.motion_amplitude, self.angular_frequency
        return {"x": A, "v": A * w, "sigma": self.modulus * A * self.STRAIN_PER_AMPLITUDE, "a": A * w * w}[quantity]

    @abstractmethod
    def rms_of(self, quantity: str) -> float:
        """How large x (its displacement), v, sigma or a is in the exact motion itself: RMS over the body and a
        period, in SI; without a built-in solution, that of the one with the built-in force."""

    @abstractmethod
    def balanced_motion(self, times: np.ndarray) -> Moments:
        """Moments of the motion that the balance of momentum makes of the body at the times (T,) in s, which the
        samples of its run are held against."""

    @property
    def lattice_gap(self) -> float:
        """By how much, as RMS in amplitudes, the exact motion at its largest moves neighbours otherwise than the mean
        of their deformation says, and one that is half wrong does, because they are few."""
        return 0.0

    @property
    def drift_speed(self) -> float:
        """The speed in m/s at which the body as a whole moves on."""
        return 0.0

    @property
    def initial_stretch(self) -> float:
        """F at the start."""
        return 1.0

    @property
    def solution_known(self) -> bool:
        """Whether an exact solution is built in, so that there is a true error."""
        return self.body_force != "two-tone"

    @property
    def for_gpu(self) -> bool:
        """Whether it is to run on a GPU, if there is one: what it may be does not depend on that."""
        return self.arch != "cpu" and self.DIMENSIONS > 1

    @property
    def title(self) -> str:
        """What moves, in words."""
        return self.TITLE

    @property
    def moved_by(self) -> tuple[str, ...]:
        """The fields that say how it moves."""
        return ("amplitude",)

    @property
    def swings(self) -> bool:
        """Whether the exact motion goes to and fro; where it does not, exactly nothing should happen: no body force may
        be chosen, and cells need not hold whole numbers of particles."""
        return True

    @property
    def loss_limits(self) -> Mapping[str, float]:
        """Errors beside that of x from which on a run counts as lost, over ``size_of`` their quantities."""
        return {}

    def _check_per_cell(self) -> None:
        """Refuse what is no number of particles in a cell."""
        require_whole("ppc", self.ppc, 1, MOST_PER_CELL)

    def _check_combinations(self) -> None:
        """Refuse what does not go together."""
