"""A problem of your own: write down how a square moves, and the body force that makes it so, the error of every method
and the companion follow.

The displacement must be zero at t = 0, move nothing across the four sides, shear none of them, and come back after the
period 2 pi/w. Change it and run it again, from the root of the repository:

    uv run python lessons/scripts/own_problem.py

The commands and the page have it, too:    PYTHONPATH=lessons/scripts MPM_LAB_EXTENSIONS=own_problem uv run mpm-lab
"""

import math
from dataclasses import dataclass

from solvers import run
from solvers.motion.jets import cos, sin
from solvers.problems import register
from solvers.problems.planar.box_scene import BoxScene
from solvers.problems.planar.problem import PlanarProblem, ViewSettings
from solvers.scene.field_options import option


@dataclass(frozen=True)
class BreathingScene(BoxScene):
    """A square that grows in the middle and shrinks at its corners, and the other way round."""

    problem: str = option("breathing", choices=("breathing",))
    amplitude: float = option(0.02, "Amplitude A of the displacement", "m")

    TITLE = "breathing square"
    SETTING = "A square, 1 m wide, between four planes of symmetry."
    STRAIN_PER_AMPLITUDE = math.pi
    MOST_AMPLITUDE = 0.15
    GENTLE_AMPLITUDE, HARD_AMPLITUDES = 0.01, (0.02, 0.05, 0.1)

    @property
    def angular_frequency(self):
        return math.pi * math.sqrt(self.modulus / self.density)

    def displacement_at(self, X, Y, t):
        swing = self.amplitude * sin(self.angular_frequency * t)
        return swing * sin(math.pi * X) * cos(math.pi * Y), swing * cos(math.pi * X) * sin(math.pi * Y)


register(PlanarProblem(BreathingScene, ViewSettings(
    cells=(8, 64, 4), ppc=(1, 3), amplitude=(1e-4, 0.15), modulus=(1e5, 1e8), prices={},
    amplitude_hint="largest displacement along x and along y")))

if __name__ == "__main__":
    for cells in (8, 16, 32):
        result = run(BreathingScene(cells=cells, cfl=0.1, estimators=("companion",)))
        print(f"{cells} cells: error of x {result.error['x']['max']:.2e} m, index {result.index['companion']['x']:.3f}")
