"""Smoothing and interpolation between the lattices of two runs, in one direction at a time.

Particles lie on lattices that are evenly spaced in the material coordinate (the bar's X; the ring's angle and radius),
so every smoothing or interpolation is a product of 1-D stencils that never change. A stencil is the value at one place
of the polynomial that fits the nearest lattice points best (least squares; Savitzky & Golay 1964): with as many points
as coefficients it interpolates, with more it also smooths.
"""

import numpy as np
import taichi as ti

from solvers.kernels.kinds import integers, pairs

CUBIC = 4  # coefficients

#: Types of the members of a set of stencils, for ``solvers.kernels.packing``.
MEMBERS = {"first": integers, "row": integers, "taps": ti.i32, "weights": pairs}


def stencils(places: np.ndarray, count: int, windows: tuple[int, int], closed: bool) -> dict:
    """Stencils at ``places``, in spacings from the first of ``count`` lattice points, as the members in ``MEMBERS``.

    ``windows`` are the numbers of points in the fits of two kinds of quantities; weights of the shorter are padded with
    zeros. Stencil t begins at point ``first[t]`` and its weights at ``weights[row[t]]``; equal ones are kept once, so
    a bar of any size needs one row or a few. ``closed``: nothing lies beyond the ends and stencils near them become
    one-sided, with the lower degree that fewer points than four allow; else points beyond exist (images), and ``first``
    may be negative.
    """
    taps = min(max(windows), count) if closed else max(windows)
    first = _begin(places, taps, count, closed)
    offset = places - first
    _, where, rows = np.unique(offset.round(9), return_index=True, return_inverse=True)
    weights = np.zeros((len(where), taps, 2))
    for kind, window in enumerate(windows):
        points = min(window, taps)
        for row, t in enumerate(where):
            begin = int(_begin(places[t:t + 1], points, count, closed)[0] - first[t])
            powers = np.vander(np.arange(points) + begin - offset[t], min(CUBIC, points), increasing=True)
            weights[row, begin:begin + points, kind] = np.linalg.pinv(powers)[0]
    return {"first": first.astype(np.int32), "row": (rows.ravel() * taps).astype(np.int32), "taps": taps,
            "weights": weights.reshape(-1, 2)}


def _begin(places: np.ndarray, points: int, count: int, closed: bool) -> np.ndarray:
    """First of the ``points`` lattice points that lie nearest around each place."""
    first = np.round(places - 0.5 * (points - 1) + 1e-9)
    return np.clip(first, 0, count - points) if closed else first


def centres(targets: int, count: int) -> np.ndarray:
    """The points of a lattice of ``targets`` points, in spacings of one of ``count`` that fills the same length."""
    return (np.arange(targets) + 0.5) * (count / targets) - 0.5
