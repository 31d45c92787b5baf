"""Data of a problem for other codes: particles, tables and numbers, from the problem's ``reference``."""

from collections.abc import Sequence

import numpy as np

from solvers.estimators.standalone_companion import ElasticBody, MotionDivergedError, solve
from solvers.judging.particle_data_types import Frame
from solvers.judging.quantity_names import LETTERS
from solvers.problems import PROBLEMS
from solvers.problems.judging_reference import METHOD_FIELDS, InitialParticles
from solvers.scene.scene import Scene
from solvers.scene.validation import SceneError, field_key

SCHEMA = "mpm-lab/problem/1"


def start(scene: Scene) -> InitialParticles:
    """Returns the problem's particles at t = 0: material positions in m and volumes."""
    return PROBLEMS[scene.problem].reference.start(scene)


def initial_frame(scene: Scene) -> Frame:
    """Returns the problem's particles at t = 0, with their velocity and F."""
    reference, X = PROBLEMS[scene.problem].reference, start(scene).material_position
    return Frame("", 0.0, np.arange(len(X)), X, X.copy(), reference.velocity(scene, X, 0.0),
                 reference.initial_deformation_gradient(scene, X))


def particle_masses(scene: Scene) -> np.ndarray:
    """Returns the particles' masses (P,) in kg for a thickness of 1 m: the density is that of undeformed material."""
    return scene.density * start(scene).volume / np.linalg.det(np.asarray(initial_frame(scene).deformation_gradient))


def exact_frame(scene: Scene, t: float) -> Frame:
    """Returns the particles at their exact positions at the time ``t`` in s, for a scene with a known solution."""
    reference, X = PROBLEMS[scene.problem].reference, start(scene).material_position
    return Frame("", t, np.arange(len(X)), X, X + reference.displacement(scene, X, t), reference.velocity(scene, X, t),
                 reference.deformation_gradient(scene, X, t), reference.exact_stress(scene, X, t))


def companion_frames(scene: Scene, times: Sequence[float]) -> list[Frame]:
    """Returns the companion's particles at increasing times (T,) in s: for problems without an exact solution. Raises
    :class:`~solvers.scene.validation.SceneError` where it is lost (its numbers are not finite)."""
    X = start(scene).material_position
    body, solved = solve_companion(scene, True, times)
    states = (fields_at_points(scene, body, motion, X) for motion in solved)
    return [Frame("", t, np.arange(len(X)), X, X + u, *rest) for t, (u, *rest) in zip(times, states, strict=True)]


def fields_at_points(scene: Scene, body: ElasticBody, motion: tuple[np.ndarray, np.ndarray], X: np.ndarray) -> tuple[
        np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Returns displacement and velocity (P, D), F and Cauchy stress (P, D, D) at material points X (P, D) of a
    companion's ``body`` in the state ``motion`` (:func:`solve_companion`)."""
    (u, gradient), (v, _) = (body.values_and_gradients(field, X) for field in motion)
    reference = PROBLEMS[scene.problem].reference
    F = (np.eye(X.shape[1]) + gradient) @ reference.initial_deformation_gradient(scene, X)
    return u, v, F, reference.stress(scene, F)


def solve_companion(scene: Scene, fine: bool,
                    times: Sequence[float]) -> tuple[ElasticBody, list[tuple[np.ndarray, np.ndarray]]]:
    """Returns the companion's body, on the fine or the coarse mesh, and its nodes' displacement and velocity at each of
    the ``times`` in s. Raises :class:`~solvers.scene.validation.SceneError` where it is lost."""
    body = PROBLEMS[scene.problem].reference.companion(scene, fine)
    try:
        return body, solve(body, times)
    except MotionDivergedError as lost:
        raise SceneError("amplitude", scene.amplitude, "is so large that the companion, a spectral-element solution of "
                         f"the same problem, is lost before t = {lost.time:.4g} s (body force {scene.body_force}); "
                         "give earlier times or a smaller amplitude") from None


def body_force_table(scene: Scene, points: int, times: int) -> dict[str, np.ndarray]:
    """Returns the body force at about ``points`` material points on a line, at ``times`` times in two periods of the
    vibration: columns (n,) of t in s, X in m and b in m/s^2."""
    reference = PROBLEMS[scene.problem].reference
    X, instants = reference.table_points(scene, points), np.linspace(0, 2 * scene.period, times)
    b = np.concatenate([reference.body_force(scene, X, t) for t in instants])
    where = {LETTERS[k].upper(): np.tile(X[:, k], times) for k in range(X.shape[1])}
    return {"t": np.repeat(instants, len(X)), **where, **{f"b{LETTERS[k]}": b[:, k] for k in range(X.shape[1])}}


def problem_parameters(scene: Scene) -> dict:
    """Returns the problem's inputs and derived numbers in SI units, by the names of the JSON handout."""
    of_methods = {field_key(name) for name in METHOD_FIELDS}
    fields = {key: value for key, value in scene.to_dict().items() if key not in of_methods and value is not None}
    return {**fields, "h": scene.spacing, "particles": len(start(scene).volume), "period": scene.period,
            "angular_frequency": scene.angular_frequency, "wave_speed": scene.wave_speed,
            "solution_known": scene.solution_known}
