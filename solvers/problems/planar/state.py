"""What is watched of a plane body, beside what is watched of any."""

from dataclasses import dataclass

from solvers.kernels.kinds import Pairs, Quads
from solvers.problems.planar.method.body import PlanarBody
from solvers.scene.estimator_hooks import EstimatorHooks
from solvers.scene.scene import Scene
from solvers.scene.switches import Switches
from solvers.solver.arrays import Watch, watch, zeros


@dataclass
class WatchedBody(Watch, PlanarBody):
    """A body and those who watch it, with the estimates that are vectors and tensors."""

    estimate_acceleration: Pairs  # estimated error of a (E*P, 2)
    estimate_stress: Quads  # estimated error of sigma, as xx, xy, yy and nothing (E*P, 4)


def watched(scene: Scene, on: Switches, particles: int, farthest: float, hooks: dict[str, EstimatorHooks]) -> dict:
    """The members of a :class:`WatchedBody` that are not of the body, at the start."""
    estimated, entries = bool(on.estimators), len(on.estimators) * particles
    return {**watch(scene, on, particles, farthest, hooks),
            "estimate_acceleration": zeros(entries, 2, when=estimated),
            "estimate_stress": zeros(entries, 4, when=estimated)}
