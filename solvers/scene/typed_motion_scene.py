"""Base class of scenes whose displacement can be typed as formulas in place of the built-in one."""

from __future__ import annotations

import functools
import math
from abc import abstractmethod
from typing import TYPE_CHECKING, Any, ClassVar

from solvers.motion.formula import FormulaError
from solvers.motion.typed_motion import MotionParameters1D, MotionParameters2D, find_period, parse_motion
from solvers.scene.validation import SceneError, require_number

TYPED = "typed"  # the compile-time option of such a motion, whatever the formula

if TYPE_CHECKING:
    from solvers.scene.scene import Scene
else:
    Scene = object  # a dataclass as base would give its fields again, in front of those of other bases


class TypedMotionScene(Scene):
    """Scene with a field ``displacement``: formulas in place of the built-in displacement, or ""."""

    TYPED_TITLE: ClassVar[str]
    displacement: Any

    @property
    @abstractmethod
    def motion_inputs(self) -> MotionParameters2D | MotionParameters1D:
        """Parameters, such as w and A, that the formulas of its displacement may use."""

    @property
    def base_frequency(self) -> float:
        """Angular frequency w in 1/s: pi over the time in which a wave in a bar travels one metre."""
        return math.pi * math.sqrt(self.modulus / self.density)

    @property
    def motion_formula(self) -> str:
        """Formulas of the displacement in m from which the exact solution is computed, or ""."""
        return self.displacement

    @property
    def typed_solution(self) -> Any:
        """Exact solution that follows from :attr:`motion_formula`."""
        return self.motion_inputs.solution(self.motion_formula)

    @functools.cached_property
    def motion_period(self) -> float:
        """Time in s after which the motion by :attr:`motion_formula` returns."""
        return find_period(self.motion_formula, self.motion_inputs)

    @property
    def title(self) -> str:
        return self.TYPED_TITLE if self.displacement else self.TITLE

    @property
    def motion_fields(self) -> tuple[str, ...]:
        return () if self.displacement and "A" not in self.displacement else super().motion_fields

    def _normalized_inputs(self) -> dict[str, Any]:
        """Returns inputs by field name in their normal form, the formula as in links; SceneError if it is none."""
        if not isinstance(self.displacement, str):
            raise SceneError("displacement", self.displacement, "is no text; give formulas such as "
                                                                "0.02*sin(2*pi*X)*sin(w*t)")
        try:
            text = parse_motion(self.displacement, self.DIMENSIONS).text if self.displacement.strip() else ""
        except FormulaError as error:
            raise SceneError("displacement", self.displacement, str(error)) from None
        return {**super()._normalized_inputs(), "displacement": text}

    def _check_amplitude(self) -> None:
        if not self.displacement:
            return super()._check_amplitude()  # type: ignore[safe-super]  # of a problem that has one
        require_number("amplitude", self.amplitude, 1e-12, math.inf)

    def _check_time(self) -> None:
        try:
            float(self.motion_period if self.displacement else 1.0)  # fails where the formula has no period
        except FormulaError as error:
            raise SceneError("displacement", self.displacement, str(error)) from None
        super()._check_time()
