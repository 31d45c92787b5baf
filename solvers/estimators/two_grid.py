"""What the two-grid estimators of all problems share: the second run's choices, smoothing and interpolation between the
lattices of the two runs, and what can be said afterwards.

The same scene runs a second time on a grid with half as many cells, and every quantity q is extrapolated from the two
(Richardson 1911): where the error is C h^2, q* = (r^2 q_h - q_rh)/(r^2 - 1) is free of it, and the error of the run is
q_h - q*, with r the ratio of the cells, 2 or a little more. The runs are compared as smooth fields: at the scale of a
cell their errors have patterns of their own (the stress is a sawtooth, the null space of the particle-node map holds
noise), which nothing relates, so Richardson's argument cannot hold there; and none is needed, for what a run has and
its smooth field has not is error. So

    e = q_h - I q*,   q* = (r^2 S q_h - S q_rh)/(r^2 - 1),

S a fit of cubics over ``WINDOWS`` cells and I cubic interpolation. The time step is not refined with the grid. It makes
no first-order error but one: v belongs to a time dt/2 earlier than x (symplectic Euler is the leapfrog scheme started
at rest of the forces, a(0) = 0), which is known and taken into account for both runs.

Particles lie on lattices that are evenly spaced in the material coordinate (the bar's X; the ring's angle and radius),
so every smoothing or interpolation is a product of 1-D stencils that never change. A stencil is the value at one place
of the polynomial that fits the nearest lattice points best (least squares; Savitzky & Golay 1964): with as many points
as coefficients it interpolates, with more it also smooths.

Cannot see: errors that both grids share (a force put at the wrong place, a wrong material or time step), and errors
longer than a few cells that do not fall like h^2. Where it is known that they do not, it is not run (see each problem's
``LIMITS``), above all where waves of the second run are out of step with the exact ones
(``solvers.estimators.phase_lag``).
"""

import numpy as np
import taichi as ti

from solvers.kernels.kinds import integers, pairs
from solvers.scene.scene import Scene
from solvers.scene.switches import Switches

WINDOWS = (4, 6)  # cells that a fit spans: of x, v and sigma; and of a, whose noise has longer waves
MOST_COURANT = 0.25  # steps of the coarse run, in multiples of the time a wave takes through a cell of the fine grid
MOST_STEPS = 10  # of the run to one of the coarse run
CRUSHED = 1e-3  # det F from which on a particle of the coarse run counts as crushed
LOST = 0.5  # of the amplitude: a run with such an error of x no longer knows where its particles are
CUBIC = 4  # coefficients

#: Types of the members of a set of stencils, for ``solvers.kernels.packing``.
MEMBERS = {"first": integers, "row": integers, "taps": ti.i32, "weights": pairs}


def interval(scene: Scene) -> int:
    """Steps of the run to one of the coarse run: two at least, for equal Courant numbers.

    More where steps are so short that they could be longer without harm; preferably so many that the coarse run has
    just arrived whenever a sample is taken.
    """
    most = max(2, min(MOST_STEPS, int(MOST_COURANT / scene.courant_number)))
    return max((k for k in range(2, most + 1) if scene.sample_interval % k == 0), default=most)


def gain(scene: Scene) -> float:
    """1/(r^2 - 1) with r the ratio of the cells."""
    return 1 / ((scene.cells / (scene.cells // 2)) ** 2 - 1)


def windows(ppc: int) -> tuple[int, int]:
    """Lattice points in the two kinds of fits."""
    return WINDOWS[0] * ppc, WINDOWS[1] * ppc


def bare(on: Switches) -> Switches:
    """The switches of the second run: the method as it is, nothing measured but the acceleration."""
    return on._replace(effects=("acceleration",), estimators=())


def coarse_run_verdict(scene: Scene, determinant: np.ndarray, displacement: np.ndarray, farthest: float,
            largest: np.ndarray) -> str | None:
    """Whether the coarse run went bad: particles turned inside out, crushed or farther off than can be; or lost.

    ``largest`` is the largest mean square of e_x; the coarse run's error is r^2 times e_x if all is well, and there is
    nothing to extrapolate from a run that is lost.
    """
    with np.errstate(invalid="ignore", over="ignore"):
        sound = np.all(determinant > CRUSHED) and np.all(np.abs(displacement) < farthest)  # False for NaN
        share = (1 + 1 / gain(scene)) * float(np.sqrt(largest[0])) / scene.motion_amplitude
    if not sound:
        return "not valid here: the second run, with half the cells, went unstable"
    if not share <= LOST:
        return (f"not valid here: the second run, with half the cells, seems to be {share:.2g} of the amplitude off, "
                "too far to extrapolate; take more cells or end earlier")
    return None


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
