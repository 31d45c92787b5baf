"""Shared memory block that passes a session's particles to the page.

Its first byte is nonzero until the page has copied the frame: the engine writes no other before. As a message, this
would wake the page's writer thread with every frame.
"""

import os
import sys
from dataclasses import dataclass
from functools import lru_cache
from multiprocessing import resource_tracker
from multiprocessing.shared_memory import SharedMemory

import numpy as np

from solvers.scene.scene import Scene
from solvers.solver.particle_snapshot import Snapshot
from solvers.solver.samples import QUANTITIES

WIDTH = len(QUANTITIES)
HEADER = 64  # bytes in front of the arrays
DIFFERENCE = "{} minus truth"  # what an estimator's is called in the block


@dataclass(frozen=True)
class FrameOptions:
    """Optional contents of a frame, beside the particles with their errors and estimates.

    ``differences`` is whether it has the sizes of estimate minus truth, ``plotted`` the key (x, v, sigma or a) of the
    quantity that is plotted, of which the bar's frames have the field, None for none; ``broken_down`` is the number of
    the particle around which single steps are taken apart
    (:class:`~solvers.solver.particle_step_breakdown.ParticleStepBreakdown`), None for none."""

    differences: bool = False
    plotted: str | None = None
    broken_down: int | None = None


@dataclass(frozen=True)
class FrameArrays:
    """Data of a frame's P particles in D dimensions, in single precision, for drawing.

    ``position`` and ``displacement`` (P, D) in m, ``deformation_gradient`` (P, D * D), ``steps_since_crossing`` (P,) of
    a cell boundary, -1 for never. By the columns x (m), v (m/s), sigma (Pa), a (m/s²): the true ``error`` and, by
    estimator, each ``estimate`` (P, 4), NaN where unknown; and, only if requested, each ``difference`` (P, 4), the size
    of estimate minus truth. ``plotted`` (P, 2) is the bar's field of one quantity, in its unit, and its deviation from
    the exact one (``Snapshot.plotted``), (P, 0) in the plane or if none was requested."""

    position: np.ndarray
    displacement: np.ndarray
    deformation_gradient: np.ndarray
    steps_since_crossing: np.ndarray
    error: np.ndarray
    estimate: dict[str, np.ndarray]
    difference: dict[str, np.ndarray]
    plotted: np.ndarray


def block_bytes(scene: Scene) -> int:
    """Returns the size in bytes of a block for any frame of a scene; a layout may have a few particles more than it."""
    return HEADER + 4 * (scene.particles + scene.particles // 8 + 64) * sum(_field_widths(scene, True, True).values())


def attach_block(name: str) -> SharedMemory:
    """Returns the shared memory block of this name, which another process has created and will remove. Raises
    FileNotFoundError if it has been removed.

    Python before 3.13 lets a process's resource tracker remove what the process only opened. Usually all processes
    share the server's tracker; but an engine whose tracker was killed starts its own, which would remove the blocks of
    all visitors when the engine dies.
    """
    if sys.version_info >= (3, 13):
        return SharedMemory(name, track=False)
    register = resource_tracker.register
    resource_tracker.register = lambda *_: None
    try:
        return SharedMemory(name)
    finally:
        resource_tracker.register = register


def remove_block(block: SharedMemory) -> None:
    """Removes a shared memory block that this process has created.

    A resource tracker that was killed is replaced by one that knows none of the blocks before, and prints a traceback
    for each that it shall forget: so it is told of the block first."""
    if os.name == "posix":
        resource_tracker.register(f"/{block.name}", "shared_memory")
    block.unlink()


def write_frame(block: SharedMemory, scene: Scene, shot: Snapshot) -> None:
    """Writes a snapshot of a scene's particles into the shared memory block, which is then :func:`is_unread`."""
    P, crossing = len(shot.position), shot.last_crossing
    columns = {"position": shot.position, "displacement": shot.position - shot.material_position,
               "deformation_gradient": shot.deformation_gradient,
               "steps_since_crossing": -1 if crossing is None else np.where(crossing < 0, -1, shot.step - crossing),
               "error": np.nan if shot.error is None else shot.error, **shot.estimate,
               **{DIFFERENCE.format(name): sizes for name, sizes in shot.difference.items()}, "plotted": shot.plotted}
    with np.errstate(over="ignore"):  # an unstable run may exceed single precision
        widths = _field_widths(scene, bool(shot.difference), shot.plotted is not None)
        for name, part in _field_views(_block_memoryview(block), P, widths, HEADER).items():
            values = columns[name]
            part[:] = values.reshape(P, -1) if isinstance(values, np.ndarray) else values
    _block_memoryview(block)[0] = 1


def is_unread(block: SharedMemory) -> bool:
    """Returns whether the shared memory block contains a frame that the page has not copied yet."""
    return _block_memoryview(block)[0] != 0


def mark_as_read(block: SharedMemory) -> None:
    """Marks the shared memory block as free for the next frame."""
    _block_memoryview(block)[0] = 0


def read_frame(block: SharedMemory, scene: Scene, particles: int, holds: FrameOptions = FrameOptions()) -> FrameArrays:
    """Returns a copy of the frame in a shared memory block, which has so many particles of a scene and the optional
    contents ``holds``, and marks the block as read."""
    widths = _field_widths(scene, holds.differences, holds.plotted is not None)
    held = bytes(_block_memoryview(block)[HEADER:HEADER + 4 * particles * sum(widths.values())])
    mark_as_read(block)
    parts = _field_views(held, particles, widths)
    return FrameArrays(parts["position"], parts["displacement"], parts["deformation_gradient"],
                       parts["steps_since_crossing"][:, 0], parts["error"],
                       {name: parts[name] for name in scene.active_estimators},
                       {name: parts[DIFFERENCE.format(name)] for name in scene.active_estimators if holds.differences},
                       parts.get("plotted", np.zeros((particles, 0), np.float32)))


@lru_cache(64)
def _field_widths(scene: Scene, differences: bool, plotted: bool) -> dict[str, int]:
    """Returns the fields of a scene's frame, in their order in the block, with their numbers per particle."""
    D, active = scene.DIMENSIONS, scene.active_estimators
    compared = map(DIFFERENCE.format, active) if differences else ()
    return {"position": D, "displacement": D, "deformation_gradient": D * D, "steps_since_crossing": 1, "error": WIDTH,
            **dict.fromkeys((*active, *compared), WIDTH), **({"plotted": 2} if plotted and D == 1 else {})}


def _field_views(held: bytes | memoryview, particles: int, widths: dict[str, int],
                 start: int = 0) -> dict[str, np.ndarray]:
    """Returns views of ``held``, from the byte ``start`` on, as one float32 array (particles, width) for each field."""
    parts = {}
    for name, width in widths.items():
        parts[name] = np.ndarray((particles, width), np.float32, held, start)
        start += 4 * particles * width
    return parts


def _block_memoryview(block: SharedMemory) -> memoryview:
    assert block.buf is not None
    return block.buf
