"""Errors at every particle of a plane body, and the field for a plot, for snapshots, in numpy.

The page asks for them with every frame, so they cost as little as can be: what is known of a particle's circle is
looked up, and tensors are written out in components, since numpy's products of many small matrices are slow.
"""

import numpy as np

from solvers.problems.planar.method.body import WatchedBody
from solvers.problems.planar.parts import SnapshotMeasures
from solvers.problems.planar.scene import PlanarScene
from solvers.solver.snapshot import Values

#: Components of an error: (x, y) of a vector, (xx, xy, yy) of a tensor, None where it is unknown.
Parts = tuple[np.ndarray, ...] | None
Fields = list[Parts]  # of x, v, sigma and a


@np.errstate(all="ignore")  # a run gone bad holds anything
def true_fields(scene: PlanarScene, a: WatchedBody, step: int, measures: SnapshotMeasures) -> Fields:
    """The true errors of x, v, sigma and, with the effect, a after ``step`` steps."""
    time = step * scene.time_step
    used = measures.acceleration_error(scene, a, time - scene.time_step) if step and scene.has("acceleration") else None
    return [*measures.vector_errors(scene, a, time), measures.stress_error(scene, a, time), used]


@np.errstate(all="ignore")
def field(scene: PlanarScene, a: WatchedBody, quantity: str, time: float, measures: SnapshotMeasures) -> np.ndarray:
    """The component that a plot shows of a quantity by its key (``samples.QUANTITIES``), u for x, and its deviation
    from the exact one (P, 2), NaN where one is not known."""
    values = deviation = np.full(len(a.position_velocity), np.nan)
    if quantity != "a" or scene.has("acceleration"):
        values = measures.component(a, quantity)
    if scene.solution_known:
        deviation = values - measures.exact_component(scene, quantity, a.radii[:, 0], time)[a.radius]
    return np.stack([values, deviation], axis=1)


def estimated_fields(a: WatchedBody, estimator: int) -> Fields:
    """What the estimator of this number reports of the same errors."""
    part = slice(estimator * len(a.position_velocity), (estimator + 1) * len(a.position_velocity))
    motion = a.estimate[part].T
    return [(motion[0], motion[1]), (motion[2], motion[3]), tuple(a.estimate_stress[part].T[:3]),
            tuple(a.estimate_acceleration[part].T)]


def columns(parts: Fields) -> Values:
    """Those of x, v and sigma, which are known, with a column for each component."""
    return Values(*(np.stack(one, axis=1) for one in parts if one is not None))


def sizes(errors: Fields) -> np.ndarray:
    """Lengths of the vectors and Frobenius norms of the tensors (P, 4); 0 where an error is None."""
    out = np.zeros((next(len(parts[0]) for parts in errors if parts), len(errors)))
    with np.errstate(over="ignore", invalid="ignore"):
        for column, parts in enumerate(errors):
            if parts is not None:  # numpy's norm along so short an axis takes four times as long
                first, last = parts[0], parts[-1]
                square = first * first + last * last
                out[:, column] = np.sqrt(square if len(parts) == 2 else square + 2 * parts[1] * parts[1])
    return out


def difference(one: Fields, other: Fields) -> np.ndarray:
    """Sizes (P, 4) of ``one`` minus ``other``, direction and all. What is None counts as 0."""
    with np.errstate(over="ignore", invalid="ignore"):
        return sizes([mine if mine is None or theirs is None else
                      tuple(a - b for a, b in zip(mine, theirs, strict=True))
                      for mine, theirs in zip(one, other, strict=True)])
