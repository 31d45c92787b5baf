"""Numerical fracture of a rectangle of particles: neighbours, or a particle and its clamped side, that the grid no
longer connects, so that they part although their deformation gradients do not say so."""

import numpy as np

from solvers.bodies.rectangle import Rectangle


def largest_gap(shape: Rectangle, X: np.ndarray, u: np.ndarray, F: np.ndarray) -> float:
    """Returns the largest distance in m by which two neighbours, or a particle and its clamped side, are not where the
    mean of their deformation gradients puts them relative to each other; of particles at X (n, m, 2) in m at rest,
    along xi and eta, displaced by ``u`` (n, m, 2) in m, with deformation gradients ``F`` (n, m, 2, 2)."""
    largest = 0.0
    for axis, (first, last) in enumerate(shape.clamped):
        ends = [(int(first), int(last)), (0, 0), (0, 0)]  # a row on each clamped side: u = 0, F of the row beside it
        x, displaced, slopes = (np.moveaxis(one, axis, 0) for one in (X, u, F - np.eye(2)))
        displaced, slopes = np.pad(displaced, ends), np.pad(slopes, [*ends, (0, 0)], "edge")
        apart = np.diff(x, axis=0)
        apart = np.concatenate([apart[:first] / 2, apart, apart[len(apart) - last:] / 2])
        gaps = np.diff(displaced, axis=0) - (0.5 * (slopes[1:] + slopes[:-1]) @ apart[..., None])[..., 0]
        largest = max(largest, float(np.linalg.norm(gaps, axis=-1).max()))
    return largest
