"""The shared memory block through which a session's particles reach the page."""

from __future__ import annotations

from dataclasses import dataclass
from multiprocessing.shared_memory import SharedMemory

import numpy as np

from solvers.result import Snapshot
from solvers.samples import QUANTITIES
from solvers.scene import Scene

#: Columns before the errors: position, displacement, steps since the last cell change (-1: never).
LEADING = 3
WIDTH = len(QUANTITIES)


@dataclass(frozen=True)
class FrameArrays:
    """A frame's particles in single precision, for drawing. Columns of errors are x, v, sigma, a."""

    position: np.ndarray
    displacement: np.ndarray
    steps_since_crossing: np.ndarray
    error: np.ndarray
    estimate: dict[str, np.ndarray]


def block_bytes(scene: Scene) -> int:
    """Bytes that a scene's frame needs."""
    return 4 * scene.particles * _columns(scene)


def write(block: SharedMemory, scene: Scene, shot: Snapshot) -> None:
    """Put a snapshot into the block."""
    table = _table(block, scene)
    crossing = shot.last_crossing
    with np.errstate(over="ignore"):  # a run that has gone bad may exceed single precision
        table[:, 0] = shot.position
        table[:, 1] = shot.position - shot.material_position
        table[:, 2] = -1 if crossing is None else np.where(crossing < 0, -1, shot.step - crossing)
        table[:, LEADING:LEADING + WIDTH] = np.nan if shot.error is None else shot.error
        for k, estimator in enumerate(scene.active_estimators, 1):
            start = LEADING + k * WIDTH
            table[:, start:start + WIDTH] = shot.estimate[estimator]


def read(block: SharedMemory, scene: Scene) -> FrameArrays:
    """Copy the frame of ``scene`` out of the block."""
    table = _table(block, scene).copy()
    estimates = {}
    for k, estimator in enumerate(scene.active_estimators, 1):
        start = LEADING + k * WIDTH
        estimates[estimator] = table[:, start:start + WIDTH]
    return FrameArrays(table[:, 0], table[:, 1], table[:, 2], table[:, LEADING:LEADING + WIDTH], estimates)


def _columns(scene: Scene) -> int:
    return LEADING + WIDTH * (1 + len(scene.active_estimators))


def _table(block: SharedMemory, scene: Scene) -> np.ndarray:
    return np.ndarray((scene.particles, _columns(scene)), np.float32, buffer=block.buf)
