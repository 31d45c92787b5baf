"""What another code is given of a problem: particles, tables and numbers, from the problem's ``outside``."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from solvers.estimators.alone import solve
from solvers.judge.columns import LETTERS
from solvers.judge.frames import Frame
from solvers.outside import Start, Texts
from solvers.problems import PROBLEMS
from solvers.scene import Scene

SCHEMA = "mpm-lab/problem/1"


def start(scene: Scene) -> Start:
    return PROBLEMS[scene.problem].outside.start(scene)


def texts(scene: Scene) -> Texts:
    return PROBLEMS[scene.problem].outside.texts(scene)


def initial(scene: Scene) -> Frame:
    """The particles at the time 0."""
    outside, X = PROBLEMS[scene.problem].outside, start(scene).material_position
    at_rest = np.broadcast_to(np.eye(X.shape[1]), (len(X), X.shape[1], X.shape[1])).copy()
    return Frame("", 0.0, np.arange(len(X)), X, X.copy(), outside.velocity(scene, X, 0.0), at_rest)


def exact(scene: Scene, t: float) -> Frame:
    """The particles at a time where they should be."""
    outside, X = PROBLEMS[scene.problem].outside, start(scene).material_position
    return Frame("", t, np.arange(len(X)), X, X + outside.displacement(scene, X, t), outside.velocity(scene, X, t),
                 outside.deformation_gradient(scene, X, t), outside.exact_stress(scene, X, t))


def companion(scene: Scene, times: Sequence[float]) -> list[Frame]:
    """The particles where a companion has them: for problems that have no exact solution."""
    outside, X = PROBLEMS[scene.problem].outside, start(scene).material_position
    body, frames = outside.companion(scene, True), []
    for t, (u, v) in zip(times, solve(body, times), strict=True):
        (moved, gradient), (speed, _) = body.read(u, X), body.read(v, X)
        F = np.eye(X.shape[1]) + gradient
        frames.append(Frame("", t, np.arange(len(X)), X, X + moved, speed, F, outside.stress(scene, F)))
    return frames


def force_table(scene: Scene, points: int, times: int) -> dict[str, np.ndarray]:
    """The body force on a line of material points over the first two periods of its vibration."""
    outside = PROBLEMS[scene.problem].outside
    X, instants = outside.table_points(scene, points), np.linspace(0, 2 * scene.period, times)
    b = np.concatenate([outside.body_force(scene, X, t) for t in instants])
    where = {LETTERS[k].upper(): np.tile(X[:, k], times) for k in range(X.shape[1])}
    return {"t": np.repeat(instants, len(X)), **where, **{f"b{LETTERS[k]}": b[:, k] for k in range(X.shape[1])}}


def numbers(scene: Scene) -> dict:
    """The problem's numbers, for programs."""
    fields = {name: value for name, value in scene.to_dict().items()
              if name in ("problem", "cells", "ppc", "amplitude", "modulus", "density", "body_force", "layout", "t_end",
                          "periods")}
    return {**fields, "h": scene.spacing, "particles": len(start(scene).volume), "period": scene.period,
            "angular_frequency": scene.angular_frequency, "wave_speed": scene.wave_speed,
            "solution_known": scene.solution_known}
