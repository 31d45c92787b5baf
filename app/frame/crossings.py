"""Which crossings of cell boundaries are shown and counted: those of one window before now.

It is a part of a period, for what a particle does goes with the motion; but what is on the screen for less than
``LEAST_SECONDS`` is not seen. Dots, the sentence about them and the rate over time have this window in common.
"""

import numpy as np

from solvers.scene.scene import Scene

WINDOW = 1 / 20  # of a period
LEAST_SECONDS = 0.4  # on the screen


def crossing_window(scene: Scene, speed: float) -> float:
    """Simulated seconds for which a crossing is shown, where so many go by in one of the visitor's."""
    return max(WINDOW * scene.period, LEAST_SECONDS * speed)


def is_recent(steps_since: np.ndarray, scene: Scene, speed: float) -> np.ndarray:
    """Which particles' last crossings (P,), this many steps ago (P,), -1 for never, are in the window."""
    return (steps_since >= 0) & (steps_since <= crossing_window(scene, speed) / scene.time_step)


def crossing_ages(steps_since: np.ndarray, scene: Scene, speed: float) -> np.ndarray:
    """How much of the window has gone by (n,) since crossings this many steps ago (n,): 0 to 1 for recent ones."""
    return steps_since * np.float32(scene.time_step / crossing_window(scene, speed))
