"""The longest stable time step of the motion of a scene, computed before the run, and the share of it that is used.

Along the exact motion, from one extreme to the other, the step is linearised at ``motion_fractions`` evenly spaced in
time (``solvers.scene.linear_stability``). A run's own motion is not quite the exact one; how much lower its bound is
was measured: with hat functions and boxes of constant width because particles leave the places where the weights add
up (``SHARE``); and where material is stretched to more than twice its length because the stretches of a run exceed the
exact ones, the more so the worse a method's domains follow (``EXCESS``).

With hat functions forces jump where particles cross cells, and in the plane a node beyond a rim that a particle has
just reached is nearly empty. At that moment hardly any step is stable, and its effect on the run is chance, with
short steps as with long ones: such a bound is not ``certain``.

A run's own margin comes from its kernels, which need something cheaper than eigenvalues: Gershgorin's circles about
the stiffness of the grid (:func:`gershgorin_step_bound`), K_ij = sum_p k_p V_p grad S_i . grad S_j, k_p the tangent
modulus in the present configuration. The rows of the similar matrix M^-1/2 K M^-1/2 bound its eigenvalues:

    dt <= 2/sqrt(max_i sum_p k_p V_p |grad S_ip|/sqrt(m_i) sum_j |grad S_jp|/sqrt(m_j)).

Divided like this a node that a particle's domain only just touches asks for no shorter step: its mass vanishes with the
square of its gradient. Margins are counted in units in which that of the hardest moment ahead is the step over what
linear theory gives for the motion. Source: Gershgorin (1931).
"""

import functools
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from solvers.scene.linear_stability import MIN_MASS_SHARE, longest_step_of_motion
from solvers.scene.stabilisations import PIECES
from solvers.translatable_message import Message

SAFE = 0.9  # share of the bound that ``--dt auto`` takes
AT_ONCE = 1e-30  # seconds: an end that every scene may have; a default one takes too many steps where material is stiff
SHARE = {"mpm": 0.88, "ugimp": 0.88}  # of the bound along the exact motion, with weights that move with the particles
#: Reduction of the bound per unit of stretch beyond 2: boxes that follow the stretch alone tear in shear.
EXCESS = {"cpdi": 0.06, "mpm": 0.06, "ugimp": 0.08, "bspline": 0.08, "cpgimp": 0.25, "cpgimp-v": 0.25}
#: The same with frozen weights, from a stretch of 3.5 on: their stiffness depends on the inverse of F, which amplifies
#: errors of F, most with hats and single particles at a rim. Chosen on 100 vortices up to A = 1.1.
FROZEN_FROM, FROZEN_EXCESS = 3.5, {"mpm": 1.5}
OTHER_FROZEN_EXCESS = 0.5
MOMENTS, MOMENTS_OF_HATS = 9, 17  # with hats a node at a rim that was just reached is nearly empty, for a moment


class StepBound(NamedTuple):
    """Longest stable steps of a motion, in s: of a run, of the exact motion by linear theory, and by Gershgorin's
    circles at its hardest moment; ``certain`` is False where the bound may be lower between the moments evaluated."""

    longest: float
    linear: float
    circles: float
    certain: bool = True

    def scaled_by_cell_size(self, factor: float) -> "StepBound":
        """Returns the same bound for cells ``factor`` times as large."""
        return StepBound(factor * self.longest, factor * self.linear, factor * self.circles, self.certain)


def motion_fractions(scene: Any) -> np.ndarray:
    """Returns the moments (n,) of the motion that are evaluated, as fractions: 0 is one extreme, 1 the other."""
    momentary = scene.method == "mpm" and scene.DIMENSIONS > 1 and not scene.frozen
    return np.linspace(0, 1, MOMENTS_OF_HATS if momentary else MOMENTS)


def combine_instant_bounds(scene: Any, limits: np.ndarray, seconds: float, stretch: float, circles: float,
                           crossed: bool = False) -> StepBound:
    """Returns the bound of a motion that takes ``seconds`` from one extreme to the other, from its longest steps
    ``limits`` (n,) in s at the ``motion_fractions``, its largest ``stretch`` and the Gershgorin bound ``circles`` in s
    at its hardest moment; ``crossed`` is whether, in the plane, a particle changes cells."""
    if scene.frozen or PIECES in scene.remedies:  # nothing crosses a cell
        found = longest_step_of_motion(limits, seconds)
        excess = FROZEN_EXCESS.get(scene.method, OTHER_FROZEN_EXCESS) * max(0.0, stretch - FROZEN_FROM)
        return StepBound(found / (1 + excess), found, circles)
    # The smallest for hats: how empty nodes are between two moments is unknown.
    found = float(limits.min()) if scene.method == "mpm" else longest_step_of_motion(limits, seconds)
    less = SHARE.get(scene.method, 1.0) / (1 + EXCESS[scene.method] * max(0.0, stretch - 2))
    return StepBound(less * found, found, circles, scene.method != "mpm" or not crossed)


def gershgorin_step_bound(nodes: np.ndarray, gradients: np.ndarray, stiffness: np.ndarray, mass: np.ndarray) -> float:
    """Returns the longest stable step in s by Gershgorin's circles. ``nodes`` and ``gradients`` |grad S| in 1/m are (P,
    K), ``stiffness`` k V of each particle in J (P,), ``mass`` of the nodes in kg (N,)."""
    carries = mass > MIN_MASS_SHARE * mass.max()
    scaled = np.where(carries[nodes], gradients / np.sqrt(np.where(carries, mass, 1.0))[nodes], 0.0)
    rows = np.bincount(nodes.ravel(), (stiffness[:, None] * scaled.sum(axis=1)[:, None] * scaled).ravel(), len(mass))
    return 2 / float(np.sqrt(rows.max()))


def stencil(method: str, position: np.ndarray, half_width: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Returns the first of three nodes (P,), their weights and slopes in 1/cell (P, 3), of particles at ``position``
    (P,) with domains of ``half_width`` (P,), in cells: ``solvers.kernels.shape_functions`` in numpy.

    A weight is the mean of the hat over the domain, its slope the hat's difference over the domain.
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
    """Returns the integral of the hat function, which is 1 at 0 and 0 beyond -1 and 1, from minus infinity to s."""
    s = np.clip(s, -1.0, 1.0)
    return np.where(s < 0, 0.5 * (1 + s) ** 2, 1 - 0.5 * (1 - s) ** 2)


@functools.lru_cache(maxsize=256)  # a live run needs it in each loop, for the automatic step
def scene_step_bound(scene: Any) -> StepBound:
    """Returns the longest stable steps in s for a scene's motion, whatever its own step, end, estimators, effects."""
    return _motion_step_bound(replace(scene, dt=None, cfl=None, t_end=AT_ONCE, periods=None, sample_every=None,
                                      estimators=(), effects=()))


@functools.lru_cache(maxsize=64)
def _motion_step_bound(scene: Any) -> StepBound:
    return scene.critical_time_step()


def step_warnings(scene: Any) -> list[str]:
    """Returns sentences for the user about a scene's own time step: unstable, or with hat functions uncertain."""
    bound, dt = scene_step_bound(scene), scene.time_step
    if dt > bound.longest:
        return [Message("time step {dt:.3g} s (cfl {courant_number:.2g}): above the stability bound of {most:.3g} s "
                        "along this motion (linear theory); the run will probably become unstable (--dt auto takes "
                        "{auto_step:.3g} s)", dt, scene.courant_number, bound.longest, SAFE * bound.longest)]
    if isinstance(scene.dt, str) and not bound.certain:
        return [Message("dt auto: with hat functions forces jump when particles cross cells, and nodes that are nearly "
                        "empty for a moment are stable only for tiny steps, so no step is certainly safe here; choose "
                        "another method, or --remedies frozen-weights")]
    return []


def gershgorin_to_linear_factor(scene: Any) -> float:
    """Returns the factor by which margins with Gershgorin's bound become margins with that of linear theory, at the
    hardest moment of the motion ahead; 1 where no margin is requested."""
    if not scene.has("margin"):
        return 1.0
    bound = scene_step_bound(scene)
    return bound.circles / bound.linear
