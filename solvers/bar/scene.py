"""BarScene: a run of the vibrating bar, its defaults and its rules."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, Literal, get_args

from solvers.scene import Scene, SceneError, require_number

Problem = Literal["bar"]
Method = Literal["mpm", "ugimp", "cpgimp", "bspline"]
BodyForce = Literal["material", "node", "none", "two-tone"]
PositionUpdate = Literal["grid", "particle", "corners"]

#: Above this amplitude the exact bar turns inside out: F = 1 + 2 pi A cos(2 pi X) sin(wt) reaches 0.
BAR_AMPLITUDE_LIMIT = 1 / (2 * math.pi)


@dataclass(frozen=True)
class BarScene(Scene):
    """One run of the bar of unit length: h = 1/``cells`` (see :class:`~solvers.scene.Scene`)."""

    problem: Problem = "bar"
    method: Method = "ugimp"
    cells: int = 40
    particles_per_cell: int = 4
    amplitude: float = 0.025
    modulus: float = 4.0
    density: float = 1.0
    body_force: BodyForce = "material"
    velocity: PositionUpdate = "grid"

    CHOICES: ClassVar[dict[str, tuple[str, ...]]] = {
        **Scene.CHOICES, "problem": get_args(Problem), "method": get_args(Method),
        "body_force": get_args(BodyForce), "velocity": get_args(PositionUpdate)}
    EXTRA_ERROR: ClassVar[str] = "sigma_log"
    STRAIN_PER_AMPLITUDE: ClassVar[float] = 1 / BAR_AMPLITUDE_LIMIT

    @property
    def spacing(self) -> float:
        """Cell size h."""
        return 1.0 / self.cells

    @property
    def particles(self) -> int:
        return self.cells * self.particles_per_cell

    @property
    def angular_frequency(self) -> float:
        """w of the exact solution: c pi/l with the body force (eq 32), the natural 2 c pi/l without; l = 1."""
        return self.wave_speed * math.pi * (2 if self.body_force == "none" else 1)

    @property
    def motion_amplitude(self) -> float:
        """Largest displacement of the exact solution: A; A/2 for the free bar, which starts at the same speed."""
        return self.amplitude / 2 if self.body_force == "none" else self.amplitude

    def _check_amplitude(self) -> None:
        allowed = "give a number above 1e-12 and below 0.159"
        require_number("amplitude", self.amplitude, 1e-12, math.inf, allowed)
        if self.amplitude >= BAR_AMPLITUDE_LIMIT:
            raise SceneError("amplitude", self.amplitude, f"the exact bar inverts from 1/(2 pi) = 0.159 on; {allowed}")

    def _check_combinations(self) -> None:
        if self.velocity == "corners" and self.method != "cpgimp":
            raise SceneError("velocity", "corners", "moves the corners of convected domains and needs "
                             "the method cpgimp; with other methods give grid or particle")
