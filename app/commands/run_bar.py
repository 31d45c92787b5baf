"""``mpm-lab run bar``: the flags of the bar and their defaults."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from app.commands.flags import NumberFlag, RealFlag, choice_flag
from app.commands.run import Run
from app.commands.scene_flags import SceneFlags, periods_flag, sample_every_flag
from solvers.bar.scene import BarScene, BodyForce, Method, PositionUpdate
from solvers.scene import Scene


@dataclass(frozen=True, kw_only=True)
class BarFlags(SceneFlags):
    """The flags of a scene of the bar."""

    SCENE: ClassVar[type[Scene]] = BarScene

    method: choice_flag(Method) = BarScene.method
    """Shape functions of the particles."""
    cells: NumberFlag = BarScene.cells
    """Cells of the grid; h = 1 m / cells."""
    ppc: NumberFlag = BarScene.particles_per_cell
    """Particles per cell."""
    amplitude: RealFlag = BarScene.amplitude
    """Amplitude A of the displacement, m."""
    modulus: RealFlag = BarScene.modulus
    """Young's modulus E, Pa."""
    density: RealFlag = BarScene.density
    """Density, kg/m3."""
    periods: periods_flag(BarScene) = None
    """End of the run in periods of the vibration; instead of --t-end."""
    body_force: choice_flag(BodyForce) = BarScene.body_force
    """Body force: at material points, at nodes, none, or two tones that have no built-in solution."""
    linearity_preserving: bool = BarScene.linearity_preserving
    """Make the particle-grid transfers exact for linear fields."""
    velocity: choice_flag(PositionUpdate) = BarScene.velocity
    """Velocity that moves the particles (corners: cpgimp only)."""
    sample_every: sample_every_flag(BarScene) = None
    """Steps between two samples of the errors."""


@dataclass(frozen=True, kw_only=True)
class RunBar(Run, BarFlags):
    """Run the vibrating bar once and report its true and estimated errors.

    The bar is 1 m long. Without --json a table goes to standard output.
    Exit status: 0 ok, 1 could not run or write, 2 bad input, 3 the run went unstable.
    """
