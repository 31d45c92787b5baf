"""The check of particles of any run: a smooth motion in one to three dimensions, each thing that may be wrong, and runs
of ours drawn at random, of which ``assets/check.md`` says what it finds of several hundred."""

import json
from dataclasses import replace
from itertools import islice

import numpy as np
import pytest

from solvers.judging.check import CONSISTENT, MotionCheckResult, check
from solvers.judging.findings.deformation import GAP
from solvers.judging.findings.finding import BROKEN, HOLDS, SUSPICIOUS, UNKNOWN, Finding
from solvers.problems.bar.scene import BarScene
from solvers.problems.vortex import VortexScene
from solvers.untrusted.quoting import FileError
from tests.findings import LOST, checked
from tests.support.faults import as_files, record, rounded, scene_of
from tests.support.known_runs import judge_known_run, known_runs

T, SIDE = 21, {1: 40, 2: 12, 3: 6}


def motion(dimensions: int = 2, amplitude: float = 0.15) -> dict[str, np.ndarray]:
    """A lattice that swings smoothly, known exactly: u = A sin(pi X_k) sin(2 pi t) in each direction k, sheared."""
    axes = [(np.arange(SIDE[dimensions]) + 0.5) / SIDE[dimensions]] * dimensions
    X = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, dimensions)
    t = np.linspace(0, 1, T)
    shear = np.eye(dimensions) + 0.3 * np.eye(dimensions, k=1)
    shape, slope = np.sin(np.pi * X) @ shear.T, np.pi * np.cos(np.pi * X)[:, None, :] * shear
    swing, speed = np.sin(2 * np.pi * t), 2 * np.pi * np.cos(2 * np.pi * t)
    return {"t": t, "X": X, "id": np.arange(len(X)), "x": X + amplitude * swing[:, None, None] * shape,
            "v": amplitude * speed[:, None, None] * shape,
            "F": np.eye(dimensions) + amplitude * swing[:, None, None, None] * slope}


def found(arrays, verdict=None):
    """What is wrong, by name."""
    told = check(arrays)
    assert verdict is None or told.verdict == verdict, [one.to_dict() for one in told.contradictions]
    return {one.name: one for one in told.contradictions}


def test_a_rough_f_excuses_a_third_of_what_it_departs():
    """That is the least by which the rule between two points can be off: 1/3 of noise of F times a spacing."""
    arrays = motion(1)
    noise = np.random.default_rng(5).normal(0, 0.2, arrays["F"].shape)
    smooth, rough = (check({**arrays, "F": F}) for F in (arrays["F"], arrays["F"] + noise))
    limits = [one.limit for told in (smooth, rough) for one in told.findings if one.name == GAP]
    excuse = 0.2 * smooth.motion.spacing / smooth.motion.amplitude / 3
    assert limits[1] - limits[0] == pytest.approx(excuse, rel=0.3)  # the noise of one moment


@pytest.mark.parametrize("dimensions", [1, 2, 3])
@pytest.mark.parametrize("left_out", [(), ("F",), ("v",), ("X",), ("id",), ("X", "id", "F", "v")])
def test_a_smooth_motion_has_no_contradiction_whatever_the_files_have_of_it(dimensions, left_out):
    arrays = {key: value for key, value in motion(dimensions).items() if key not in left_out}
    whole = check(arrays)
    assert whole.verdict == CONSISTENT and whole.motion.dimensions == dimensions
    told = {one.name: one.verdict for one in whole.findings}
    assert (told["F against the gradient of x"] == UNKNOWN) == ("F" in left_out)
    assert (told["v against dx/dt"] == UNKNOWN) == ("v" in left_out)
    assert set(told.values()) <= {HOLDS, UNKNOWN}


def superposed(arrays, angle, distance):
    """The motion seen from a frame that turns by an angle and flies a distance, in a unit of time."""
    t, x, v = arrays["t"], arrays["x"], arrays["v"]
    cos, sin = np.cos(angle * t), np.sin(angle * t)
    turn, rate = (np.moveaxis(np.array([[a, -b], [b, a]]), 2, 0) for a, b in ((cos, sin), (-angle * sin, angle * cos)))
    moved = {"x": x @ turn.mT + distance * t[:, None, None], "v": v @ turn.mT + x @ rate.mT + distance}
    return arrays | moved | {"F": turn[:, None] @ arrays["F"]}


@pytest.mark.parametrize("amplitude", [0.15, 1e-4, 0.0])
@pytest.mark.parametrize(("angle", "distance"), [(0.0, 100.0), (2.0, 0.0), (-0.3, 3.0)])
def test_a_body_may_fly_and_turn_however_little_else_it_does(amplitude, angle, distance):
    assert check(superposed(motion(2, amplitude), angle, distance)).verdict == CONSISTENT


@pytest.mark.parametrize("amplitude", [0.15, 0.01, 0.0])
def test_a_body_may_be_strained_before_its_motion_begins(amplitude):
    """Evenly, and each particle by itself: F then counts from another state than X, and a note says so."""
    arrays = motion(2, amplitude)
    for stretch in (np.diag([1.1, 0.95]), np.eye(2) + 0.05 * np.random.default_rng(2).normal(size=(144, 2, 2))):
        strained = check(arrays | {"F": arrays["F"] @ stretch})
        assert strained.verdict == CONSISTENT
        assert "F counts from another state than X" in " ".join(strained.motion.notes)
        assert strained.to_dict()["reference"] == "the first moment"
    assert not check(arrays).motion.notes


def test_a_patch_test_of_ours_is_consistent_and_a_wrong_particle_in_it_is_not():
    run = record(scene_of("bar", motion="patch", stretch=1.3, initial_velocity=0.2, cells=8))
    arrays = as_files(run.scene, run.frames[::10], stress=True)
    assert not found(arrays, CONSISTENT)
    arrays["x"][9:, 5] += 0.02
    assert found(arrays)


@pytest.mark.parametrize("scene", [
    {"motion": "patch", "stretch": 1.00013, "cells": 8}, {"amplitude": 2e-5, "cells": 20, "periods": 0.5}], ids=str)
@pytest.mark.parametrize("form", [lambda arrays: rounded(arrays, 5), lambda arrays: rounded(arrays, 6),
                                  lambda arrays: {key: np.round(values, 5) for key, values in arrays.items()}],
                         ids=["5 figures", "6 figures", "5 decimals"])
def test_few_figures_of_a_small_motion_contradict_nothing(scene, form):
    """Neighbours may differ by less than rounding where its sum over the body does not, and v move them by less."""
    run = record(scene_of("bar", **scene))
    assert not found(form(as_files(run.scene, run.frames[::10], stress=True)), CONSISTENT)


HATS = BarScene(method="mpm", remedies=("frozen-weights",), estimators=(), effects=("truth", "soundness"))


@pytest.mark.parametrize("scene", [
    replace(HATS, cells=12, ppc=5, amplitude=0.1246860700628296, cfl=0.4552442766397108, periods=34.23765806307067),
    replace(HATS, cells=10, ppc=1, amplitude=0.0012, cfl=0.22, periods=0.166),
    VortexScene(method="cpdi", cells=31, amplitude=0.00858, cfl=0.1188, periods=0.0556, poisson_ratio=0.47,
                frequency=0.2754, estimators=(), effects=("truth", "soundness"))],
    ids=["moments a turn apart", "ten particles", "steady velocities"])
def test_motions_of_which_the_files_tell_little_contradict_nothing(scene):
    """A whole turn of the motion looks like none, so that a shorter last interval alone seems to have another unit.
    Hats leave F where the velocity is largest, where few neighbours are no measure of what x deforms there. And a lag
    of velocities that hardly change is any difference."""
    run = judge_known_run(scene)
    assert run.good and not found(run.particles, CONSISTENT)


def changed(key, change, dimensions=2):
    arrays = motion(dimensions)
    return arrays | {key: change(arrays[key].copy())}


def stuck(values):
    values[:, 77] = values[0, 77]
    return values


def apart(x):
    x[-1] += 0.05 * np.where(np.arange(x.shape[1]) % 2, 1, -1)[:, None]
    return x


def freeze(F):
    F[8:, 13:16] = F[8, 13:16]  # where the body deforms as much as most of it
    return F


def exchange_moments(one, other, where=None):
    """The moments ``one`` and ``other`` exchanged, or ``one`` written ``where`` another one was."""
    def put(values):
        values[[one, other] if where is None else [where]] = values[[other, one] if where is None else [one]]
        return values
    return put


def last(value):
    def put(values):
        values[-1, 7] = value
        return values
    return put


@pytest.mark.parametrize("key, change, name, verdict", [
    ("x", last(np.nan), "all numbers are finite", BROKEN),
    ("x", stuck, "x of each particle against its neighbours'", SUSPICIOUS),
    ("x", apart, "F against where neighbours stand", BROKEN),
    ("x", lambda x: 1000 * x, "F against the gradient of x", SUSPICIOUS),
    ("x", lambda x: x - motion()["X"], "F against the gradient of x", SUSPICIOUS),
    ("x", lambda x: x + np.linspace(0, 1e-3, T)[:, None, None], "the middle against the mean of v", SUSPICIOUS),
    ("x", lambda x: x[:, np.random.default_rng(0).permutation(x.shape[1])], "neighbours keep their order", BROKEN),
    ("F", last(np.diag([1.0, -1.0])), "det F is positive", BROKEN),
    ("F", last(0.0002 * np.eye(2)), "det F is positive", SUSPICIOUS),
    ("F", lambda F: F - np.eye(2), "F against the gradient of x", SUSPICIOUS),
    ("F", lambda F: np.linalg.inv(F), "F against the gradient of x", SUSPICIOUS),
    ("x", exchange_moments(10, 12), "intervals between moments against v", BROKEN),
    ("x", exchange_moments(10, 10, 11), "every moment is another one", BROKEN),
    ("t", lambda t: np.where(t > 0.5, 1000 * t, t), "intervals between moments against v", BROKEN),
    ("t", lambda t: np.where(t > 0.5, 0.5 + 2 * (t - 0.5), t), "intervals between moments against v", BROKEN),
    ("F", freeze, "F changes where the body deforms", SUSPICIOUS),
    ("v", lambda v: v / 1000, "v against dx/dt", BROKEN),
    ("v", lambda v: -v, "v against dx/dt", BROKEN),
    ("v", lambda v: np.roll(v, 1, axis=0), "moment of v before that of x", SUSPICIOUS),
    ("v", lambda v: np.where(np.arange(v.shape[1])[:, None] == 40, 0, v), "v of each particle against its neighbours'",
     SUSPICIOUS)])
def test_what_is_wrong_is_found_and_named(key, change, name, verdict):
    wrong = found(changed(key, change))
    assert wrong[name].says and wrong[name].verdict == verdict


def test_particles_that_overtake_along_a_line_are_seen_without_anything_else():
    arrays = {key: value for key, value in motion(1).items() if key in ("t", "x", "id")}
    arrays["x"][-1, [10, 11]] = arrays["x"][-1, [11, 10]]
    wrong = found(arrays)["neighbours keep their order"]
    assert wrong.time == 1.0 and wrong.particle in (10, 11)


def test_particles_that_come_and_go_or_are_there_twice_are_told():
    arrays = motion()
    rows = {key: np.concatenate(list(arrays[key])) for key in ("x", "v")}
    rows |= {"t": np.repeat(arrays["t"], 144), "id": np.tile(arrays["id"], T), "X": np.tile(arrays["X"], (T, 1))}
    gone = {key: value[:-3] for key, value in rows.items()}
    assert found(gone, SUSPICIOUS)["each particle is there once at every moment"].measured == 3
    rows["id"][-1] = 5
    assert found(rows, BROKEN)["each particle is there once at every moment"].particle == 5


def test_moments_that_are_too_far_apart_tell_nothing_of_v():
    arrays = {key: value[::7] if key in ("t", "x", "v", "F") else value for key, value in motion().items()}
    told = {one.name: one for one in check(arrays).findings}
    assert told["v against dx/dt"].verdict == UNKNOWN and "too far apart" in told["v against dx/dt"].says


def test_a_flat_body_in_space_is_looked_at_in_its_plane():
    arrays = motion()
    arrays["x"] = np.pad(arrays["x"], ((0, 0), (0, 0), (0, 1)))
    arrays["X"] = np.pad(arrays["X"], ((0, 0), (0, 1)))
    flat = check(arrays)
    assert flat.motion.dimensions == 2 and flat.verdict == CONSISTENT


@pytest.mark.parametrize("arrays, says", [
    ({"t": np.array([0.0]), "x": np.zeros((1, 5, 2))}, "two or more"),
    ([{"t": 0.0, "x": np.zeros((5, 2))}, {"t": 0.0, "x": np.ones((5, 2))}], "has the time 0 s, which"),
    ([{"t": 0.0, "x": np.zeros((5, 2))}, {"t": 1.0, "x": np.zeros((6, 2))}], "give id or X"),
    ([{"t": 0.0, "x": np.zeros((5, 2))}, {"t": 1.0, "x": np.zeros((5, 3))}], "another number of directions"),
    ([{"t": 0.0, "x": np.zeros((5, 2)), "cells": np.array(k)} for k in (8, 9)], "another grid"),
    ({"t": 0.0, "v": np.zeros((5, 2))}, "no positions"),
    ({"t": np.array([0.0, 1.0]), "x": np.full((2, 5, 2), np.nan)}, "fewer than two moments")])
def test_what_cannot_be_followed_is_refused(arrays, says):
    with pytest.raises(FileError, match=says):
        check(arrays)


FEWEST = 40  # particles; fewer have next to no inside
#: Kinds of evidence that lie within the particles, of which the check has rules of its own.
WITHIN = ("neighbour_gap", "displacement_mismatch", "unstable")


@pytest.mark.parametrize(("problem", "count"), [
    ("bar", 7), ("ring", 3),
    *(pytest.param(problem, 50, marks=pytest.mark.slow) for problem in ("bar", "ring", "vortex"))])
def test_good_runs_raise_no_alarm_and_broken_ones_are_found(problem, count):
    found = [(run, *checked(run.particles)[:2]) for run in islice(known_runs(problem, 21), count)]
    alarms = [(run.scene, names) for run, verdict, names in found if run.good and verdict != CONSISTENT]
    assert not alarms
    broken = [verdict for run, verdict, _ in found if run.label in WITHIN and len(run.particles["X"]) >= FEWEST]
    seen = sum(verdict != CONSISTENT for verdict in broken)
    # Of the vortex a third of the unstable runs ends where a particle has left the body, which only the problem knows.
    assert seen >= (0.5 if problem == "vortex" else 0.8) * len(broken)
    assert count < 50 or sum(run.label in LOST for run, *_ in found) > 3


def test_what_cannot_be_is_told_before_what_should_not():
    found = [Finding(verdict, verdict) for verdict in (HOLDS, SUSPICIOUS, BROKEN, UNKNOWN, SUSPICIOUS)]
    result = MotionCheckResult((), None, found, ())
    assert [one.verdict for one in result.contradictions] == [BROKEN, SUSPICIOUS, SUSPICIOUS]
    assert result.verdict == BROKEN


def test_particles_without_neighbours_have_no_distance_and_are_json_all_the_same():
    times, place = np.linspace(0, 1, 5), np.zeros((3, 1))
    found = check({"t": times, "id": np.arange(3), "X": place, "x": place + 0.1 * times[:, None, None]}).to_dict()
    assert found["spacing"] is None and json.loads(json.dumps(found, allow_nan=False))["particles"] == 3
