"""The bar's exact solution (eqs 29-34), and its patch test's, as functions of the material coordinate X and the time t.

u = A sin(2 pi X) sin(wt), w = c pi, solves rho0 u_tt = P_X + rho0 b with P = E(F - 1) and
b = 3 w^2 u per unit mass (the paper's eq 34 prints another A: u already carries it). Without the body force the
same initial velocity gives the free vibration u = (A/2) sin(2 pi X) sin(2wt); ``BarScene.motion_amplitude`` and
``BarScene.angular_frequency`` are those of whichever solution holds. In a patch test X is where a particle begins, and
u = v0 t, F = F0 for ever. Where the displacement is a formula, typed or that of two tones, all follows from that
(``solvers.motion.exact_solution_1d``).
"""

from typing import Any

import numpy as np

from solvers.motion.exact_solution_1d import motion_table
from solvers.scene.displacement_moments import DisplacementMoments

WAVENUMBER = 2 * np.pi
#: The displacement under the two tones 3 w^2 A sin(2 pi X) sin(wt) + 1.5 w^2 A sin(4 pi X) sin(1.7 wt). Since P is
#: linear, each mode swings for itself; the second, whose natural frequency is 4 w, starts at rest.
TWO_TONES = ("A*sin(2*pi*X)*sin(w*t)"
             "+1.5*A/(4**2-1.7**2)*(sin(1.7*w*t)-1.7/4*sin(4*w*t))*sin(4*pi*X)")
TWO_TONE_PERIODS = 10  # of the first tone, after which that motion returns


def displacement(scene: Any, X: np.ndarray, t: float) -> np.ndarray:
    """Returns the exact displacement u (P,) in m at material coordinates X (P,) in m and the time t in s."""
    if scene.is_patch:
        return np.full_like(X, scene.initial_velocity * t)
    if scene.motion_formula:
        return scene.typed_solution.displacement(scene, X, t)
    return scene.motion_amplitude * np.sin(WAVENUMBER * X) * np.sin(scene.angular_frequency * t)


def velocity(scene: Any, X: np.ndarray, t: float) -> np.ndarray:
    """Returns the exact velocity v = u_t (P,) in m/s at material coordinates X (P,) in m and the time t in s."""
    if scene.is_patch:
        return np.full_like(X, scene.initial_velocity)
    if scene.motion_formula:
        return scene.typed_solution.velocity(scene, X, t)
    w = scene.angular_frequency
    return scene.motion_amplitude * w * np.sin(WAVENUMBER * X) * np.cos(w * t)


def acceleration(scene: Any, X: np.ndarray, t: float) -> np.ndarray:
    """Returns the exact acceleration a = u_tt (P,) in m/s^2 at material coordinates X (P,) in m and the time t in s."""
    if scene.is_patch:
        return np.zeros_like(X)
    if scene.motion_formula:
        return scene.typed_solution.acceleration(scene, X, t)
    return -scene.angular_frequency**2 * displacement(scene, X, t)


def deformation_gradient(scene: Any, X: np.ndarray, t: float) -> np.ndarray:
    """Returns the exact F = 1 + u_X (P,), no unit, at material coordinates X (P,) in m and the time t in s."""
    if scene.is_patch:
        return np.full_like(X, scene.stretch)
    if scene.motion_formula:
        return scene.typed_solution.deformation_gradient(scene, X, t)
    return 1 + WAVENUMBER * scene.motion_amplitude * np.cos(WAVENUMBER * X) * np.sin(scene.angular_frequency * t)


def stress(scene: Any, X: np.ndarray, t: float) -> np.ndarray:
    """Returns the exact stress E(F - 1) (P,) in Pa (eq 29) at material coordinates X (P,) in m and the time t in s."""
    return scene.modulus * (deformation_gradient(scene, X, t) - 1)


def field_as_sampled(scene: Any, quantity: str, X: np.ndarray, t: float) -> np.ndarray:
    """Returns an exact field (P,) in SI, the displacement for "x", or "v", "sigma", "a", at material coordinates X (P,)
    in m, as a run has it at time t in s: the acceleration is that of its last step, one step before. For a patch test
    "x" is 0, without the drift v0 t, which would hide all else."""
    if scene.is_patch and quantity == "x":
        return np.zeros_like(X)
    if quantity == "a":
        return acceleration(scene, X, max(0.0, t - scene.time_step))
    return {"x": displacement, "v": velocity, "sigma": stress}[quantity](scene, X, t)


def body_force(scene: Any, X: np.ndarray, t: float) -> np.ndarray:
    """Returns the body force per mass (P,) in m/s^2 at material coordinates X (P,) in m and the time t in s: 3 w^2 u
    (eq 34, corrected), zero for the free bar; that of its solution for a motion by formula."""
    if scene.body_force == "none":
        return np.zeros_like(X)
    if scene.motion_formula:
        return scene.typed_solution.body_force(scene, X, t)
    return 3 * scene.angular_frequency**2 * displacement(scene, X, t)


def displacement_moments(scene: Any, times: np.ndarray) -> DisplacementMoments:
    """Returns the moments, sums over particles of displacement times mode, at the times (T,) in s of the motion by the
    balance of momentum (``solvers.scene.displacement_moments``), for comparison with those of a run.

    P = E(F - 1) is linear, so that the mode sin(2 pi X), which start and body force feed, swings for itself, A sin(wt),
    or A/2 sin(2wt) without force (both start at the velocity A w), and sin(4 pi X) rests.
    All rests in a patch test, seen from where it should be. A force that a method puts at its
    nodes is meant for the material points too. A motion by formula, without its
    mean, is sum_k T_k M_k.
    """
    P, w, A = scene.particles, scene.angular_frequency, scene.motion_amplitude
    X = (np.arange(P) + 0.5) / P
    shapes = np.sin(2 * np.pi * np.outer((1, 2), X))  # (2, P)
    inverse, trusted = np.linalg.pinv(shapes @ shapes.T, hermitian=True), np.ones(len(times), bool)
    if scene.motion_formula:
        motion = motion_table(scene)
        modes, T = motion.modes[:P, :, 0] - motion.modes[P, :, 0], np.stack([motion.time_functions(t) for t in times])
        return DisplacementMoments(T @ (shapes @ modes).T, np.einsum("tk,kl,tl->t", T, modes.T @ modes, T), inverse, P,
                                   trusted)
    size = np.zeros((len(times), 2))
    if not scene.is_patch:
        size[:, 0] = A * np.sin(w * times)
    gram = shapes @ shapes.T
    return DisplacementMoments(size @ gram, np.einsum("tm,mn,tn->t", size, gram, size), inverse, P, trusted)
