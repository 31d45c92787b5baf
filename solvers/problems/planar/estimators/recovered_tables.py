"""The recovered estimator in the plane outside kernels: its operators as tables of rows, and its verdict."""

from collections.abc import Mapping, Sequence

import numpy as np

from solvers.estimators import recovered_common
from solvers.estimators.lattice_line_operators import LatticeLine, Rows
from solvers.estimators.recovered_common import SHORT, SHORTEST, SIZE
from solvers.problems.planar.estimators import recovered_operators as op
from solvers.problems.planar.particle_layout import particle_layout, points_on_x_axis
from solvers.problems.planar.scene import PlanarScene
from solvers.translatable_message import Message

SPARSE_WIDTH = 1.5  # cells to an element with one particle per cell
WAVE_CFL = 0.7  # H c over the shortest side of an element, where the run's own step is shorter
MOST_CFL = {"mirror": 0.72, "periodic": 0.8, "walls": 0.72}  # the same where it is not: beyond .74
# and .84 the reference breaks down
#: The part of the error found that are waves of a few cells: what smoothing takes from it less what it takes from that
#: again, which leaves noise from node to node. So much may it be for each cell along a side, for fits are the narrower
#: the more there are, and so much on any. Measured on 460 vortices of 14 to 80 cells: x, v and sigma within .9 to 1.1
#: in 9 of 10 below, in 1 of 5 above, where they are .6 to .9.
FEW_PER_CELL, LEAST_FEW = 0.0025, 0.08
UNEVEN_FEW = 1.5  # times that where particles move with their own velocity, whose noise is as short


def project_component(rows: Rows, component: int, values: np.ndarray) -> np.ndarray:
    """Returns (nodes, lines): component ``component`` of a field, ``values`` (points, lines), mapped by the integrals
    ``rows`` (``Line.projection_operator``) along the first axis."""
    return np.stack([rows(line)[:, component, 0] for line in values.T], axis=1)


def project_directions(angle: LatticeLine, gather_table: Rows) -> tuple[np.ndarray, np.ndarray]:
    """Returns M e_R and M e_angle at the nodes of the line ``angle`` (A, 2); between symmetry planes M e_angle is 0.
    ``gather_table`` is M along it, by its ``projection_operator``."""
    theta = angle.particle_positions() / angle.points_per_length
    c, s = np.cos(theta), np.sin(theta)
    means = [gather_table(wave)[:, :, 0] for wave in (c, s)]
    along = np.stack([wave[:, k % wave.shape[1]] for k, wave in enumerate(means)], axis=1)
    return along, (np.zeros_like(along) if angle.ends == "mirror" else np.stack([-along[:, 1], along[:, 0]], axis=1))


def cartesian_weights(rows: Rows, swapped: bool = False) -> Rows:
    """Returns the map ``rows`` along x, or if ``swapped`` y, with weights (value x, value y, slope x, slope y)."""
    weights = np.broadcast_to(rows.weights[..., :2], (*rows.weights.shape[:2], 2, 2))[:, :, ::-1 if swapped else 1]
    return Rows(rows.first, np.swapaxes(weights, 2, 3).reshape(*weights.shape[:2], 4))


def pad_to_four(rows: Rows) -> Rows:
    """Returns the map ``rows`` on a radius, which has one component, with its weights padded to four."""
    weights = rows.weights[:, :, 0]
    return Rows(rows.first, np.concatenate([weights, np.zeros((*weights.shape[:2], 4 - weights.shape[2]))], axis=2))


def interval(scene):
    """Returns the run's steps per step of recovered's reference, which moves by an explicit method in the material
    frame, with elements whose sides waves pass at the scene's ``wave_angle_per_metre``. Under large shear these steps
    are hardly longer than the run's, and the estimator costs more than the run."""
    across, along = lattice_lines(scene)
    side = 1 / max(across.elements_per_length * scene.wave_angle_per_metre, along.elements_per_length)
    return recovered_common.wave_travel_steps(scene, WAVE_CFL * side)


def lattice_lines(scene):
    """Returns a scene's two ``LatticeLine``, around and across a ring or along x and y of a square, with elements one
    cell wide, at the inner rim of a ring. With one particle per cell they are half as wide again: elements as narrow as
    particle spacings are unstable. None is narrower than the reference's step bears, no shorter than the run's."""
    width = scene.spacing * (SPARSE_WIDTH if scene.ppc == 1 else 1.0)
    counts = scene.lattice_counts(scene.cells, scene.ppc)
    if scene.layout == "box":
        narrowest = scene.wave_angle_per_metre * scene.wave_speed * scene.time_step / MOST_CFL["walls"]
        line = LatticeLine(counts[0], min(round(scene.SIDE / width), int(scene.SIDE / narrowest)), scene.SIDE, "walls")
        return line, line
    turn, across = scene.ANGLE, scene.OUTER - scene.INNER
    ends = "periodic" if turn >= 2 * np.pi else "mirror"
    narrowest = scene.wave_speed * scene.time_step / MOST_CFL[ends]
    around, radial = (min(round(length / width), int(length / narrowest)) for length in (turn * scene.INNER, across))
    return LatticeLine(counts[0], max(3, around), turn, ends), LatticeLine(counts[1], max(1, radial), across, "free")


def allocate(scene):
    """Returns recovered's arrays by name for a scene: operators across and along lines, and the initial reference."""
    across, along = lattice_lines(scene)
    box, width = scene.layout == "box", recovered_common.fit_width(scene)
    R = 1.0 if box else scene.INNER + along.quadrature()[0] / along.points_per_length
    over_lines = [across.fit_operator(width, 3), across.interpolation_operator(), across.projection_operator(4, 2),
                  across.smoothing_operator()]
    on_line = [along.fit_operator(width, 3), along.interpolation_operator(), along.projection_operator(4, 2, R),
               along.smoothing_operator(R)]
    tables = [cartesian_weights(rows, swapped=box) for rows in over_lines] \
        + [cartesian_weights(rows) if box else pad_to_four(rows) for rows in on_line]
    nodes = np.zeros((op.NODE_BLOCKS, across.node_count * along.node_count, 4))
    if box:
        v = scene.EXACT.velocity(scene, particle_layout(scene).position, 0.0).reshape(across.points, along.points, 2)
        for k in (0, 1):
            on_nodes = project_component(over_lines[2], 1 - k, project_component(on_line[2], k, v[:, :, k].T).T)
            nodes[op.MOTION, :, 2 + k] = on_nodes.ravel()
    else:
        radius = scene.INNER + along.particle_positions() / along.points_per_length  # m
        velocity = scene.EXACT.velocity(scene, points_on_x_axis(radius), 0.0).T
        outward, sideways = project_directions(across, over_lines[2])
        speed, turning = (on_line[2](v)[:, 0, 0, None] for v in velocity)
        nodes[op.MOTION, :, 2:] = (outward[:, None] * speed + sideways[:, None] * turning).reshape(-1, 2)
        nodes[op.DIRECTION, :across.node_count] = np.concatenate([outward, sideways], axis=1)
    return {"recovered_numbers": recovered_common.initial_numbers(scene, interval(scene)),
            "recovered_silent": 2 if scene.is_uneven else int(scene.is_coarse), "recovered_nodes": nodes.reshape(-1, 4),
            **lattice_arrays(across, along, tables)}


def lattice_arrays(across: LatticeLine, along: LatticeLine, tables: Sequence[Rows]) -> dict:
    """Returns arrays of a lattice by name: its ``tables`` in the order of ``op.TABLES``, and the particles' blocks."""
    fields = op.PARTICLE_BLOCKS * across.points * along.points + 2 * across.points * along.node_count
    return {**recovered_common.table_values(dict(zip(op.TABLES, tables, strict=True))),
            "recovered_count": across.node_count * along.node_count, "recovered_line": along.points,
            "recovered_line_nodes": along.node_count, "recovered_particles": np.zeros((fields, 4))}


def verdict(scene: PlanarScene, memory: Mapping[str, np.ndarray]) -> str | None:
    """Returns why not to trust recovered's estimate, as a sentence, or None: a bad reference, or errors too short for
    fits and error grid. ``memory`` are its arrays by name."""
    U = memory["recovered_nodes"].reshape(op.NODE_BLOCKS, -1, 4)[op.MOTION, :, :2]
    if reason := recovered_common.why_not_trusted(memory, np.abs(U).max() / scene.motion_amplitude):
        return reason
    size, short, shortest = np.sqrt(memory["recovered_numbers"][[SIZE, SHORT, SHORTEST]])
    few = (short - shortest) / size if size > 0 else 0.0
    most = max(LEAST_FEW, FEW_PER_CELL * scene.cells) * (UNEVEN_FEW if scene.velocity == "particle" else 1.0)
    return None if few <= most else (
        Message("not valid here: {few:.2g} of the error found are waves of a few cells (and may be {most:.2g}), which "
                "recovered's fits over four cells see in part; take more cells", few, most))
