"""The longest stable step by linear theory, for one configuration of particles and grid and for a whole motion.

One step of the method, linearised about a configuration, with a = -M^-1 K u, K the tangent stiffness and M the lumped
mass of the nodes: F is updated with the nodes' velocity v + dt a, but dt a is mapped to the particles and back by the
weights, which leaves B a of it, with the smoothing B = M^-1 S^T m S (eigenvalues from 0 to 1). A disturbance of
alternating sign neither grows nor decays where dt^2 (2 - B) M^-1 K has the eigenvalue 4:

    dt <= 2/sqrt(largest eigenvalue of (2 - B) M^-1 K).

With B = 1 this is the leapfrog scheme's 2/w; for a mode that the particles do not see (B = 0) it is 0.71 of that.
Measured at small amplitude: 0.93 to 0.97 of the step from which on runs of two or three periods break.

A step that is too long for a short time is harmless: a mode without B grows by 2 (dt/limit)^2 - 1 per step. The longest
step of a motion is that for which this amounts to ``GROWTH`` on the way from one extreme to the other and back.

Sources: Berzins, Comp. Part. Mech. 5 (2018), for the linearisation; Lanczos, J. Res. Natl. Bur. Stand. 45 (1950).
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

MIN_MASS_SHARE = 1e-12  # share of a particle's mass below which a node carries nothing
EIGENVALUE_TOLERANCE = 0.003  # relative change of the eigenvalues at which they are believed
FEWEST_TURNS, MOST_TURNS = 6, 24
GROWTH = math.exp(2.0)

Fields = Sequence[np.ndarray]  # the components of a vector or tensor, each an array of its own


@dataclass(frozen=True)
class ParticleNodeUnknowns:
    """Links of P particles to K nodes each at n moments, in D dimensions: ``where`` (D arrays (n, P, K)) is the index
    of a node's velocity components among its moment's unknowns, ``sign`` (same shapes) the sign, -1 mirrored."""

    where: Fields
    sign: Fields


@dataclass(frozen=True)
class LinearisedConfigurations:
    """P particles and N unknowns, the components of the nodes' velocities, at n moments.

    ``unknowns`` is N. ``mass_links`` transfer mass and velocity to the nodes with the ``weights`` S
    (n, P, K); ``force_links`` the force with the ``gradients``, components of grad S (D arrays (n, P, K')) in 1/m.
    ``mass`` (P,) is the particles' in kg. ``stress`` is the tangent stiffness: it maps the rates L_ij = dv_i/dx_j (D^2
    arrays (n, P), row by row) to the change of the stress times the volume, in the same layout. ``held`` are indices
    (m,) of unknowns that are fixed at zero: nothing moves across a symmetry plane.
    """

    unknowns: int
    mass_links: ParticleNodeUnknowns
    weights: np.ndarray
    force_links: ParticleNodeUnknowns
    gradients: Fields
    mass: np.ndarray
    stress: Callable[[Fields], Fields]
    held: np.ndarray | None = None


def longest_step_per_instant(configurations: LinearisedConfigurations) -> np.ndarray:
    """Returns the longest stable step at each of the configurations' moments (n,), in s."""
    return 2 / np.sqrt(_StepOperators(configurations).largest_eigenvalues())


def longest_step_of_motion(limits: np.ndarray, seconds: float) -> float:
    """Returns the longest stable step, in s, of a motion that takes ``seconds`` from one extreme to the other and the
    same time back; ``limits`` (n,) are its ``longest_step_per_instant`` at moments evenly spaced in time."""
    low, high = float(limits.min()), 2 * float(limits.max())
    while high > (1 + 1e-9) * low:
        dt = math.sqrt(low * high)
        growing = np.log(np.maximum(2 * (dt / limits) ** 2 - 1, 1.0))
        growth = 2 * np.trapezoid(growing, dx=seconds / (len(limits) - 1)) / dt
        low, high = (low, dt) if growth > math.log(GROWTH) else (dt, high)
    return low


class _StepOperators:
    """Operators of the step on fields (n, N), in which each unknown is scaled by the square root of its mass."""

    def __init__(self, of: LinearisedConfigurations):
        self._of, self._n = of, len(of.weights)
        self._mass_links, self._force_links = self._global_numbers(of.mass_links), self._global_numbers(of.force_links)
        carried = [of.mass[:, None] * of.weights] * len(of.mass_links.where)
        mass = self._sum_at_unknowns(self._mass_links, carried, signed=False)
        there = mass > MIN_MASS_SHARE * of.mass.max()
        if of.held is not None:
            there[:, of.held] = False
        self._scale = np.where(there, 1 / np.sqrt(np.where(there, mass, 1.0)), 0.0)

    def _global_numbers(self, links: ParticleNodeUnknowns) -> list[tuple[np.ndarray, np.ndarray]]:
        first = (np.arange(self._n) * self._of.unknowns)[:, None, None]
        return [(where + first, sign) for where, sign in zip(links.where, links.sign, strict=True)]

    def _sum_at_unknowns(self, links: list[tuple[np.ndarray, np.ndarray]], parts: Fields,
                         signed: bool = True) -> np.ndarray:
        total = np.zeros(self._n * self._of.unknowns)
        for (where, sign), part in zip(links, parts, strict=True):
            total += np.bincount(where.ravel(), (sign * part if signed else part).ravel(), len(total))
        return total.reshape(self._n, -1)

    def _gather_at_particles(self, links: list[tuple[np.ndarray, np.ndarray]], field: np.ndarray) -> list[np.ndarray]:
        values = (field * self._scale).ravel()
        return [sign * values.take(where) for where, sign in links]

    def apply_stiffness(self, field: np.ndarray) -> np.ndarray:
        """Returns M^-1/2 K M^-1/2 applied to a field (n, N)."""
        gradients = self._of.gradients
        rates = [np.einsum("npk,npk->np", v, g) for v in self._gather_at_particles(self._force_links, field)
                 for g in gradients]
        stress, D = self._of.stress(rates), len(gradients)
        force = [np.sum([stress[D * i + j][..., None] * gradients[j] for j in range(D)], axis=0) for i in range(D)]
        return self._sum_at_unknowns(self._force_links, force) * self._scale

    def apply_smoothing(self, field: np.ndarray) -> np.ndarray:
        """Returns M^-1/2 S^T m S M^-1/2, which is B, applied to a field (n, N)."""
        S, mass = self._of.weights, self._of.mass
        given = [(mass * np.einsum("npk,npk->np", v, S))[..., None] * S
                 for v in self._gather_at_particles(self._mass_links, field)]
        return self._sum_at_unknowns(self._mass_links, given) * self._scale

    def apply_two_minus_b(self, field: np.ndarray) -> np.ndarray:
        """Returns 2 - B applied to a field (n, N)."""
        return 2 * field - self.apply_smoothing(field)

    def largest_eigenvalues(self) -> np.ndarray:
        """Returns the largest eigenvalue of M^-1 K (2 - B) at each moment (n,), in 1/s^2, by Lanczos's method in the
        inner product of 2 - B, which is positive definite for any K."""
        start = np.random.default_rng(0).normal(size=self._scale.shape) * (self._scale > 0)
        diagonal, beside = list[np.ndarray](), list[np.ndarray]()
        found = np.zeros(self._n)
        before, q, Cq = np.zeros_like(start), start, self.apply_two_minus_b(start)
        size = np.sqrt(np.einsum("ni,ni->n", q, Cq))
        for _ in range(MOST_TURNS):
            over = np.divide(1.0, size, out=np.zeros_like(size), where=size > 0)[:, None]
            q, Cq = q * over, Cq * over
            image = self.apply_stiffness(Cq)
            diagonal.append(np.einsum("ni,ni->n", image, Cq))
            image = image - diagonal[-1][:, None] * q - (beside[-1][:, None] * before if beside else 0.0)
            known, found = found, _largest_tridiagonal_eigenvalues(diagonal, beside)
            if len(diagonal) >= FEWEST_TURNS and np.all(found - known <= EIGENVALUE_TOLERANCE * found):
                break
            before, q, Cq = q, image, self.apply_two_minus_b(image)
            size = np.sqrt(np.einsum("ni,ni->n", q, Cq))
            size[size < 1e-9 * found] = 0.0  # converged
            beside.append(size)
        return found


def _largest_tridiagonal_eigenvalues(diagonal: list[np.ndarray], beside: list[np.ndarray]) -> np.ndarray:
    """Returns the largest eigenvalues of n tridiagonal matrices, by entries (n,) along and ``beside`` the diagonal."""
    k = len(diagonal)
    T = np.zeros((len(diagonal[0]), k, k))
    T[:, np.arange(k), np.arange(k)] = np.stack(diagonal, axis=1)
    if beside:
        T[:, np.arange(k - 1), np.arange(1, k)] = T[:, np.arange(1, k), np.arange(k - 1)] = np.stack(beside, axis=1)
    return np.linalg.eigvalsh(T)[:, -1]
