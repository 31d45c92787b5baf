"""``mpm-lab run ring``: the flags of the ring and their defaults."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from app.commands.flags import NumberFlag, RealFlag, choice_flag
from app.commands.run import Run
from app.commands.scene_flags import SceneFlags, periods_flag, sample_every_flag
from solvers.ring.scene import BodyForce, Method, ParticleLayout, Plan, PositionUpdate, RingScene
from solvers.scene import Scene


@dataclass(frozen=True, kw_only=True)
class RingFlags(SceneFlags):
    """The flags of a scene of the ring."""

    SCENE: ClassVar[type[Scene]] = RingScene

    method: choice_flag(Method) = RingScene.method
    """Shape functions of the particles."""
    cells: NumberFlag = RingScene.cells
    """Cells of the grid along a side; h = 1.2 m / cells."""
    ppc: NumberFlag = RingScene.particles_per_cell
    """Particles per cell and direction."""
    amplitude: RealFlag = RingScene.amplitude
    """Amplitude A of the outer surface's displacement, m."""
    modulus: RealFlag = RingScene.modulus
    """Young's modulus E, Pa; Poisson's ratio is 0."""
    density: RealFlag = RingScene.density
    """Density, kg/m3."""
    periods: periods_flag(RingScene) = None
    """End of the run in periods of the vibration; instead of --t-end."""
    body_force: choice_flag(BodyForce) = RingScene.body_force
    """Body force: at material points, none, or two tones; only the first has a built-in solution."""
    linearity_preserving: bool = RingScene.linearity_preserving
    """Not offered for the ring: only off is accepted."""
    velocity: choice_flag(PositionUpdate) = RingScene.velocity
    """Velocity that moves the particles."""
    layout: choice_flag(ParticleLayout) = RingScene.layout
    """Lattice on which the particles begin."""
    plan: choice_flag(Plan) = RingScene.plan
    """How the step is spread over the threads; auto takes the faster one for the number of particles."""
    sample_every: sample_every_flag(RingScene) = None
    """Steps between two samples of the errors."""


@dataclass(frozen=True, kw_only=True)
class RunRing(Run, RingFlags):
    """Run the expanding ring once and report its true and estimated errors.

    A quarter of a ring with radii 0.4 m and 0.6 m on a square grid, 1.2 m wide. Without --json a table goes to
    standard output. Exit status: 0 ok, 1 could not run or write, 2 bad input, 3 the run went unstable.
    """
