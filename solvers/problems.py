"""The problems there are, by name, for those who have a name: page, command line, studies."""

from __future__ import annotations

from solvers.bar.scene import BarScene
from solvers.ring.scene import RingScene
from solvers.scene import Scene

SCENES: dict[str, type[Scene]] = {"bar": BarScene, "ring": RingScene}
