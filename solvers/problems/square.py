"""The axis-aligned displacement in a unit square: nothing moves across its sides, and particles tile it.

Source: Wallstedt & Guilkey, An evaluation of explicit time integration schemes for use with the generalized
interpolation material point method, J. Comput. Phys. 227 (2008) 9628-9642.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import Any

from solvers.motion.formula import FormulaError
from solvers.motion.jets import sin
from solvers.motion.typed_motion import MotionInputs, find_period, read_motion
from solvers.problems.planar.box import BoxScene
from solvers.problems.planar.problem import PlanarProblem, Showing
from solvers.scene.option import described, option
from solvers.scene.rules import SceneError, require_number


@described
@dataclass(frozen=True)
class SquareScene(BoxScene):
    """One run of the square: h = 1 m/``cells``, ``ppc`` counts per direction."""

    problem: str = option("square", choices=("square",))
    amplitude: float = option(0.02, "Amplitude A of the displacement", "m")
    displacement: str = option("", "Displacement u_x, u_y in m, formulas of X, Y, t, A and w with a comma between, in "
                               "place of the built-in one", hint="A*sin(2*pi*X)*sin(w*t), -A*sin(2*pi*Y)*sin(w*t)")

    TITLE = "axis-aligned square"
    SETTING = "A square, 1 m wide, between four planes of symmetry."
    STRAIN_PER_AMPLITUDE = 2 * math.pi
    MOST_AMPLITUDE = 0.15  # at 1/(2 pi) it turns inside out
    GENTLE_AMPLITUDE, HARD_AMPLITUDES = 0.01, (0.02, 0.05, 0.1)

    @property
    def base_frequency(self) -> float:
        """w in 1/s: pi over the time in which a bar's sound crosses the square."""
        return math.pi * math.sqrt(self.modulus / self.density) / self.SIDE

    @functools.cached_property
    def angular_frequency(self) -> float:
        if not self.displacement:
            return self.base_frequency
        return 2 * math.pi / find_period(self.displacement, MotionInputs(
            self.base_frequency, self.amplitude, self.material, self.density, self.SIDE))

    def displacement_at(self, X: Any, Y: Any, t: Any) -> tuple[Any, Any]:
        if self.displacement:
            return read_motion(self.displacement).displacement(self, X, Y, t)
        A, w = self.amplitude, self.base_frequency
        return A * sin(2 * math.pi * X) * sin(w * t), -A * sin(2 * math.pi * Y) * sin(w * t)

    @property
    def title(self) -> str:
        return "square that moves as typed" if self.displacement else self.TITLE

    @property
    def moved_by(self) -> tuple[str, ...]:
        return () if self.displacement and "A" not in self.displacement else super().moved_by

    def _normalized(self) -> dict[str, Any]:
        return {**super()._normalized(), "displacement": self._formula()}

    def _formula(self) -> str:
        """The typed displacement as it is written into links."""
        if not isinstance(self.displacement, str):
            raise SceneError("displacement", self.displacement, "is no text; give formulas such as "
                                                                "0.02*sin(2*pi*X)*sin(w*t)")
        try:
            return read_motion(self.displacement).text if self.displacement.strip() else ""
        except FormulaError as error:
            raise SceneError("displacement", self.displacement, str(error)) from None

    def _check_amplitude(self) -> None:
        if not self.displacement:
            return super()._check_amplitude()
        require_number("amplitude", self.amplitude, 1e-12, math.inf)

    def _check_time(self) -> None:
        try:
            float(self.angular_frequency)  # is looked for in what was typed
        except FormulaError as error:
            raise SceneError("displacement", self.displacement, str(error)) from None
        super()._check_time()


SQUARE = PlanarProblem(SquareScene, Showing(
    cells=(8, 64, 4), ppc=(1, 3), amplitude=(1e-4, 0.15), modulus=(1e5, 1e8),
    amplitude_hint="largest displacement along x and along y; from 0.159 m on the exact square turns inside out",
    prices={"companion": 0.06, "recovered": 0.19, "transport": 0.06, "two-grid": 0.14}))
