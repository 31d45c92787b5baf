"""Checks that positions, velocities and the stress (or F) show a motion of the same size.

A method may shrink the motion or let it grow, but then all of it: x and F follow the same grid velocities, and v makes
them. A size that one of them has alone was changed on the way: damped, scaled, or in another unit.
"""

import numpy as np

from solvers.judging.findings.amplitude_and_pace import SHORTEST, TOO_SHORT
from solvers.judging.findings.finding import HOLDS, OFF, Finding, unknown
from solvers.judging.findings.findings_input import FindingsInput, ParticleTrajectories
from solvers.judging.findings.time_consistency import FEW, FEWEST_TIMES, TOO_LARGE
from solvers.judging.findings.time_series_fitting import jackknife_error, jackknife_least_squares, rms, time_derivative
from solvers.translatable_message import Message, join_messages

NAME, UNIT = "size of the motion by x, by v and by the stress", "of the motion"
LEAST = 0.02  # of the motion, by which sizes may differ
SURE = 3.0  # times the standard error
LEFT = 0.5  # of what is left of the stress, which noise of grid crossings makes it differ by
LOST = 0.4  # of the motion: where sizes may differ by more, nothing is told
SMOOTHED = 3.0  # of (k h)^2: by so much the grid may smooth what moves the particles, and not their own v


def fit_sizes(tracks: ParticleTrajectories, quantity: str) -> tuple[np.ndarray, np.ndarray, float]:
    """Returns by how much a quantity's size differs from the exact one (1 + n,), in the mean and at the end, from all
    times and without some of them; and what is left of it, as a part of its size."""
    own, exact = (fields[quantity] - (tracks.material_position if quantity == "x" else 0.0)
                  for fields in (tracks.own, tracks.exact))
    t = ((tracks.time - tracks.time[0]) / np.ptp(tracks.time)).reshape(-1, *[1] * (exact.ndim - 1))
    rate = time_derivative(tracks.time, exact)  # of what is late, which is not smaller
    parts = [exact, t * exact, rate, t * rate]
    found, _ = jackknife_least_squares(own - exact, parts)
    left = own - exact - sum(part * share for part, share in zip(parts, found[0], strict=True))
    return found[:, 0] + t.mean() * found[:, 1], found[:, 0] + found[:, 1], rms(left) / max(rms(exact), 1e-300)


def check_sizes(evidence: FindingsInput) -> Finding:
    """Checks the sizes of v and the stress against that of x, in the mean and at the end."""
    tracks, scene = evidence.tracks, evidence.scene
    if tracks is None or len(tracks.time) < FEWEST_TIMES or len(tracks.exact) < 2:
        return unknown(NAME, FEW if len(evidence.errors[0]) > 1 else "nothing but positions in the files")
    if not scene.swings or np.ptp(tracks.time) < SHORTEST * scene.period:
        return unknown(NAME, TOO_SHORT)
    sizes = {quantity: fit_sizes(tracks, quantity) for quantity in tracks.exact}
    smoothed = SMOOTHED * (scene.angular_frequency * scene.spacing / scene.wave_speed) ** 2
    found = []
    for quantity in tracks.exact.keys() - {"x"}:
        left = max(sizes["x"][2], sizes["v"][2] + smoothed if quantity == "v" else LEFT * sizes[quantity][2])
        for one, other in zip(sizes[quantity][:2], sizes["x"][:2], strict=True):
            found.append((abs(float(one[0] - other[0])), max(LEAST, SURE * jackknife_error(one - other), left)))
    off, limit = max(found, key=lambda pair: pair[0] / pair[1] if np.isfinite(pair).all() else np.inf)
    if not (limit < LOST and np.isfinite(off)):
        return unknown(NAME, TOO_LARGE)
    if off <= limit:
        return Finding(NAME, HOLDS, off, limit, UNIT)
    said = {quantity: 100 * (1 + float(end[0])) for quantity, (_, end, _) in sizes.items()}
    known = [Message("{percent:.3g} % by {quantity}", said[key], name)
             for key, name in (("x", "x"), ("v", "v"), ("sigma", Message("the stress (or F)"))) if key in said]
    return Finding(NAME, OFF, off, limit, UNIT,
                   Message("at the end the motion has {sizes} of its size: one of them is damped on the way, or in "
                           "another unit", join_messages(", ", known)))
