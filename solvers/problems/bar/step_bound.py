"""The bound on the bar's time step along the motion ahead (see ``solvers.scene.step_bound``), with the tangent
stiffness E F^2 V0; and the theoretical time until breakdown."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from solvers.problems.bar import patch_test_inputs
from solvers.scene.linear_stability import LinearisedConfigurations, ParticleNodeUnknowns, longest_step_per_instant
from solvers.scene.scene import Scene
from solvers.scene.stabilisations import PIECES
from solvers.scene.step_bound import StepBound, combine_instant_bounds, gershgorin_step_bound, motion_fractions, stencil

MOST_PARTICLES = 600  # of the bar that are evaluated; a finer bar has more cells of the same kind
PATCH_POSITIONS = 17  # of a patch test in its cell
DRIFT_INSTANTS = 2000  # of a period
INSTANTS_PER_PERIOD = 33  # moments of a typed motion


@dataclass(frozen=True)
class BarConfiguration:
    """Bar on ``cells`` cells at one moment: the weights (P, 3) of P particles at their ``nodes``, the gradients (P, K)
    in 1/m of their forces at the ``force_nodes``, their stiffness E F^2 V0 (P,) in J, and their ``mass`` each in kg."""

    cells: int
    nodes: np.ndarray
    weights: np.ndarray
    force_nodes: np.ndarray
    gradients: np.ndarray
    stiffness: np.ndarray
    mass: float

    def gershgorin_bound(self) -> float:
        """Returns the longest stable step in s by Gershgorin's circles."""
        mass = np.bincount(self.nodes.ravel(), (self.mass * self.weights).ravel(), self.cells)
        return gershgorin_step_bound(self.force_nodes, np.abs(self.gradients), self.stiffness, mass)


def critical_time_step(scene: Any, stretch: float, velocity: float) -> StepBound:
    """Returns the longest stable steps, in s, along the bar's motion from one extreme to the other, or over a typed
    motion's period. A patch test starts with this ``stretch`` (no unit) and this ``velocity`` in m/s."""
    if not scene.swings:
        return _patch_time_step(scene, stretch, velocity)
    ppc = int(scene.ppc)
    cells = max(8, min(scene.cells, MOST_PARTICLES // ppc))
    X = (np.arange(cells * ppc) + 0.5) / (cells * ppc)
    if scene.motion_formula:
        seconds, solution = scene.motion_period, scene.typed_solution
        shapes = [(solution.displacement(scene, X, t), solution.deformation_gradient(scene, X, t))
                  for t in seconds * np.linspace(0, 1, INSTANTS_PER_PERIOD)]
    else:
        seconds, sizes = 0.5 * scene.period, scene.motion_amplitude * np.sin(np.pi * (motion_fractions(scene) - 0.5))
        shapes = [(size * np.sin(2 * np.pi * X), 1 + 2 * np.pi * size * np.cos(2 * np.pi * X)) for size in sizes]
    found = [configuration_at(scene, cells, X if scene.frozen else X + u, F) for u, F in shapes]
    each = longest_step_per_instant(stack_configurations(found))
    seconds *= scene.cells / cells  # as many steps as on the cells that the scene has
    stretch = 1 + scene.size_of("sigma") / scene.modulus
    circles = found[int(np.argmin(each))].gershgorin_bound()
    return combine_instant_bounds(scene, each, seconds, stretch, circles).scaled_by_cell_size(cells / scene.cells)


def _patch_time_step(scene: Scene, stretch: float, velocity: float) -> StepBound:
    """Returns the longest stable steps in s of a patch test, stretched by ``stretch``, while its particles pass through
    a cell at ``velocity`` in m/s; their spacing never changes."""
    cells, particles = patch_test_inputs.repeating_unit(scene)
    times = max(1, min(scene.cells // cells, MOST_PARTICLES // particles))
    cells, particles = times * cells, times * particles
    X = (np.arange(particles) + 0.5) / particles
    shifts = np.linspace(0, 1, PATCH_POSITIONS) / cells if velocity and not scene.frozen else [0.0]
    found = [configuration_at(scene, cells, X + shift, np.ones_like(X), stretch) for shift in shifts]
    each = longest_step_per_instant(stack_configurations(found))
    least, circles = float(each.min()), found[int(np.argmin(each))].gershgorin_bound()
    return StepBound(least, least, circles).scaled_by_cell_size(cells / scene.cells)


def configuration_at(scene: Scene, cells: int, x: np.ndarray, F: np.ndarray, stretch: float = 1.0) -> BarConfiguration:
    """Returns the bar on ``cells`` cells with particles at x (P,) in m, deformed by F (P,) since it began at
    ``stretch``; the scene has the method and the material."""
    volume = 1 / len(x)
    half_width = np.full_like(x, 0.5 / scene.ppc)
    if scene.method == "cpgimp" and not scene.frozen:
        half_width = np.minimum(half_width * F, 0.5)
    first, S, dS = stencil(scene.method, x * cells, half_width)
    nodes, mass = (first[:, None] + np.arange(3)) % cells, scene.density / stretch * volume
    if PIECES in scene.remedies:
        pulling, parting = _piece_stencils(scene.method, cells, x)
        return BarConfiguration(cells, nodes, S, pulling, parting, np.full_like(x, scene.modulus * stretch / volume),
                                mass)
    tangent = np.ones_like(F) if scene.frozen else F * F
    return BarConfiguration(cells, nodes, S, nodes, dS * cells, scene.modulus * stretch * tangent * volume, mass)


def stack_configurations(configurations: Sequence[BarConfiguration]) -> LinearisedConfigurations:
    """Returns one bar's configurations at n moments as one object, whose arrays have the moments as first axis."""
    nodes, S, pulling, gradients, stiffness = (
        np.stack([getattr(one, name) for one in configurations])
        for name in ("nodes", "weights", "force_nodes", "gradients", "stiffness"))
    return LinearisedConfigurations(configurations[0].cells, ParticleNodeUnknowns([nodes], [np.ones_like(S)]), S,
                                    ParticleNodeUnknowns([pulling], [np.ones_like(gradients)]), [gradients],
                                    np.full(S.shape[1], configurations[0].mass), lambda rates: [stiffness * rates[0]])


def _piece_stencils(method: str, cells: int, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Returns the nodes (P, 5) of the pieces around particles at x (P,) in m, and the force of each piece at them per
    unit of stress (P, 5): the difference of the base functions at its corners (see ``method.gapless_pieces``)."""
    P = len(x)
    around = np.concatenate([x[-2:] - 1, x, x[:2] + 1])
    corners = (9 * (around[1:P + 2] + around[2:P + 3]) - around[:P + 1] - around[3:]) / 16
    first, B, _ = stencil("bspline" if method == "bspline" else "mpm", corners * cells, np.zeros(P + 1))
    apart = np.minimum(np.diff(first), 2)
    parting = np.zeros((P, 5))
    parting[:, :3] -= B[:-1]
    for k in range(3):
        parting[np.arange(P), apart + k] += B[1:, k]
    return (first[:-1, None] + np.arange(5)) % cells, parting


def null_space_drift(scene: Scene) -> float:
    """Returns the drift per period of FLIP's velocity that no node sees, as RMS over particles, in m/s.

    A particle's velocity changes by the interpolated acceleration sum S_i a_i, which is a(x_p) + a_xx S2/2 with S2 =
    sum S_i (x_i - x_p)^2. S2 depends on the particle's place in its cell and so on the motion itself: its product with
    a_xx does not vanish over a period, and what it leaves adds up from period to period. The rate is known to about
    6 %; that x fails when v has drifted by about A w is the cruder part: at large amplitude other things come first.
    """
    X, k, w = (np.arange(scene.particles) + 0.5) / scene.particles, 2 * np.pi, scene.angular_frequency
    total, width = np.zeros_like(X), np.full_like(X, 0.5 / scene.ppc)
    for t in (np.arange(DRIFT_INSTANTS) + 0.5) * scene.period / DRIFT_INSTANTS:
        u = scene.motion_amplitude * np.sin(w * t)
        x, F, F_X = X + u * np.sin(k * X), 1 + k * u * np.cos(k * X), -k * k * u * np.sin(k * X)
        a_X, a_XX = -w * w * u * k * np.cos(k * X), w * w * u * k * k * np.sin(k * X)
        a_xx = (a_XX / F - a_X * F_X / F**2) / F
        half_width = np.minimum(width * F, 0.5) if scene.method == "cpgimp" else width
        first, S, _ = stencil(scene.method, x * scene.cells, half_width)
        apart = (first[:, None] + np.arange(3)) * scene.spacing - x[:, None]
        total += 0.5 * a_xx * (S * apart**2).sum(axis=1)
    return float(np.sqrt(np.mean((total * scene.period / DRIFT_INSTANTS) ** 2)))


def predicted_life_in_periods(scene: Any) -> float | None:
    """Returns the number of periods until the drift of the velocity reaches A w and the run fails; None where a remedy
    corrects it or something else comes first, and for a motion by formula."""
    if scene.remedies or scene.linearity_preserving or scene.velocity != "grid" or scene.method == "mpm" \
            or scene.motion_formula:
        return None
    return scene.size_of("v") / null_space_drift(scene)
