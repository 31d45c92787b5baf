"""How much of the body the particles in files stand for, by masses, by our lattice and by another code's."""

import numpy as np
import pytest

from solvers.judging import problem_handout
from solvers.judging.findings.finding import HOLDS, OFF
from solvers.problems import PROBLEMS
from tests.findings import judgement
from tests.support.faults import ALL


def share_of(scene, **arrays) -> dict:
    checks = judgement(scene, {"cells": np.array(scene.cells), **arrays}).checks
    return next(check for check in checks if check.name.startswith("part of the body")).to_dict()


@pytest.mark.parametrize("scene", [*(PROBLEMS[problem].scene(cells=12) for problem in ALL),
                                   PROBLEMS["bar"].scene(cells=12, motion="patch", stretch=1.3)],
                         ids=[*ALL, "patch"])
@pytest.mark.parametrize("name", ["mass", "volume"])
def test_masses_or_volumes_say_how_much_of_the_body_there_is(scene, name):
    """Of one that begins stretched, too, whose mass is that of what was stretched."""
    frame = problem_handout.exact_frame(scene, 0.3 * scene.period)
    weight = problem_handout.particle_masses(scene) if name == "mass" else problem_handout.start(scene).volume
    for chosen in (slice(None), slice(None, None, 2)):
        share = float(weight[chosen].sum() / weight.sum())
        found = share_of(scene, t=np.array(frame.time), X=frame.material_position[chosen], x=frame.position[chosen],
                         **{name: weight[chosen]})
        assert found["measured"] == pytest.approx(1 - share, abs=1e-9) and (found["verdict"] == HOLDS) == (share == 1)


@pytest.mark.parametrize("ours", [True, False], ids=["our lattice", "another"])
@pytest.mark.parametrize("problem", ALL)
def test_a_hole_of_three_particles_is_told_though_masses_miss_little(problem, ours):
    """Of hundreds or thousands, so that less than 2 % of the mass is missing; a lattice without the hole is whole."""
    scene = PROBLEMS[problem].scene(cells=60 if problem == "bar" else 30, ppc=3)
    X = problem_handout.start(scene).material_position if ours else foreign_lattice(scene)
    middle = X[len(X) // 2] if scene.DIMENSIONS == 1 else (0.5 * (scene.INNER + scene.OUTER), 0.1)
    near, t = np.argsort(np.linalg.norm(X - middle, axis=1)), 0.3 * scene.period
    size = problem_handout.start(scene).volume.sum() / len(X)
    for chosen, verdict in ((near, HOLDS), (near[3:], OFF)):
        x = X[chosen] + PROBLEMS[problem].reference.displacement(scene, X[chosen], t)
        assert 3 / len(X) < 0.02 and share_of(scene, t=np.array(t), X=X[chosen], x=x, volume=np.full(
            len(chosen), size))["verdict"] == verdict


def test_codes_may_differ_in_the_places_at_a_staircase_rim():
    """With fewer of them by another rule nothing is missing from the body; a place inside is."""
    scene = PROBLEMS["ring"].scene(cells=30, layout="cartesian")
    X = problem_handout.start(scene).material_position
    R, t = np.linalg.norm(X, axis=1), 0.3 * scene.period
    fewer = X[R < scene.OUTER - 0.2 * scene.spacing]
    middle = np.argmin(np.abs(R - 0.5 * (scene.INNER + scene.OUTER)))
    assert 0 < len(X) - len(fewer) < 0.1 * len(X)
    for places, verdict in ((fewer, HOLDS), (np.delete(X, middle, axis=0), OFF)):
        x = places + PROBLEMS["ring"].reference.displacement(scene, places, t)
        assert share_of(scene, t=np.array(t), X=places, x=x)["verdict"] == verdict


def foreign_lattice(scene) -> np.ndarray:
    """The places (P, D) within the body of a square lattice that is none of ours."""
    line = np.arange(-1.6, 1.6, 0.37 * scene.spacing) + 0.011
    X = line[:, None] if scene.DIMENSIONS == 1 else np.stack([a.ravel() for a in np.meshgrid(line, line)], axis=1)
    return X[~PROBLEMS[scene.problem].reference.is_outside(scene, X)]


@pytest.mark.parametrize("problem", ALL)
def test_another_codes_places_are_all_of_the_body_or_have_holes(problem):
    """A lattice that is none of ours, all of it, without a part, and without some of it by chance; and places by
    chance, which have no lattice but are everywhere."""
    scene = PROBLEMS[problem].scene(cells=24)
    reference, D, X = PROBLEMS[problem].reference, scene.DIMENSIONS, foreign_lattice(scene)
    chance, start = np.random.default_rng(5).uniform(size=len(X)), problem_handout.start(scene).material_position
    low, high = start.min(axis=0), start.max(axis=0)
    anywhere = low + np.random.default_rng(4).uniform(size=(40_000, D)) * (high - low)
    anywhere = anywhere[~reference.is_outside(scene, anywhere)][:2000]
    for points, share in ((X, 1.0), (anywhere, 1.0), (X[X[:, 0] < np.quantile(X[:, 0], 0.8)], 0.8),
                          (X[chance < 0.6], 0.6)):
        t = 0.3 * scene.period
        found = share_of(scene, t=np.array(t), X=points, x=points + reference.displacement(scene, points, t))
        assert (found["verdict"] == HOLDS) == (share == 1) and found["measured"] == pytest.approx(1 - share, abs=0.1)
