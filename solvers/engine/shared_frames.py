"""The shared memory block through which a session's particles reach the page.

Its first byte says whether the page has yet to copy the frame in it: the engine writes no other before. Said in a
message, it would wake the page's writing thread with every frame.
"""

import sys
from dataclasses import dataclass
from functools import lru_cache
from multiprocessing import resource_tracker
from multiprocessing.shared_memory import SharedMemory

import numpy as np

from solvers.scene.scene import Scene
from solvers.solver.samples import QUANTITIES
from solvers.solver.snapshot import Snapshot

WIDTH = len(QUANTITIES)
HEADER = 64  # bytes in front of the arrays
DIFFERENCE = "{} minus truth"  # what an estimator's is called in the block


@dataclass(frozen=True)
class FrameOptions:
    """What a frame holds beside the particles with their errors and estimates.

    ``differences`` are the sizes of estimate minus truth, ``plotted`` is the key of the quantity whose field it holds,
    if any; ``broken_down`` is the number of a particle, if any, around which single steps are taken apart.
    """

    differences: bool = False
    plotted: str | None = None
    broken_down: int | None = None


@dataclass(frozen=True)
class FrameArrays:
    """A frame's particles in single precision, for drawing. D dimensions; columns of errors are x, v, sigma, a.

    ``position`` and ``displacement`` (P, D), ``deformation_gradient`` (P, D * D), ``steps_since_crossing`` (P,) with -1
    for never, ``error`` and each ``estimate`` (P, 4), NaN where nothing is known; ``difference`` (P, 4) of each, the
    size of estimate minus truth, only where it was asked for. ``plotted`` (P, 2) is the field of one quantity and its
    deviation from the exact one (``Snapshot.plotted``), (P, 0) where none was asked for.
    """

    position: np.ndarray
    displacement: np.ndarray
    deformation_gradient: np.ndarray
    steps_since_crossing: np.ndarray
    error: np.ndarray
    estimate: dict[str, np.ndarray]
    difference: dict[str, np.ndarray]
    plotted: np.ndarray


def block_bytes(scene: Scene) -> int:
    """Bytes that a scene's frame needs at most: a layout may hold a few particles more than the scene's count."""
    return HEADER + 4 * (scene.particles + scene.particles // 8 + 64) * sum(_widths(scene, True, True).values())


def attach_block(name: str) -> SharedMemory:
    """A block that another process has made and will remove. Raises FileNotFoundError when that has happened.

    Python before 3.13 has the tracker of a process remove, in the end, what the process only opened. All processes
    share the server's, as a rule; but an engine whose tracker was killed starts its own, which would take the blocks of
    all visitors along when the engine dies.
    """
    if sys.version_info >= (3, 13):
        return SharedMemory(name, track=False)
    register = resource_tracker.register
    resource_tracker.register = lambda *_: None
    try:
        return SharedMemory(name)
    finally:
        resource_tracker.register = register


def write_frame(block: SharedMemory, scene: Scene, shot: Snapshot) -> None:
    """Put a snapshot into the block, which is then :func:`is_unread`."""
    P, crossing = len(shot.position), shot.last_crossing
    columns = {"position": shot.position, "displacement": shot.position - shot.material_position,
               "deformation_gradient": shot.deformation_gradient,
               "steps_since_crossing": -1 if crossing is None else np.where(crossing < 0, -1, shot.step - crossing),
               "error": np.nan if shot.error is None else shot.error, **shot.estimate,
               **{DIFFERENCE.format(name): sizes for name, sizes in shot.difference.items()}, "plotted": shot.plotted}
    with np.errstate(over="ignore"):  # a run that has gone bad may exceed single precision
        widths = _widths(scene, bool(shot.difference), shot.plotted is not None)
        for name, part in _views(_open_block(block), P, widths, HEADER).items():
            values = columns[name]
            part[:] = values.reshape(P, -1) if isinstance(values, np.ndarray) else values
    _open_block(block)[0] = 1


def is_unread(block: SharedMemory) -> bool:
    """Whether a frame lies in the block that the page has not copied yet."""
    return _open_block(block)[0] != 0


def mark_as_read(block: SharedMemory) -> None:
    """The block may be written."""
    _open_block(block)[0] = 0


def read_frame(block: SharedMemory, scene: Scene, particles: int, holds: FrameOptions = FrameOptions()) -> FrameArrays:
    """Copy the frame of ``scene`` with so many particles and what else it ``holds`` out of the block, which may then be
    written again."""
    widths = _widths(scene, holds.differences, holds.plotted is not None)
    held = bytes(_open_block(block)[HEADER:HEADER + 4 * particles * sum(widths.values())])
    mark_as_read(block)
    parts = _views(held, particles, widths)
    return FrameArrays(parts["position"], parts["displacement"], parts["deformation_gradient"],
                       parts["steps_since_crossing"][:, 0], parts["error"],
                       {name: parts[name] for name in scene.active_estimators},
                       {name: parts[DIFFERENCE.format(name)] for name in scene.active_estimators if holds.differences},
                       parts.get("plotted", np.zeros((particles, 0), np.float32)))


@lru_cache(64)
def _widths(scene: Scene, differences: bool, plotted: bool) -> dict[str, int]:
    """What a frame holds, in order, and how many numbers of each a particle has."""
    D, active = scene.DIMENSIONS, scene.active_estimators
    compared = map(DIFFERENCE.format, active) if differences else ()
    return {"position": D, "displacement": D, "deformation_gradient": D * D, "steps_since_crossing": 1, "error": WIDTH,
            **dict.fromkeys((*active, *compared), WIDTH), **({"plotted": 2} if plotted else {})}


def _views(held: bytes | memoryview, particles: int, widths: dict[str, int], start: int = 0) -> dict[str, np.ndarray]:
    """Bytes from ``start`` on as one array (P, width) for each thing they hold."""
    parts = {}
    for name, width in widths.items():
        parts[name] = np.ndarray((particles, width), np.float32, held, start)
        start += 4 * particles * width
    return parts


def _open_block(block: SharedMemory) -> memoryview:
    assert block.buf is not None
    return block.buf
