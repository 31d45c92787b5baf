"""What the bar is tested against: published numbers, and the method written out a second time in numpy.

``NUMBERS`` are the paper's Table 1 and the figures of an independent program. The functions below follow the
formulas term by term with dense matrices (particles by nodes) and share no code with the solver.
"""

from __future__ import annotations

import json
from dataclasses import dataclass

import numpy as np

from tests.support.paths import ASSETS

NUMBERS = json.loads((ASSETS / "reference" / "bar.json").read_text())


def weight(method: str, r: np.ndarray, h: float, half: np.ndarray | float) -> tuple[np.ndarray, np.ndarray]:
    """Weight and its gradient at r = x_p - x_i; ``half`` is half the particle's domain, for the GIMP
    methods.
    """
    a, sign = np.abs(r), np.sign(r)
    if method == "mpm":
        return np.maximum(0, 1 - a / h), np.where(a < h, -sign / h, 0)
    if method == "bspline":
        inner, outer = a < h / 2, a < 1.5 * h
        return (np.select([inner, outer], [0.75 - (r / h) ** 2, 0.5 * (1.5 - a / h) ** 2], 0),
                np.select([inner, outer], [-2 * r / h**2, -sign * (1.5 - a / h) / h], 0))
    q = h + half - a  # the three branches of Bardenhagen & Kober
    where = [a < half, a <= h - half, a < h + half]
    return (np.select(where, [1 - (r * r + half**2) / (2 * h * half), 1 - a / h, q * q / (4 * h * half)], 0),
            np.select(where, [-r / (h * half), -sign / h, -sign * q / (2 * h * half)], 0))


@dataclass
class Bar:
    """A bar stepped by dense numpy formulas. ``scene`` gives the numbers; the state is x, v, F."""

    scene: object
    X: np.ndarray
    x: np.ndarray
    v: np.ndarray
    F: np.ndarray

    def __post_init__(self) -> None:
        s = self.scene
        self.h, self.V0 = 1 / s.cells, 1 / s.cells / s.ppc
        self.m, self.w = s.density * self.V0, np.pi * np.sqrt(s.modulus / s.density)
        self.nodes = np.arange(s.cells) * self.h

    def half(self) -> np.ndarray:
        """Half of each particle's domain."""
        half = np.full_like(self.x, self.V0 / 2)
        return np.minimum(half * self.F, self.h / 2) if self.scene.method == "cpgimp" else half

    def matrices(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """S, dS and r = x_p - x_i to the nearest periodic image, each particles by nodes."""
        r = (self.x[:, None] - self.nodes + 0.5) % 1 - 0.5
        return *weight(self.scene.method, r, self.h, self.half()[:, None]), r

    def divergence(self, S: np.ndarray, dS: np.ndarray, r: np.ndarray) -> np.ndarray:
        """D with (sum D sigma) V_i the internal force: -dS F V0/V_i, or eq 17 normalised so that sum D
        x = 1.
        """
        D, volume = -dS * self.F[:, None] * self.V0, S.T @ (self.F * self.V0)
        if not self.scene.linearity_preserving:
            return D / volume
        D = D - S * D.sum(0) / S.sum(0)
        return D / (D * r).sum(0)

    def accelerations(self, t: float) -> np.ndarray:
        """Nodal accelerations: internal and body force."""
        S, dS, r = self.matrices()
        s, mass, volume = self.scene, self.m * S.sum(0), S.T @ (self.F * self.V0)
        internal = (self.divergence(S, dS, r).T @ (s.modulus * (self.F - 1))) * volume / mass
        push = 3 * self.w**2 * s.amplitude * np.sin(self.w * t)
        body = {"material": push * (S.T @ (self.m * np.sin(2 * np.pi * self.X))) / mass,
                "node": push * np.sin(2 * np.pi * self.nodes), "none": 0}[s.body_force]
        return internal + body

    def step(self, n: int) -> None:
        """Step n to n + 1: symplectic Euler, stress last."""
        S, dS, _ = self.matrices()
        dt = self.scene.time_step
        a = self.accelerations(n * dt)
        v_i = S.T @ self.v / S.sum(0) + dt * a
        self.v = self.v + dt * (S @ a)
        moving = {"grid": S @ v_i, "particle": self.v, "corners": self.ends(v_i)}[self.scene.velocity]
        self.x = self.x + dt * moving
        self.F = self.F * (1 + dt * (dS @ v_i))

    def ends(self, v_i: np.ndarray) -> np.ndarray:
        """Mean of the hat-function velocities at the two ends of each domain."""
        points, values = np.append(self.nodes, 1), np.append(v_i, v_i[0])
        return sum(np.interp((self.x + side * self.half()) % 1, points, values) for side in (-1, 1)) / 2
