"""Particles that have overtaken or turned inside out: what no motion of a body does."""

from __future__ import annotations

import numpy as np

from solvers.checking.finding import BROKEN, HOLDS, SUSPICIOUS, Finding, unknown
from solvers.checking.motion import TINY, Motion

INSIDE_OUT, OVERTAKEN = "det F is positive", "neighbours keep their order"
FLATTEST = 1e-3  # det F, below which a particle counts as crushed, as in our own runs
MANY = 0.02  # of all pairs: more of them are no accident of a rim
FEW = 0.005  # of all pairs in the plane or in space, where a rim may have so many; along a line none can
DEEP = 0.7  # of their distance in the reference: where a body is crushed, a few in good runs of ours are less far past


def inside_out(motion: Motion) -> Finding:
    F = motion.fields.get("F")
    if F is None:
        return unknown(INSIDE_OUT, "no F in the files (or not always a number)")
    with np.errstate(all="ignore"):
        J = np.linalg.det(F)
    flat = J < FLATTEST
    if not flat.any():
        return Finding(INSIDE_OUT, HOLDS, float(J.min()), FLATTEST, "")
    moment = int(np.argmax(flat.any(axis=1)))
    p, count = int(np.argmin(J[moment])), int(flat[moment].sum())
    word = "turned inside out" if J[moment, p] <= 0 else "crushed to nothing"
    return Finding(INSIDE_OUT, BROKEN if J[moment, p] <= 0 else SUSPICIOUS, float(J[moment, p]), FLATTEST, "",
                   f"{count:,} particle{'s are' if count != 1 else ' is'} {word} at t = {motion.times[moment]:.4g} s: "
                   f"det F is {J[moment, p]:.3g}", **motion.at(moment, p))


def overtaken(motion: Motion) -> Finding:
    """Of each pair of neighbours what parts them must not point against what it is by the motion around them: along a
    line by its order in the reference, else by a plane through the neighbours, and by F."""
    edges, near = motion.edges, motion.near
    if edges is None or near is None:
        return unknown(OVERTAKEN, "too few particles have neighbours")
    F, found = motion.gradient, []
    for moment in motion.moments:
        x = motion.x[moment]
        now, told = x[edges.other] - x[edges.one], [edges.apart]
        if motion.dimensions > 1:  # by the plane, and by F where there is one: at a rim either may be wrong
            slopes = [plane(motion, x), *([] if F is None else [F[moment]])]
            told = [np.einsum("nij,nj->ni", 0.5 * (one[edges.one] + one[edges.other]), edges.apart) for one in slopes]
        ahead = np.max([np.sum(now * one, axis=1) / np.maximum(np.linalg.norm(one, axis=1), TINY) for one in told],
                       axis=0)
        turned = ahead <= 0
        deep = ahead <= -DEEP * edges.length
        few = FEW if motion.dimensions > 1 else 0.0
        found.append(turned if turned.mean() > MANY else deep if deep.mean() > few else np.zeros_like(deep))
    shares = [float(turned.mean()) for turned in found]
    if max(shares) == 0:
        return Finding(OVERTAKEN, HOLDS, 0.0, 0.0, "of all pairs",
                       f"of up to {100 * MANY:.0f} % of them a shallow change would not count")
    k = int(np.argmax(shares))
    first = next(k for k, share in enumerate(shares) if share > 0)
    moment, p = motion.moments[k], int(edges.one[np.argmax(found[k])])
    return Finding(OVERTAKEN, BROKEN if shares[k] > MANY else SUSPICIOUS, shares[k], 0.0, "of all pairs",
                   f"{int(found[k].sum()):,} of {len(found[k]):,} pairs of neighbours have changed their order at t = "
                   f"{motion.times[moment]:.4g} s (first at {motion.times[motion.moments[first]]:.4g} s)",
                   **motion.at(moment, p))


def plane(motion: Motion, values: np.ndarray) -> np.ndarray:
    """The slopes (P, C, D) over the reference of planes through the values (P, C) of the neighbours of each."""
    near = motion.near
    assert near is not None
    away = motion.reference[near.who] - motion.reference[:, None, :]
    weight = near.there[:, :, None]
    left = np.where(weight, away, 0.0)
    right = np.where(weight, values[near.who] - values[:, None, :], 0.0)
    square = np.einsum("pki,pkj->pij", left, left)
    return np.einsum("pij,pkj,pkc->pci", np.linalg.pinv(square, hermitian=True), left, right)
