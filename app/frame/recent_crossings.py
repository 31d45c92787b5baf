"""The time window of cell crossings that are shown and counted.

It is a fraction of a period, as crossings depend on the motion, but at least ``LEAST_SECONDS`` on the screen. Dots,
headline and the rate over time share it."""

import numpy as np

from solvers.scene.scene import Scene

WINDOW = 1 / 20  # of a period
LEAST_SECONDS = 0.4  # on the screen
MOST_CHANGED = 0.4  # share of the particles: rings around more that have changed their cell would hide the rest


def crossing_window(scene: Scene, speed: float) -> float:
    """Returns for how many simulated s a cell crossing is shown at a playing ``speed`` in simulated s per s."""
    return max(WINDOW * scene.period, LEAST_SECONDS * speed)


def is_recent_crossing(steps_since: np.ndarray, scene: Scene, speed: float) -> np.ndarray:
    """Returns which particles' last cell crossings, (P,) steps ago or -1 for never, are recent enough to be shown, (P,)
    of bool, while a run plays at a ``speed`` in simulated s per s (:func:`crossing_window`)."""
    return (steps_since >= 0) & (steps_since <= crossing_window(scene, speed) / scene.time_step)
