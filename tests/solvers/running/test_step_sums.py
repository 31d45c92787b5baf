"""What a step adds up over its particles: the work of the body force, the impulse of its torque, and crossings."""

import numpy as np
import pytest

from solvers.problems import PROBLEMS
from solvers.running.run import build
from solvers.solver.samples import read_rows

STEPS = 30


@pytest.mark.parametrize("problem, changes", [
    ("ring", {"cells": 12, "amplitude": 0.1}), ("vortex", {"cells": 16, "ppc": 2, "amplitude": 0.5})])
def test_what_a_step_adds_up(problem, changes):
    """Work is the force by how far a particle goes at the velocity in the middle of the step, (x' - x) - dt (v' - v)/2;
    the torque's impulse dt (x f_y - y f_x), before the step; crossings are of lines in x and in y. Step by step."""
    kind, reference = PROBLEMS[problem].scene, PROBLEMS[problem].reference
    spin = kind.OWN_EFFECTS == ("spin",)
    scene = kind(**changes, cfl=0.3, periods=0.3, estimators=(), effects=("energy", "crossings", *["spin"] * spin))
    solver, corner = build(scene), reference.grid_corner(scene)
    sums = {"work": [0.0], "crossings": [0.0], "spin/torque": [0.0]}
    before, mass = solver.snapshot(), np.array(solver._arrays.mass)
    lines = np.zeros(2)
    rows = [solver.measure()]
    for _ in range(STEPS):
        force = mass[:, None] * reference.body_force(scene, before.material_position, solver.time)
        solver.advance(1)
        after, dt = solver.snapshot(), scene.time_step
        way = after.position - before.position - 0.5 * dt * (after.velocity - before.velocity)
        cells = [np.floor((shot.position - corner) / scene.spacing) for shot in (before, after)]
        crossed = np.abs(cells[1] - cells[0]).sum(axis=0)
        x, y = before.position.T
        lines += crossed
        sums["work"].append(sums["work"][-1] + np.sum(force * way))
        sums["crossings"].append(sums["crossings"][-1] + crossed.sum())
        sums["spin/torque"].append(sums["spin/torque"][-1] + dt * np.sum(x * force[:, 1] - y * force[:, 0]))
        rows.append(solver.measure())
        before = after
    found = read_rows(np.concatenate(rows), scene, len(mass), 1.0)
    for name in ("work", "crossings", *["spin/torque"] * spin):
        expected = np.array(sums[name])
        assert np.abs(expected).max() > 0
        np.testing.assert_allclose(found[name], expected, rtol=0, atol=1e-9 * np.abs(expected).max())
    assert lines.min() > 0
