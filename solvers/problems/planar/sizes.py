"""How large the quantities of a ring's exact motion are themselves, for errors that may be as large."""

from __future__ import annotations

from typing import Any

import numpy as np

CIRCLES, INSTANTS = 32, 32  # of the means over the ring and over a period


def own_sizes(scene: Any, exact: Any) -> dict[str, float]:
    """RMS over the ring and over a period of x (its displacement), v, sigma and a in the exact motion that ``exact``
    knows, as vectors and Frobenius norms."""
    edges = np.linspace(scene.INNER, scene.OUTER, CIRCLES + 1)
    R = 0.5 * (edges[1:] + edges[:-1])
    X = np.stack([R, np.zeros_like(R)], axis=1)
    parts = {"x": (exact.displacement, (1, 1)), "v": (exact.velocity, (1, 1)), "sigma": (exact.stress, (1, 2, 1)),
             "a": (exact.acceleration, (1, 1))}
    times = (np.arange(INSTANTS) + 0.5) / INSTANTS * scene.period
    return {name: float(np.sqrt(np.mean([np.average(field(scene, X, t) ** 2 @ np.array(weights), weights=R)
                                         for t in times]))) for name, (field, weights) in parts.items()}
