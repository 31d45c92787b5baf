"""Runs of our own methods on the same grid, at the same times."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from solvers.judging.error_norms import Errors, TwoMeshCompanion, norm_series, summarise_norms, true_errors
from solvers.judging.particle_data_types import Frame
from solvers.running.run import build
from solvers.scene.scene import Scene
from solvers.solver.particle_snapshot import Snapshot

LONGEST = 2e9  # particle-steps of one comparison: a minute or so
ON_A_STEP = 1e-6  # of a step, within which a time is that of a step
LONGEST_STRETCH = 4096  # steps between two looks at the progress


@dataclass(frozen=True)
class ReferenceRun:
    """Run of one of our methods: ``norms`` (T,) of its error by quantity at the ``times`` in s that it reached."""

    scene: Scene
    times: np.ndarray
    norms: dict[str, np.ndarray]
    status: str  # "ok", or why there is nothing more

    def to_dict(self) -> dict:
        return {"method": self.scene.method, "linearity_preserving": self.scene.linearity_preserving,
                "cells": self.scene.cells, "cfl": self.scene.courant_number, "status": self.status,
                "error": summarise_norms(self.times, self.norms)}


def reference_scenes(scene: Scene) -> list[Scene]:
    """Returns a scene for each of our methods on the grid of a scene, without estimators and diagnostics."""
    return [replace(scene, method=method, linearity_preserving=lp, estimators=(), effects=(), remedies=())
            for method, lp in scene.candidates()]


def run_reference(scene: Scene, times: Sequence[float], companions: TwoMeshCompanion | None = None,
                  on_progress: Callable[[float], None] | None = None) -> ReferenceRun:
    """Runs a scene and returns its RMS errors at the times in s, against the truth, or a companion where there is none;
    ``on_progress`` gets the part done."""
    steps = [round(t / scene.time_step) for t in times]
    if scene.particles * steps[-1] > LONGEST:
        return ReferenceRun(scene, np.array([]), norm_series([]),
                            f"not run: {scene.particles * steps[-1]:.2g} particle-steps are too many for a comparison")
    stepper = _InterpolatedRun(scene, on_progress, steps[-1])
    errors: list[Errors] = []
    for time in times:
        frame = stepper.frame_at(time)
        if frame is None:
            break
        errors.append(true_errors(scene, frame) if companions is None else companions.errors(frame))
    status = "ok" if len(errors) == len(times) else f"unstable at {stepper.solver.time:.3g} s"
    return ReferenceRun(scene, np.array(times[:len(errors)]), norm_series(errors), status)


class _InterpolatedRun:
    """Run of one of our methods, evaluated at times between its steps."""

    def __init__(self, scene: Scene, on_progress: Callable[[float], None] | None, last: int):
        self._scene, self._tell, self._last = scene, on_progress or (lambda part: None), max(1, last)
        self.solver = build(scene)
        self.solver.compile()
        self._held: dict[int, Snapshot] = {}

    def frame_at(self, time: float) -> Frame | None:
        """Returns the particles at a time in s: those of a step, or between two by cubic Hermite polynomials in x and
        linear interpolation of the rest; None where the run did not get there."""
        turns = time / self._scene.time_step
        whole = abs(turns - round(turns)) < ON_A_STEP
        first = round(turns) if whole else math.floor(turns)
        shot = self._frame_at_step(first)
        later = shot if whole else self._frame_at_step(first + 1)
        if shot is None or later is None or not (np.isfinite(shot.position) & np.isfinite(later.position)).all():
            return None
        if whole:
            return frame_of_snapshot(shot, self._scene, time)
        return _interpolate_frames(frame_of_snapshot(shot, self._scene), frame_of_snapshot(later, self._scene), time)

    def _frame_at_step(self, step: int) -> Snapshot | None:
        """Returns the particles after a step, None if the run broke; only the last two steps can be asked for again."""
        while step not in self._held and self.solver.step < step and self.solver.sound:
            self.solver.advance(min(step - self.solver.step, LONGEST_STRETCH, self.solver.longest_advance))
            self._tell(self.solver.step / self._last)
        if not self.solver.sound:
            return None
        if step not in self._held:
            self._held = {n: shot for n, shot in self._held.items() if n == step - 1} | {step: self.solver.snapshot()}
        return self._held[step]


def _interpolate_frames(one: Frame, other: Frame, time: float) -> Frame:
    """Returns the particles at a time in s between two frames of a run, one step apart."""
    H = other.time - one.time
    s = (time - one.time) / H
    left = 1 - s
    assert one.velocity is not None and other.velocity is not None
    assert one.deformation_gradient is not None and other.deformation_gradient is not None
    x = (1 + 2 * s) * left**2 * one.position + s * left**2 * H * one.velocity \
        + s * s * (3 - 2 * s) * other.position - s * s * left * H * other.velocity
    return replace(one, time=time, position=x, velocity=left * one.velocity + s * other.velocity,
                   deformation_gradient=left * one.deformation_gradient + s * other.deformation_gradient)


def frame_of_snapshot(shot: Snapshot, scene: Scene, time: float | None = None) -> Frame:
    """Returns a snapshot of a run as a frame at its own time, or at ``time`` in s, which differs by rounding."""
    D, P = scene.DIMENSIONS, len(shot.position)
    return Frame("", shot.time if time is None else time, np.arange(P), shot.material_position.reshape(P, D),
                 shot.position.reshape(P, D), shot.velocity.reshape(P, D), shot.deformation_gradient.reshape(P, D, D))
