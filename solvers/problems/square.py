"""The axis-aligned displacement in a unit square: nothing moves across its sides, and particles tile it.

Source: Wallstedt & Guilkey, An evaluation of explicit time integration schemes for use with the generalized
interpolation material point method, J. Comput. Phys. 227 (2008) 9628-9642.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from solvers.motion.jets import sin
from solvers.motion.typed_motion import MotionParameters2D, parse_motion
from solvers.problems.planar.box_scene import BoxScene
from solvers.problems.planar.problem import PlanarProblem, ViewSettings
from solvers.scene.field_options import document_fields, option
from solvers.scene.typed_motion_scene import TypedMotionScene
from solvers.translatable_message import Message


@document_fields
@dataclass(frozen=True)
class SquareScene(TypedMotionScene, BoxScene):
    """Definition of a run of the unit square: cells are 1 m/``cells`` wide, ``ppc`` counts per direction."""

    problem: str = option("square", choices=("square",))
    amplitude: float = option(0.02, "Amplitude A of the displacement", "m")
    displacement: str = option("", "Displacement u_x, u_y in m, formulas of X, Y, t, A and w with a comma between, in "
                               "place of the built-in one", hint="A*sin(2*pi*X)*sin(w*t), -A*sin(2*pi*Y)*sin(w*t)")

    TITLE, TYPED_TITLE = "axis-aligned square", Message("square that moves as typed")
    SETTING = "A square, 1 m wide, between four planes of symmetry."
    STRAIN_PER_AMPLITUDE = 2 * math.pi
    MOST_AMPLITUDE = 0.15  # at 1/(2 pi) it turns inside out
    GENTLE_AMPLITUDE, HARD_AMPLITUDES = 0.01, (0.02, 0.05, 0.1)

    @property
    def motion_inputs(self) -> MotionParameters2D:
        return MotionParameters2D(self.base_frequency, self.amplitude, self.material, self.density, self.SIDE)

    @property
    def angular_frequency(self) -> float:
        return 2 * math.pi / self.motion_period if self.displacement else self.base_frequency

    def displacement_at(self, X: Any, Y: Any, t: Any) -> tuple[Any, ...]:
        if self.displacement:
            return parse_motion(self.displacement).displacement(self, X, Y, t)
        A, w = self.amplitude, self.base_frequency
        return A * sin(2 * math.pi * X) * sin(w * t), -A * sin(2 * math.pi * Y) * sin(w * t)


SQUARE = PlanarProblem(SquareScene, ViewSettings(
    cells=(8, 64, 4), ppc=(1, 3), amplitude=(1e-4, 0.15), modulus=(1e5, 1e8),
    amplitude_hint="largest displacement along x and along y; from 0.159 m on the exact square turns inside out",
    prices={"companion": 0.06, "recovered": 0.19, "transport": 0.06, "two-grid": 0.14}))
