"""The motion of particles: the same ones at all moments, with all that the files have of them."""

from __future__ import annotations

import functools
from dataclasses import dataclass, field, replace

import numpy as np

from solvers.judging.checks.neighbours import MOST, Surroundings, surroundings

MOST_MOMENTS = 32  # that are looked at one by one, spread over all
BOXES = 10  # of which a large body is looked at
TINY = 1e-300


@dataclass(frozen=True)
class Edges:
    """Pairs (n,) of neighbours in the reference: ``one`` and ``other``, and what parts them there (n, D)."""

    one: np.ndarray
    other: np.ndarray
    apart: np.ndarray
    length: np.ndarray


@dataclass(frozen=True)
class Motion:
    """P particles at T times in s that grow.

    ``reference`` (P, D) is where they were before all deformation, or at the first moment where the files do not say
    that (``from_start``). ``fields`` has x and v (T, P, D), F and sigma (T, P, D, D), mass and volume (T, P), as far as
    the files have them at all moments and they are numbers. ``step`` is that of the run in s where a file says it.
    """

    times: np.ndarray
    number: np.ndarray
    reference: np.ndarray
    from_start: bool
    fields: dict[str, np.ndarray]
    step: float | None = None
    notes: list[str] = field(default_factory=list)

    @property
    def x(self) -> np.ndarray:
        return self.fields["x"]

    @property
    def dimensions(self) -> int:
        return self.reference.shape[1]

    @functools.cached_property
    def gradient(self) -> np.ndarray | None:
        """F (T, P, D, D) from the reference on: where that is the first moment, F by what it was then."""
        F = self.fields.get("F")
        if F is None or not self.from_start:
            return F
        start = F[0]
        if not (np.abs(np.linalg.det(start)) > TINY).all():
            return None
        return F @ np.linalg.inv(start)

    @functools.cached_property
    def moments(self) -> list[int]:
        """Those that are looked at one by one, the first and the last of them."""
        T = len(self.times)
        return sorted(set(np.linspace(0, T - 1, min(T, MOST_MOMENTS)).round().astype(int).tolist()))

    @functools.cached_property
    def near(self) -> Surroundings | None:
        """Who is near whom in the reference; None of too few particles."""
        return surroundings(self.reference)

    @functools.cached_property
    def edges(self) -> Edges | None:
        """Each particle with its nearest, two a direction."""
        if self.near is None:
            return None
        count = 2 * self.dimensions
        there = self.near.there[:, :count]
        one = np.repeat(np.arange(len(self.reference)), there.sum(axis=1))
        other = self.near.who[:, :count][there]
        apart = self.reference[other] - self.reference[one]
        length = np.linalg.norm(apart, axis=1)
        real = length > 0
        return Edges(one[real], other[real], apart[real], length[real]) if real.any() else None

    @functools.cached_property
    def spacing(self) -> float:
        """Of most particles from their nearest in the reference."""
        return float(np.median(self.edges.length)) if self.edges else np.nan

    @functools.cached_property
    def amplitude(self) -> float:
        """How far particles move against each other: the largest RMS over them of the displacement without its mean."""
        moved = self.x - self.reference
        return float(np.sqrt(np.max(np.mean(np.sum((moved - moved.mean(axis=1, keepdims=True))**2, axis=2), axis=1))))

    @functools.cached_property
    def speed(self) -> float:
        """The largest RMS of the velocity."""
        return float(np.sqrt(np.max(np.mean(np.sum(self.fields["v"]**2, axis=2), axis=1))))

    @functools.cached_property
    def part(self) -> Motion:
        """Of more particles than neighbours are looked for among, those in some boxes spread over the body."""
        P, D = self.reference.shape
        if P <= MOST:
            return self
        low, reach = self.reference.min(axis=0), np.ptp(self.reference, axis=0)
        sides = int(np.ceil((P * BOXES / MOST) ** (1 / D)))
        place = np.minimum((sides * (self.reference - low) / np.maximum(reach, TINY)).astype(int), sides - 1)
        boxes, box, counts = np.unique(place, axis=0, return_inverse=True, return_counts=True)
        order = np.argsort(np.arange(len(boxes)) * 0.5 * (5**0.5 - 1) % 1)  # far from each other, one after the other
        chosen = order[:max(1, int(np.sum(np.cumsum(counts[order]) <= MOST)))]
        which = np.isin(box.ravel(), chosen)
        return replace(self, number=self.number[which], reference=self.reference[which],
                       fields={key: values[:, which] for key, values in self.fields.items()})

    def at(self, moment: int, p: int) -> dict:
        """Where and when something was found, for a ``Finding``."""
        return {"time": float(self.times[moment]), "particle": int(self.number[p]),
                "place": tuple(map(float, self.reference[p]))}
