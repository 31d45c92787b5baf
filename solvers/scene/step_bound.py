"""A bound on the time step that needs no eigenvalues: Gershgorin's circles about the stiffness of the grid.

Symplectic Euler is stable up to dt = 2/w with w^2 the largest eigenvalue of M^-1 K, K_ij = sum_p k_p V_p grad S_i .
grad S_j, k_p the tangent modulus in the present configuration. The rows of the similar matrix M^-1/2 K M^-1/2 bound it:

    dt <= 2/sqrt(max_i sum_p k_p V_p |grad S_ip|/sqrt(m_i) sum_j |grad S_jp|/sqrt(m_j)).

Divided like this a node that a particle's domain only just touches asks for no shorter step: its mass vanishes with the
square of its gradient. Here the bound is evaluated in numpy along the motion that a scene has ahead, before anything
has run; a run's own margin comes from its kernels. Source: Gershgorin (1931); for MPM see
Berzins, "Nonlinear stability and time step selection for the MPM method", Comp. Part. Mech. 5 (2018).
"""

import functools
from dataclasses import replace
from typing import Any

import numpy as np

SAFE = 0.7  # of the bound: what a nonlinear run stands; measured limits are about 0.75 of linear theory
AT_ONCE = 1e-30  # seconds: an end that every scene may have; a default one takes too many steps where material is stiff
INSTANTS = 17  # of the motion ahead, from one extreme to the other
TOUCHED = 1e-12  # share of a particle's mass below which a node carries nothing


def bound(nodes: np.ndarray, gradients: np.ndarray, stiffness: np.ndarray, mass: np.ndarray) -> float:
    """The bound in seconds: ``nodes`` and |grad S| at them (P, K), k V of each particle (P,), the nodes' mass (N,)."""
    carries = mass > TOUCHED * mass.max()
    scaled = np.where(carries[nodes], gradients / np.sqrt(np.where(carries, mass, 1.0))[nodes], 0.0)
    rows = np.bincount(nodes.ravel(), (stiffness[:, None] * scaled.sum(axis=1)[:, None] * scaled).ravel(), len(mass))
    return 2 / float(np.sqrt(rows.max()))


def stencil(method: str, position: np.ndarray, half_width: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """First of three nodes (P,), weights and slopes in 1/cell there (P, 3), as ``solvers.kernels.shapes``, in numpy.

    Positions and half widths (P,) in cells. A weight is the mean of the hat over the domain, its slope the hat's
    difference over the domain.
    """
    if method == "mpm":
        first = np.floor(position)
        s = (position - first)[:, None]
        nothing = np.zeros_like(s)
        return first.astype(int), np.hstack([1 - s, s, nothing]), np.hstack([nothing - 1, nothing + 1, nothing])
    reach = np.full_like(position, 0.5) if method == "bspline" else half_width
    first = np.floor(position - reach)
    offset = (position - first)[:, None] - np.arange(3)
    left, right, length = offset - reach[:, None], offset + reach[:, None], 2 * reach[:, None]
    return first.astype(int), (_hat_integral(right) - _hat_integral(left)) / length, (_hat(right) - _hat(left)) / length


def _hat(s: np.ndarray) -> np.ndarray:
    return np.maximum(0.0, 1 - np.abs(s))


def _hat_integral(s: np.ndarray) -> np.ndarray:
    """The integral of the hat from minus infinity to s."""
    s = np.clip(s, -1.0, 1.0)
    return np.where(s < 0, 0.5 * (1 + s) ** 2, 1 - 0.5 * (1 - s) ** 2)


@functools.lru_cache(maxsize=256)  # asked for at every turn of a live run, by way of the automatic step
def of_scene(scene: Any) -> float:
    """The bound in seconds for the motion that a scene has ahead, whatever its own step, end and watchers are."""
    return _of_motion(replace(scene, dt=None, cfl=None, t_end=AT_ONCE, periods=None, sample_every=None,
                              estimators=(), effects=()))


@functools.lru_cache(maxsize=64)
def _of_motion(scene: Any) -> float:
    return scene.critical_time_step()
