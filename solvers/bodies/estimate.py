"""Estimated errors of a body's run: the particles minus a companion at their places; and whether to believe them.

Two companions of orders p and p + 2 run beside it. Where their errors matter their difference shows it: delta is the
sum over time of its rms over that of the estimate. Where a clamped side meets a free one at a right angle, motions go
like r^lambda at the corner, so u_p - u ~ p^(-4 lambda), and Richardson's extrapolation in p takes that error away:

    u* = u_(p+2) + K (u_(p+2) - u_p),  K = 1/[((p+2)/p)^(4 lambda) - 1],
    sin^2(lambda pi/2) = [4 (1 - nu)^2 - lambda^2]/(3 - 4 nu)    (Williams, J. Appl. Mech. 19 (1952) 526-528).

Stresses do not gain by it, and come from u_(p+2). For what was measured see assets/body.md.
"""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from solvers.bodies.body import Body
from solvers.bodies.spectral_mesh import ORDERS
from solvers.translatable_message import Message

QUANTITIES = {"x": "m", "v": "m/s", "sigma": "Pa"}
SURE, UNSURE = 0.3, 0.6  # of delta: below, an estimate is a number; below, it is one with 30 % of doubt; else none
EXTRAPOLATED = 0.3  # of the difference of the companions that u* may be off, over what u_(p+2) may: 0.15 to 0.5
SMOOTH_CORNER, SMOOTH_FACTOR = 0.1, 0.1  # Poisson's ratio from which the corner's law holds; K at 0, measured
FOLD_STRETCH = 0.5  # below, a free neo-Hookean surface may wrinkle (Biot), and meshes have no limit


def corner_exponent(poissons_ratio: float) -> float:
    """Returns lambda for a right angle between a clamped and a free side in plane strain."""
    low, high = 0.5, 1.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        right = (4 * (1 - poissons_ratio)**2 - middle**2) / (3 - 4 * poissons_ratio)
        low, high = (low, middle) if math.sin(0.5 * math.pi * middle)**2 > right else (middle, high)
    return low


def extrapolation_factor(body: Body) -> float:
    """Returns K of a body, 0 where it has no clamped corner, or one of another angle. As Poisson's ratio falls to 0 the
    singularity fades, and K goes linearly from that of the law to that of a smooth motion."""
    if not body.has_known_corners:
        return 0.0
    p, finer = ORDERS
    singular = 1 / ((finer / p)**(4 * corner_exponent(body.poissons_ratio)) - 1)
    return SMOOTH_FACTOR + min(body.poissons_ratio / SMOOTH_CORNER, 1.0) * (singular - SMOOTH_FACTOR)


class Differences(NamedTuple):
    """RMS over the particles (3,) in SI units, of x, v and sigma: of what two companions differ by, of what the run and
    the finer one differ by, and of the estimated errors."""

    apart: np.ndarray
    found: np.ndarray
    errors: np.ndarray


class QuantityEstimate(NamedTuple):
    """Estimated error of x, v or sigma over a run, rms over the particles in SI units: at the last sample that has one,
    the largest and the mean; and ``delta``."""

    final: float
    largest: float
    mean: float
    delta: float

    @property
    def trust(self) -> str:
        """How far to believe it: "number", "30 %", or "none"."""
        return "number" if self.delta < SURE else "30 %" if self.delta < UNSURE else "none"

    def to_dict(self) -> dict[str, Any]:
        """Returns it as a JSON object, with None for numbers that are not to be believed."""
        hidden = self.trust == "none"
        return {"final": None if hidden else self.final, "max": None if hidden else self.largest,
                "mean": None if hidden else self.mean, "delta": self.delta, "trust": self.trust}


class ErrorEstimate:
    """Estimate of a body's run, collected sample by sample. ``until`` is the time in s of the last sample with an
    estimate, ``sentence`` says why there is none after it; ``pressed`` is when and where the companion was first
    pressed to less than half: time in s and place (2,) in m. ``sound_samples`` counts those with an estimate before
    that, and the start."""

    def __init__(self, body: Body):
        self.factor, self.until, self.sentence, self.sound_samples = extrapolation_factor(body), 0.0, "", 1
        self.pressed: tuple[float, np.ndarray] | None = None
        self._samples: list[Differences] = []

    def add(self, time: float, differences: Differences, stretch: float, place: np.ndarray) -> None:
        """Adds a sample at a ``time`` in s: ``differences`` at the particles, and the least principal stretch of the
        finer companion with its place in m."""
        if self.sentence:
            return
        if stretch < FOLD_STRETCH and self.pressed is None:
            self.pressed = time, place
        if not np.isfinite(differences.apart).all() or stretch <= 0:
            self.sentence = Message("from t = {time:.3g} s the companions have failed{fold}; stiffen the body, or stop "
                                    "before", time, self._fold_words())
        elif self.pressed and differences.apart[0] >= UNSURE * differences.found[0]:
            self.sentence = Message("from t = {time:.3g} s the two companions differ by as much as they find{fold}; "
                                    "stiffen the body, or stop before", time, self._fold_words())
        else:
            self.until = time
            self.sound_samples += not self.pressed
            self._samples.append(differences)

    def quantities(self) -> dict[str, QuantityEstimate]:
        """Returns the estimates of x, v and sigma, by name; none without a sample."""
        if not self._samples:
            return {}
        apart, found, errors = np.array(self._samples).transpose(1, 0, 2)
        delta = apart.sum(axis=0) / np.maximum(found.sum(axis=0), 1e-300)
        if self.factor:
            delta[0] = EXTRAPOLATED * apart[:, 0].sum() / max(errors[:, 0].sum(), 1e-300)
        return {name: QuantityEstimate(*map(float, (errors[-1, k], errors[:, k].max(), errors[:, k].mean(), delta[k])))
                for k, name in enumerate(QUANTITIES)}

    def remarks(self, across: int) -> Sequence[str]:
        """Returns sentences on what limits the estimate; ``across`` are the elements over the narrowest patch."""
        said: list[str] = [self.sentence] if self.sentence else []
        if self.pressed and not self.sentence:
            time, (x, y) = self.pressed
            said.append(Message("from t = {time:.3g} s the body is pressed to less than half near ({x:.2g}, {y:.2g}), "
                                "where its surface may fold", time, x, y))
        weak = [name for name, one in self.quantities().items() if one.trust == "none"]
        if weak:
            said.append(Message("of {names} the run is as good as its companion: take finer elements, such as "
                                "elements_across = {across}", ", ".join(weak), 2 * across))
        return said

    def _fold_words(self) -> str:
        if self.pressed is None:
            return ""
        time, (x, y) = self.pressed
        return Message(", and from t = {time:.3g} s on the body is pressed to less than half near ({x:.2g}, {y:.2g}), "
                       "where its surface may fold", time, x, y)
