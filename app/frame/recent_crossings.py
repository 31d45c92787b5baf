"""The time window of cell crossings that are shown and counted.

It is a fraction of a period, as crossings depend on the motion, but at least ``LEAST_SECONDS`` on the screen. Dots,
headline and the rate over time share it."""

import numpy as np

from solvers.scene.scene import Scene

WINDOW = 1 / 20  # of a period
LEAST_SECONDS = 0.4  # on the screen


def crossing_window(scene: Scene, speed: float) -> float:
    """Returns the simulated seconds for which a crossing is shown, at a ``speed`` in simulated seconds per second."""
    return max(WINDOW * scene.period, LEAST_SECONDS * speed)


def is_recent_crossing(steps_since: np.ndarray, scene: Scene, speed: float) -> np.ndarray:
    """Returns whether particles' last crossings, this many steps ago (P,), -1 for never, are in the window, (P,)."""
    return (steps_since >= 0) & (steps_since <= crossing_window(scene, speed) / scene.time_step)


def crossing_ages(steps_since: np.ndarray, scene: Scene, speed: float) -> np.ndarray:
    """Returns the ages (n,) of crossings this many steps ago (n,), as fractions of the window."""
    return steps_since * np.float32(scene.time_step / crossing_window(scene, speed))
