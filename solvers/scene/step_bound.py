"""The longest time step that a scene's motion ahead bears, found before anything has run, and what of it is taken.

Along the exact motion, from one extreme to the other, the step is linearised at ``motion_parts`` evenly spaced in time
(``solvers.scene.linear_stability``). A run's own motion is not quite the exact one; how much less it bears is measured.
Particles that hat functions or boxes of one width carry through the grid are not where the weights add up (``SHARE``).
Where material is drawn out to more than twice its length, stretches of a run exceed the exact ones, by the more the
worse a method's domains follow (``EXCESS``).

With hat functions forces jump where particles cross cells, and in the plane a node beyond a rim that a particle has
just reached is nearly empty. For that moment it bears hardly any step, and what that does to the run is luck, with
short steps as with long ones: such a bound is not ``certain``.

A run's own margin comes from its kernels, which need something cheaper than eigenvalues: Gershgorin's circles about
the stiffness of the grid (:func:`circle_bound`), K_ij = sum_p k_p V_p grad S_i . grad S_j, k_p the tangent modulus in
the present configuration. The rows of the similar matrix M^-1/2 K M^-1/2 bound its eigenvalues:

    dt <= 2/sqrt(max_i sum_p k_p V_p |grad S_ip|/sqrt(m_i) sum_j |grad S_jp|/sqrt(m_j)).

Divided like this a node that a particle's domain only just touches asks for no shorter step: its mass vanishes with the
square of its gradient. Margins are counted in units in which that of the hardest moment ahead is the step over what
linear theory gives for the motion. Source: Gershgorin (1931).
"""

import functools
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from solvers.message import Message
from solvers.scene.linear_stability import MIN_MASS_SHARE, longest_step
from solvers.scene.remedies import PIECES

SAFE = 0.9  # of the bound
AT_ONCE = 1e-30  # seconds: an end that every scene may have; a default one takes too many steps where material is stiff
SHARE = {"mpm": 0.88, "ugimp": 0.88}  # of the bound along the exact motion, with weights that move with the particles
#: By how much less a run bears for each unit of stretch beyond 2: boxes that follow the stretch alone tear in shear.
EXCESS = {"cpdi": 0.06, "mpm": 0.06, "ugimp": 0.08, "bspline": 0.08, "cpgimp": 0.25, "cpgimp-v": 0.25}
#: The same with weights that never move, from a stretch of 3.5 on: their stiffness goes with the inverse of F, in which
#: what a run's F is off is much; of hats, with single particles at a rim, the most. Chosen on 100 vortices to A = 1.1.
FROZEN_FROM, FROZEN_EXCESS = 3.5, {"mpm": 1.5}
OTHER_FROZEN_EXCESS = 0.5
MOMENTS, MOMENTS_OF_HATS = 9, 17  # with hats a node at a rim that was just reached is nearly empty, for a moment


class StepBound(NamedTuple):
    """The longest step for a motion, in seconds: what a run bears, and the exact motion by linear theory; what the
    circles say at its hardest moment; and whether every moment is like those that were looked at."""

    longest: float
    linear: float
    circles: float
    certain: bool = True

    def on_cells(self, size: float) -> "StepBound":
        """The same on cells so many times as large."""
        return StepBound(size * self.longest, size * self.linear, size * self.circles, self.certain)


def motion_parts(scene: Any) -> np.ndarray:
    """Moments of the motion from one extreme, 0, to the other, 1, at which it is looked at."""
    momentary = scene.method == "mpm" and scene.DIMENSIONS > 1 and not scene.frozen
    return np.linspace(0, 1, MOMENTS_OF_HATS if momentary else MOMENTS)


def motion_bound(scene: Any, limits: np.ndarray, seconds: float, stretch: float, circles: float,
                 crossed: bool = False) -> StepBound:
    """The bound of a motion from one extreme to the other in so many ``seconds``, whose ``limits`` are known at the
    ``motion_parts``, whose largest ``stretch`` this is, and at whose hardest moment the ``circles`` say this;
    ``crossed`` says whether a particle is in another cell at one moment than at another, in the plane."""
    if scene.frozen or PIECES in scene.remedies:  # nothing crosses a cell
        found = longest_step(limits, seconds)
        excess = FROZEN_EXCESS.get(scene.method, OTHER_FROZEN_EXCESS) * max(0.0, stretch - FROZEN_FROM)
        return StepBound(found / (1 + excess), found, circles)
    # Of hats the least: how empty nodes are between two moments is not known.
    found = float(limits.min()) if scene.method == "mpm" else longest_step(limits, seconds)
    less = SHARE.get(scene.method, 1.0) / (1 + EXCESS[scene.method] * max(0.0, stretch - 2))
    return StepBound(less * found, found, circles, scene.method != "mpm" or not crossed)


def circle_bound(nodes: np.ndarray, gradients: np.ndarray, stiffness: np.ndarray, mass: np.ndarray) -> float:
    """The bound in seconds: ``nodes`` and |grad S| at them (P, K), k V of each particle (P,), the nodes' mass (N,)."""
    carries = mass > MIN_MASS_SHARE * mass.max()
    scaled = np.where(carries[nodes], gradients / np.sqrt(np.where(carries, mass, 1.0))[nodes], 0.0)
    rows = np.bincount(nodes.ravel(), (stiffness[:, None] * scaled.sum(axis=1)[:, None] * scaled).ravel(), len(mass))
    return 2 / float(np.sqrt(rows.max()))


def stencil(method: str, position: np.ndarray, half_width: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """First of three nodes (P,), weights and slopes in 1/cell there (P, 3), as ``solvers.kernels.shape_functions``, in
    numpy.

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
def scene_step_bound(scene: Any) -> StepBound:
    """The bound for the motion that a scene has ahead, whatever its own step, end and watchers are."""
    return _motion_step_bound(replace(scene, dt=None, cfl=None, t_end=AT_ONCE, periods=None, sample_every=None,
                                      estimators=(), effects=()))


@functools.lru_cache(maxsize=64)
def _motion_step_bound(scene: Any) -> StepBound:
    return scene.critical_time_step()


def step_warnings(scene: Any) -> list[str]:
    """Sentences about what a scene's own step will surprise with."""
    bound, dt = scene_step_bound(scene), scene.time_step
    if dt > bound.longest:
        return [Message("time step {dt:.3g} s (cfl {courant_number:.2g}): above the stability bound of {most:.3g} s "
                        "along this motion (linear theory); the run will probably become unstable (--dt auto takes "
                        "{longest2:.3g} s)", dt, scene.courant_number, bound.longest, SAFE * bound.longest)]
    if isinstance(scene.dt, str) and not bound.certain:
        return [Message("dt auto: with hat functions forces jump when particles cross cells, and nodes that are nearly "
                        "empty for a moment are stable only for tiny steps, so no step is certainly safe here; choose "
                        "another method, or --remedies frozen-weights")]
    return []


def margin_unit(scene: Any) -> float:
    """What a step over the circles is to be multiplied with to be, at the hardest moment of the motion ahead, the step
    over what linear theory gives for it; 1 where no margin is asked for."""
    if not scene.has("margin"):
        return 1.0
    bound = scene_step_bound(scene)
    return bound.circles / bound.linear
