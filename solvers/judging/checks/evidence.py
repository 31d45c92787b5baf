"""What the checks have to go by: frames, their errors, and both as arrays over time of the same particles."""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from solvers.judging.frames import Frame
from solvers.judging.measure import Errors, stress
from solvers.scene.scene import Scene

MOST_FOLLOWED, MOST_TIMES = 4000, 400  # particles and times that are followed over time


@dataclass(frozen=True)
class Tracks:
    """P particles at T times in s, which are the same at all of them: what the file has of them, (T, P, D) and (T, P,
    D, D), and what they should be by the best that is known."""

    time: np.ndarray
    material_position: np.ndarray  # (P, D)
    own: dict[str, np.ndarray]  # by quantity, x, v and sigma, and F and stress where the files say them
    exact: dict[str, np.ndarray]  # by quantity: x, v and sigma


@dataclass(frozen=True)
class Evidence:
    """A run in files, with its errors against the best that is known, in the order of the frames; ``again`` gives those
    of a frame of the same times that is somehow changed, ``step`` is that of the run in s, or of the scene."""

    scene: Scene
    frames: Sequence[Frame]
    errors: Sequence[Errors]
    again: Callable[[Frame], Errors]
    step: float

    @functools.cached_property
    def tracks(self) -> Tracks | None:
        """Some of the particles at some of the times; None where they are not the same ones at all of these."""
        every = -(-len(self.frames) // MOST_TIMES)
        frames, errors = self.frames[::every], self.errors[::every]
        orders = [np.lexsort(frame.material_position.T) for frame in frames]
        X = frames[0].material_position[orders[0]]
        if any(not np.array_equal(frame.material_position[order], X)
               for frame, order in zip(frames, orders, strict=True)):
            return None
        picked = [order[::-(-len(X) // MOST_FOLLOWED)] for order in orders]
        own: dict[str, list[np.ndarray | None]] = {
            "x": [f.position for f in frames], "v": [f.velocity for f in frames],
            "sigma": [stress(self.scene, f) for f in frames], "F": [f.deformation_gradient for f in frames],
            "stress": [f.stress for f in frames]}
        said = {q: np.stack([values[at] for values, at in zip(found, picked, strict=True) if values is not None])
                for q, found in own.items()
                if all(values is not None and np.isfinite(values).all() for values in found)}
        off = {q: np.stack([e[q][at] for e, at in zip(errors, picked, strict=True)])
               for q in ("x", "v", "sigma") if q in said}
        return Tracks(np.array([f.time for f in frames]), frames[0].material_position[picked[0]], said,
                      {q: said[q] - error for q, error in off.items()})
