"""Goals: numbers that a user asks of a body's run, such as the least height of its tip; their names and checks."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from solvers.bodies.patch import SMALL, Patch, Point, require_point
from solvers.scene.validation import SceneError
from solvers.untrusted.quoting import quote

POSITION, STRESS = (re.compile(r"(min|max|end|time of return) (x|y)"), re.compile(r"(max) \|sigma_(xx|xy|yy)\|"))
NAME = re.compile(r"[\w-]{1,40}")
VALUES = "min y, max y, end y, time of return y (or x), max |sigma_xx| (or xy, yy)"
PEAK = "peak stress"


@dataclass(frozen=True)
class Goal:
    """Number of a run: ``value`` is one of ``VALUES``, ``at`` the material point in m to which it belongs."""

    value: str
    at: Point

    @property
    def is_stress(self) -> bool:
        return self.value.startswith("max |")

    @property
    def unit(self) -> str:
        return "Pa" if self.is_stress else "s" if self.value.startswith("time") else "m"

    @property
    def parts(self) -> tuple[str, str]:
        """What is taken of the quantity over time, such as "min", and the component, such as "y" or "xx"."""
        found = POSITION.fullmatch(self.value) or STRESS.fullmatch(self.value)
        assert found
        return found[1], found[2]

    def validate(self, name: str, patches: Sequence[Patch]) -> None:
        """Raises SceneError if this is no goal of a body of these patches, called ``name`` in sentences."""
        if not NAME.fullmatch(name):
            raise SceneError("goals", name, "is no name of a goal; give up to 40 letters, digits, _ and -")
        where = f"goal {name}"
        if self.value == PEAK:
            raise SceneError(where, self.value, "is not offered: at a clamped corner the stress is infinite, and what "
                             "a run has there is a matter of its particles' spacing; give max |sigma_xx| at a point")
        if not isinstance(self.value, str) or not (POSITION.fullmatch(self.value) or STRESS.fullmatch(self.value)):
            raise SceneError(where, self.value, "is no number that is computed; give one of {values}", VALUES)
        require_point(where, self.at)
        inside = [patch.locate(np.array([self.at], float))[0] for patch in patches]
        if not any((at > -SMALL).all() and (at < 1 + SMALL).all() for at in inside):  # NaN where there is none
            raise SceneError(where, quote(list(self.at)), "is at no material point of the body at rest")
