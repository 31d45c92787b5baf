"""Checks that positions, velocities and the stress (or F) show a motion of the same size.

A method may shrink the motion or let it grow, but then all of it: x and F follow the same grid velocities, and v makes
them. A size that one of them has alone was changed on the way: damped, scaled, or in another unit.
"""

from typing import NamedTuple

import numpy as np

from solvers.judging.findings.amplitude_and_pace import TOO_SHORT
from solvers.judging.findings.finding import HOLDS, OFF, Finding, unknown
from solvers.judging.findings.findings_input import FindingsInput, ParticleTrajectories
from solvers.judging.findings.time_consistency import FEW, FEWEST_TIMES, TOO_LARGE
from solvers.judging.findings.time_series_fitting import jackknife_error, jackknife_least_squares, rms, time_derivative
from solvers.translatable_message import Message, join_messages

NAME, UNIT = "size of the motion by x, by v and by the stress", "of the motion"
#: Of a period: in less the body's free vibration, which a coarse grid excites, looks like another size of the motion,
#: and like one by x and another by v, as its frequency is another.
WHOLE = 0.9
LEAST = 0.02  # of the motion, by which sizes may differ
SURE = 3.0  # times the standard error
LEFT = 0.5  # of what is left of the stress, which noise of grid crossings makes it differ by
LOST = 0.4  # of the motion: where sizes may differ by more, nothing is told
#: Of (k h)^2: by so much the grid may smooth what moves the particles, and not their own v; or what makes F, and not x,
#: where particles move with their own v.
SMOOTHED = {"v": 6.0, "sigma": 1.5}


class SizeFit(NamedTuple):
    """Fit of a quantity's size: by how much it differs from the exact one, in the ``mean`` and at the ``end`` (1 + n,),
    from all times and without some of them; what is ``left`` of the quantity, and its size in the ``last_third``, over
    the exact size."""

    mean: np.ndarray
    end: np.ndarray
    left: float
    last_third: float


def fit_size(tracks: ParticleTrajectories, quantity: str) -> SizeFit:
    """Returns the fit of a quantity ("x") by a size that grows or shrinks, and what is late of it."""
    own, exact = (fields[quantity] - (tracks.material_position if quantity == "x" else 0.0)
                  for fields in (tracks.own, tracks.exact))
    t = ((tracks.time - tracks.time[0]) / np.ptp(tracks.time)).reshape(-1, *[1] * (exact.ndim - 1))
    rate = time_derivative(tracks.time, exact)  # of what is late, which is not smaller
    parts = [exact, t * exact, rate, t * rate]
    found, _ = jackknife_least_squares(own - exact, parts)
    left = own - exact - sum(part * share for part, share in zip(parts, found[0], strict=True))
    last = slice(2 * len(t) // 3, None)
    return SizeFit(found[:, 0] + t.mean() * found[:, 1], found[:, 0] + found[:, 1], rms(left) / max(rms(exact), 1e-300),
                   float(np.sum(own[last] * exact[last]) / max(float(np.sum(exact[last] ** 2)), 1e-300)))


def check_sizes(evidence: FindingsInput) -> Finding:
    """Checks the sizes of v and the stress against that of x, in the mean and at the end."""
    tracks, scene = evidence.tracks, evidence.scene
    if tracks is None or len(tracks.time) < FEWEST_TIMES or len(tracks.exact) < 2:
        return unknown(NAME, FEW if len(evidence.errors[0]) > 1 else "nothing but positions in the files")
    if not scene.swings or np.ptp(tracks.time) < WHOLE * scene.period:
        return unknown(NAME, TOO_SHORT)
    sizes = {quantity: fit_size(tracks, quantity) for quantity in tracks.exact}
    wave = (scene.angular_frequency * scene.spacing / scene.wave_speed) ** 2
    found = []
    for quantity in (q for q in tracks.exact if q != "x"):
        by, by_x = sizes[quantity], sizes["x"]
        left = max(by_x.left, by.left * (1.0 if quantity == "v" else LEFT)) + SMOOTHED[quantity] * wave
        for one, other in ((by.mean, by_x.mean), (by.end, by_x.end)):
            found.append((abs(float(one[0] - other[0])), max(LEAST, SURE * jackknife_error(one - other), left)))
    off, limit = max(found, key=lambda pair: pair[0] / pair[1] if np.isfinite(pair).all() else np.inf)
    if not (limit < LOST and np.isfinite(off)):
        return unknown(NAME, TOO_LARGE)
    if off <= limit:
        return Finding(NAME, HOLDS, off, limit, UNIT)
    known = [Message("{percent:.3g} % by {quantity}", 100 * sizes[key].last_third, name)
             for key, name in (("x", "x"), ("v", "v"), ("sigma", Message("the stress (or F)"))) if key in sizes]
    return Finding(NAME, OFF, off, limit, UNIT,
                   Message("in the last third of the times the motion has {sizes} of its size: one of them is damped "
                           "on the way, or in another unit", join_messages(", ", known)))
