"""What the vortex's other estimators say, and what is refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from solvers.problems.ring.scene import RingScene
from solvers.problems.vortex import exact
from solvers.problems.vortex.scene import VortexScene
from solvers.running.run import build
from solvers.scene import registry
from solvers.scene.scene import SceneError
from solvers.solver import samples

VORTEX = VortexScene(estimators=("transport",), cells=24, amplitude=0.25, cfl=0.2, t_end=1.0)


def test_what_there_is():
    assert set(VortexScene.choices("estimators")) == {"companion", "recovered", "transport"}


def test_two_grid_is_refused_in_words():
    """In one sentence that says why, and what there is; the ring is not refused it."""
    with pytest.raises(SceneError, match=r"estimator two-grid: is not built for the vortex.*; give one of") as refused:
        replace(VORTEX, estimators=("two-grid",))
    assert "companion" in refused.value.sentence and refused.value.field == "estimators"
    registry.require_offered(("two-grid",), "ring", RingScene.choices("estimators"))


def test_recovered_meets_companion_where_no_solution_is_built_in():
    """Two tones, which send circles in and out: the two know nothing of each other."""
    scene = replace(VORTEX, cells=48, cfl=0.1, body_force="two-tone", estimators=("recovered", "companion"),
                    effects=("estimate",))
    solver = build(scene)
    solver.advance(scene.steps // 2)
    estimate = solver.snapshot().estimate
    for quantity in range(3):
        sizes = [np.linalg.norm(estimate[name][:, quantity]) for name in scene.estimators]
        assert 0.85 < sizes[0] / sizes[1] < 1.15


@pytest.mark.parametrize(("change", "word"), [
    ({"layout": "cartesian"}, "polar"), ({"cells": 12, "ppc": 1}, "cubic"), ({"cells": 20, "ppc": 1}, "24 cells"),
    ({"amplitude": 1.0}, "give 48 cells"), ({"amplitude": 1.0, "cells": 48, "cfl": 0.3}, "cfl of")])
def test_where_recovered_is_refused(change, word):
    scene = replace(VORTEX, **{"estimators": ("recovered",), **change})
    assert word in scene.not_valid["recovered"] and not scene.active_estimators


@pytest.mark.parametrize("chosen", ["transport", ("nobody",), (3,), None])
def test_what_is_no_estimator_is_left_to_others(chosen):
    """A list of names that has none of them, and what is no list, is not this rule's business but the scene's."""
    registry.require_offered(chosen, "vortex", VortexScene.choices("estimators"))
    with pytest.raises(SceneError):
        replace(VORTEX, estimators=chosen)


def test_transport_begins_with_nothing_though_a_does_not():
    """a(0) is not zero, but it is all body force: without stress there is no defect of a mapping to carry."""
    solver = build(replace(VORTEX, sample_every=1))
    solver.advance(1)
    first = np.abs(solver._arrays.estimate_acceleration).max()
    assert np.abs(solver._arrays.acceleration).max() > 0.1 * VORTEX.size_of("a")
    solver.advance(20)
    later = np.abs(solver._arrays.estimate_acceleration).max()
    assert first < 1e-9 * later


@pytest.mark.parametrize("estimator", ["companion", "transport"])
def test_difference_and_truth_of_the_acceleration_begin_at_zero(estimator):
    """At the start nobody has computed an acceleration, and nobody can be wrong about it."""
    scene = replace(VORTEX, estimators=(estimator,))
    solver = build(scene)
    series = samples.read(solver.measure(), scene, scene.particles)
    assert np.abs(exact.acceleration(scene, solver.snapshot().material_position, 0.0)).max() > 0.1
    assert series["error_a"] == series[f"{estimator}/estimate_a"] == series[f"{estimator}/difference_a"] == 0


def test_transport_is_refused_for_frozen_weights():
    scene = replace(VORTEX, remedies=("frozen-weights",))
    assert scene.not_valid["transport"].startswith("not valid here: ") and not scene.active_estimators
