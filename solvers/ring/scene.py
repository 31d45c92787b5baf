"""RingScene: a run of the expanding ring, its defaults and its rules."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, Literal, get_args

from solvers.scene import Scene, SceneError, require_number, require_whole

Problem = Literal["ring"]
Method = Literal["ugimp", "cpgimp", "cpdi", "mpm"]
BodyForce = Literal["material", "none", "two-tone"]
PositionUpdate = Literal["grid", "particle"]
ParticleLayout = Literal["polar", "cartesian"]
Plan = Literal["auto", "serial", "parallel"]

INVERSION = 0.386  # amplitude at which the exact ring turns inside out: 1 + A min w' reaches 0
WRINKLING = 0.198  # amplitude at which the surface of the compressed ring wrinkles (Biot)


@dataclass(frozen=True)
class RingScene(Scene):
    """One run of the ring: h = 1.2 m/``cells``, ``particles_per_cell`` counts per direction.

    ``plan`` says how the step is spread over threads: one serial kernel, slabs side by side, or whichever is faster.
    """

    problem: Problem = "ring"
    method: Method = "cpdi"
    cells: int = 24
    particles_per_cell: int = 2
    amplitude: float = 0.1
    modulus: float = 1e7
    density: float = 1000.0
    body_force: BodyForce = "material"
    velocity: PositionUpdate = "grid"
    layout: ParticleLayout = "polar"
    plan: Plan = "auto"

    CHOICES: ClassVar[dict[str, tuple[str, ...]]] = {
        **Scene.CHOICES, "problem": get_args(Problem), "method": get_args(Method),
        "body_force": get_args(BodyForce), "velocity": get_args(PositionUpdate),
        "layout": get_args(ParticleLayout), "plan": get_args(Plan)}
    EXTRA_ERROR: ClassVar[str] = "a_nodes"
    STRAIN_PER_AMPLITUDE: ClassVar[float] = 1 / INVERSION
    DIMENSIONS: ClassVar[int] = 2
    FEWEST_CELLS: ClassVar[int] = 8
    DEFAULT_PERIODS: ClassVar[float] = 1.0
    SAMPLES_A_PERIOD: ClassVar[int] = 50  # a sample of a ring costs more than a step

    @property
    def solution_known(self) -> bool:
        """The manufactured solution needs its own force: without it the ring swings freely, nobody knows how."""
        return self.body_force == "material"

    @property
    def spacing(self) -> float:
        """Cell size h."""
        return 1.2 / self.cells

    @property
    def particles(self) -> int:
        """Number of particles in the polar layout; close to it in the Cartesian one."""
        return math.prod(polar_counts(self.cells, self.particles_per_cell))

    def warnings(self) -> list[str]:
        sentences = super().warnings()
        if self.amplitude > WRINKLING:
            sentences.append(
                f"amplitude {self.amplitude:g}: above {WRINKLING} the surface of a real ring wrinkles; what the "
                "particles do then is physics, not error, and the exact solution no longer describes it")
        return sentences

    def _check_amplitude(self) -> None:
        allowed = f"give a number above 1e-12 and below {INVERSION}"
        require_number("amplitude", self.amplitude, 1e-12, math.inf, allowed)
        if self.amplitude >= INVERSION:
            raise SceneError("amplitude", self.amplitude,
                             f"the exact ring turns inside out from {INVERSION} on; {allowed}")

    def _check_combinations(self) -> None:
        require_whole("particles_per_cell", self.particles_per_cell, 1, 6)
        if self.cells > 10_000:
            raise SceneError("cells", self.cells, "give a whole number from 8 to 10,000")
        if self.linearity_preserving:
            # Measured at 48 cells, A = 0.1: everywhere, the internal forces no longer cancel (0.4 of their sum, all at
            # the surface) and uGIMP blows up within a period; at nodes full of material alone, x gets 21 % better for
            # uGIMP and 15 % worse for CPDI, whose parallelograms tile and leave nothing to correct.
            raise SceneError("linearity_preserving", True,
                             "is not offered for the ring: at the free surface it breaks action and reaction and the "
                             "run blows up, and away from it CPDI gains nothing; leave it off")
        if self.plan == "serial" and self.threads > 1:
            raise SceneError("threads", self.threads,
                             "the serial plan runs on one; give 1, or the plan parallel or auto")


def polar_counts(cells: int, particles_per_cell: int) -> tuple[int, int]:
    """Particles around the quarter and across the ring: as many as make their domains about h/ppc wide."""
    return max(1, round(2 * cells * particles_per_cell / 3)), max(1, round(cells * particles_per_cell / 6))
