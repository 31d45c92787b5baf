"""Where an estimator of the vortex is known, before anything has run, not to hold.

What only a run can show is the business of the estimator's own ``verdict``. A scene is a ``VortexScene``, whose file
imports this one.
"""

from collections.abc import Callable
from typing import Any

from solvers.estimators.validity import FROZEN_REASON


def transport(scene: Any) -> str | None:
    """Its defects are those of weights that follow the particles."""
    return FROZEN_REASON if scene.frozen else None


RULES: dict[str, Callable[[Any], str | None]] = {"transport": transport}
