"""What is compared beside errors: what each finding finds, from the start on, and what it leaves alone."""

import functools
import json
from dataclasses import replace

import numpy as np
import pytest

from app.cli import main
from solvers.judging import problem_handout
from solvers.judging.error_norms import summarise_norms
from solvers.judging.findings.finding import HOLDS, OFF, UNKNOWN
from solvers.judging.findings.findings_input import DOUBLE, SINGLE, detect_precision
from solvers.judging.findings.neighbour_comparison import find_neighbours, find_outliers
from solvers.judging.findings.outliers import NAMES
from solvers.judging.findings.time_series_fitting import interpolate_before, jackknife_least_squares, time_derivative
from solvers.judging.judgement import judge
from solvers.problems import PROBLEMS
from tests.findings import FORMS, checked, drawn, honest, judged, judgement
from tests.support.faults import ALL, ALTERATIONS, as_files, files, record, scene_of
from tests.support.faults_in_time import IN_TIME

#: What is said of each alteration, in words that no other cause has; None where nothing can be told, which is right.
SAID = {
    "nothing": None, "nothing; stress too": None, "nothing; stress too, single precision": None,
    "nothing; stress too, seven figures": None, "v half a step late": "the velocities are of a moment",
    "F a step late": "F or the stress is of a moment", "stress a step late beside F": "belong to different moments",
    "x shuffled": "in another order", "two particles swapped": 2, "two neighbours swapped": 2,
    "E 1.01 times": "faster than its times imply", "E 1.01 times, its stress too": "it fits E = ",
    "Poisson's ratio 0.25, its stress too": "it fits Poisson's ratio 0.25",
    "one mass doubled": "a force or mass is not symmetric",
    "one mass doubled, masses in the file": "the mass of 1 particle differs from", "one particle stuck": 1,
    "one particle with v = 0": "the velocity of 1 particle differs from",
    "one particle with F = 1": "the stress (or F) of 1 particle differs from",
    "x drifts by 1e-3 of the motion": "off on average", "x drifts by 1e-2 of the motion": "off on average",
    "a tenth missing, with ids": "particles cover", "every second missing, without ids": "of the body (",
    "half missing by chance, without ids": "of the body (",
    "three neighbours missing, masses in the file": "3 of the", "F transposed": "F seems to be transposed",
    "times 1 % too long": "slower than its times imply",
    "x and y of positions exchanged": "x and y of the positions seem to be exchanged",
    "x and y of everything exchanged": "x and y of everything seem to be exchanged"}
#: What cannot be told there: the errors of the method are larger, or F is symmetric.
HIDDEN = {("vortex", "v half a step late"), ("vortex", "F a step late"), ("vortex", "times 1 % too long"),
          ("vortex", "E 1.01 times"), ("ring", "F transposed")}
#: Beside those of the bar, what the usual suite has: what needs a second direction, or looks at it otherwise.
QUICK = {("ring", name) for name in (
    "nothing; stress too, seven figures", "one mass doubled, masses in the file", "one particle with F = 1",
    "x drifts by 1e-3 of the motion", "x and y of positions exchanged", "two neighbours swapped",
    "half missing by chance, without ids")} | {
    ("vortex", name) for name in (
        "F transposed", "x and y of everything exchanged", "Poisson's ratio 0.25, its stress too")}
run_of = functools.cache(lambda problem: record(scene_of(problem)))


@pytest.mark.parametrize(("problem", "name"), [
    pytest.param(problem, name, marks=() if problem == "bar" or (problem, name) in QUICK else pytest.mark.slow)
    for problem in ALL for name in SAID if problem in ALTERATIONS[name][0]])
def test_what_is_wrong_with_a_file_is_told(problem, name):
    """Each alteration by its own words, and no sentence about another cause: at most the one with it."""
    run = run_of(problem)
    found, wanted = judged(run.scene, ALTERATIONS[name][1](run)), SAID[name]
    notes = [note for note in found.notes if "moved back by a period" not in note]
    if wanted is None or (problem, name) in HIDDEN:
        assert not notes and not found.by_themselves
    elif isinstance(wanted, int):
        assert not notes and found.by_themselves == wanted
    else:
        assert any(wanted in note for note in notes) and not found.by_themselves
        beside = {"stress a step late beside F", "one mass doubled, masses in the file", "E 1.01 times, its stress too",
                  "one particle with F = 1"}
        assert len(notes) == 1 or (name in beside and len(notes) == 2)
        assert "another material" not in " ".join(notes)


def test_a_stress_that_is_off_where_no_particle_is_followed_is_another_one():
    """Of large bodies every second particle is followed, in order of position; these explain nothing then."""
    run = run_of("vortex")
    arrays = files(run, stress=True)
    arrays["sigma"][:, np.lexsort(arrays["X"].T)[1::2]] *= 1.5
    assert any("off what their F gives by the problem's law" in note for note in judged(run.scene, arrays).notes)


#: What the judge says, and of what the check speaks, of what goes wrong on the way.
IN_TIME_SAID = {
    "two frames exchanged": ("frames are exchanged", "intervals between moments against v"),
    "a frame written twice": ("one moment was written twice", "every moment is another one"),
    "a frame missing, times renumbered": ("repeated or missing", "intervals between moments against v"),
    "times doubled from half on": ("times are in another unit", "intervals between moments against v"),
    "v with the other sign": ("the other sign", "v against dx/dt"),
    "F of ten neighbours frozen": ("stays the same to the last bit", "F changes where the body deforms"),
    "stress of ten neighbours frozen": ("stays the same to the last bit", "the stress changes where the body deforms"),
    "x damped to 95 %": ("one of them is damped on the way", None),
    "rows permuted from half on": ("in another order", "neighbours keep their order"),
    "stress in kPa from half on, without F": ("in another unit", None),
    "one volume doubled, volumes in the file": ("the volume of 1 particle differs", None)}
#: Where the errors of the method are larger; times in ms are refused, as of a run that is too long.
TOO_ROUGH = {("vortex", name) for name in ("a frame missing, times renumbered", "x damped to 95 %",
                                           "stress in kPa from half on, without F")}


@pytest.mark.parametrize(("problem", "name"), [
    pytest.param(problem, name, marks=() if problem == "bar" else pytest.mark.slow)
    for problem in ALL for name in IN_TIME_SAID])
def test_what_goes_wrong_on_the_way_is_told_by_the_judge_and_the_check(problem, name):
    run, (wanted, finding) = run_of(problem), IN_TIME_SAID[name]
    arrays = IN_TIME[name][1](run)
    notes, names = judged(run.scene, arrays).notes, checked(arrays)[1]
    assert any(wanted in note for note in notes) != ((problem, name) in TOO_ROUGH)
    assert finding in names or finding is None or problem == "vortex"


@pytest.mark.parametrize("count", [2, pytest.param(60, marks=pytest.mark.slow)])
def test_sound_runs_are_left_alone_in_every_form(count):
    scenes = drawn(28)
    runs = [(scene, arrays) for scene, _ in zip(scenes, range(count), strict=False)
            if (arrays := honest(scene)) is not None]
    assert len(runs) > 0.7 * count
    for scene, arrays in runs:
        for form, made in FORMS.items():
            assert not judged(scene, made(arrays)).told, (scene, form)


def test_no_particle_at_the_rim_of_a_cartesian_ring_is_blamed():
    """There all neighbours are on one side, and the plane through them goes on beyond."""
    scene = PROBLEMS["ring"].scene(method="cpgimp", cells=32, ppc=3, amplitude=0.08, layout="cartesian", estimators=(),
                                   effects=())
    arrays = honest(scene)
    assert arrays is not None and not judged(scene, arrays).told


def test_a_free_vibration_in_less_than_a_turn_is_no_other_size():
    """Its frequency is another, so that in half a turn it looks like another size by x than by v."""
    scene = PROBLEMS["vortex"].scene(method="cpdi", cells=25, ppc=4, amplitude=0.25, cfl=0.104, periods=0.546,
                                     estimators=(), effects=())
    arrays = honest(scene)
    assert arrays is not None and not judged(scene, arrays).told


def test_the_list_says_what_was_compared_whatever_came_of_it(tmp_path):
    """In JSON, Markdown and HTML; of a file without velocities and stresses that these cannot be told."""
    scene = PROBLEMS["bar"].scene(cells=12)
    half = {key: values[:, ::2] if key == "x" else values[::2] if key == "X" else values
            for key, values in exact_files(scene, np.linspace(0.1, 0.9, 9)).items() if key in ("t", "cells", "X", "x")}
    np.savez(tmp_path / "half.npz", **half)
    assert main(["judge", "bar", str(tmp_path / "half.npz"), "--no-compare", "--quiet", "--out",
                 str(tmp_path / "out")]) == 0
    [grid] = json.loads((tmp_path / "out" / "report.json").read_text())["grids"]
    checks = {check["check"]: check for check in grid["checks"]}
    assert len(checks) == len(grid["checks"])
    assert {check["verdict"] for check in grid["checks"]} == {HOLDS, OFF, UNKNOWN}
    share = checks["part of the body that no particle stands for"]
    assert share["verdict"] == OFF and share["measured"] == pytest.approx(0.5) and share["tolerance"] < 0.02
    assert share["says"] in grid["notes"] and "the norms are over these alone" in share["says"]
    assert checks[NAMES["v"]]["verdict"] == UNKNOWN and checks[NAMES["x"]]["verdict"] == HOLDS
    for form in ("report.md", "report.html"):
        text = (tmp_path / "out" / form).read_text()
        assert all(name.replace("'", "&#x27;") in text or name in text or name.replace("'", "’") in text
                   for name in checks), form
        assert "cover 50 % of the body" in text


def exact_files(scene, parts) -> dict[str, np.ndarray]:
    """The exact particles at parts of a period, with everything that a file may have."""
    return as_files(scene, [problem_handout.exact_frame(scene, part * scene.period) for part in parts])


def test_a_run_says_its_step_and_velocities_half_a_step_early_are_its_own(tmp_path):
    """With steps six times the usual ones: of the scene's it would be three steps."""
    file = tmp_path / "run.npz"
    assert main(["run", "bar", "--cells", "20", "--cfl", "0.3", "--periods", "1", "--particles", str(file), "--quiet",
                 "--estimator", "none"]) == 0
    [grid] = judge(PROBLEMS["bar"].scene(), str(file)).to_dict()["grids"]
    [moment] = [check for check in grid["checks"] if "moment of the velocities" in check["check"]]
    assert grid["notes"] == [] and moment["verdict"] == HOLDS and moment["measured"] == pytest.approx(0.5, abs=0.05)


def test_figures_are_found_from_the_numbers():
    values = np.random.default_rng(1).normal(size=3000) * 10.0 ** np.random.default_rng(2).integers(-3, 3, 3000)
    assert (
        detect_precision(values).relative == DOUBLE
        and detect_precision(values[:5]).words == detect_precision(np.ones(1000)).words == "double precision"
    )
    assert detect_precision(values.astype(np.float32).astype(float)) == replace(
        detect_precision(values), relative=SINGLE, words="single precision"
    )
    for figures in (4, 7, 10):
        cut = np.array([float(f"{value:.{figures - 1}e}") for value in values])
        found = detect_precision(cut)
        assert found.words == f"{figures} figures"
        assert (np.abs(cut - values) <= found.rounding(cut) * (1 + 1e-9)).all()
    assert detect_precision(np.array([1.00132, 0.00528])).words == "6 figures"  # few numbers: of an even strain
    assert detect_precision(np.array([0.125, 0.375])).words == "double precision"  # and of an even lattice
    assert detect_precision(np.float32([1.00132]).astype(float)).relative == SINGLE
    fixed = np.round(values, 5)
    assert (np.abs(fixed - values) <= detect_precision(fixed).rounding(fixed) * (1 + 1e-9)).all()


def test_one_that_is_off_blames_none_of_its_neighbours():
    """Whatever its place: in the middle, at a rim, and two of them side by side."""
    line = (np.arange(20) + 0.5) / 20
    X = np.stack([a.ravel() for a in np.meshgrid(line, line)], axis=1)
    smooth = np.stack([np.sin(3 * X[:, 0]) * X[:, 1], np.cos(2 * X[:, 1])], axis=1)
    near = find_neighbours(X)
    for off in ([210], [0], [19], [210, 211]):
        values = smooth.copy()
        values[off] += [5.0, 0.0]
        assert find_outliers(near, values, 12.0, 0.01)[0].tolist() == off
    assert not len(find_outliers(near, smooth, 12.0, 0.01)[0])
    assert find_neighbours(X[:3]) is None


def test_what_is_between_times_is_of_third_order_and_rates_of_second():
    def worst(count: int) -> tuple[float, float]:
        t = np.linspace(0, 2, count)
        values = np.sin(3 * t)[:, None]
        inside, moved = interpolate_before(t, values, 0.013)
        return (float(np.abs(moved[:, 0] - np.sin(3 * (t[inside] - 0.013))).max()),
                float(np.abs(time_derivative(t, values)[:, 0] - 3 * np.cos(3 * t)).max()))

    (between, slope), (finer, slope_finer) = worst(41), worst(81)
    assert np.log2(slope / slope_finer) == pytest.approx(2, abs=0.2) and between > 3 * finer


def test_a_fit_finds_its_parts_and_how_sure_they_are():
    chance = np.random.default_rng(6)
    one, other, noise = (chance.normal(size=(200, 7)) for _ in range(3))
    found, sure = jackknife_least_squares(2 * one - 3 * other + 0.5 * noise, [one, other])
    assert found[0] == pytest.approx([2, -3], abs=4 * 0.5 / np.sqrt(1400))
    assert (sure < 2.5 * 0.5 / np.sqrt(1400)).all() and (sure > 0.3 * 0.5 / np.sqrt(1400)).all()


@pytest.mark.parametrize("problem", ALL)
@pytest.mark.parametrize("wild", [0.0, 1e90, *(pytest.param(factor, marks=pytest.mark.slow)
                                              for factor in (-1.0, 1e-310))])
def test_whatever_numbers_a_file_has_every_check_ends_in_one(problem, wild):
    """Factors of F, the stress and v that no material bears, and files of few particles or times."""
    scene = PROBLEMS[problem].scene(cells=12)
    whole = exact_files(scene, np.linspace(0.05, 0.6, 6))
    some = [{key: values if key in ("t", "cells") else values[:n] if key == "X" else values[:, :n]
             for key, values in whole.items()} for n in (1, 5)]
    times = [{key: values if key in ("X", "cells") else values[:n] for key, values in whole.items()} for n in (1, 4)]
    spoilt = [whole | {key: wild * whole[key]} for key in ("v", "F", "sigma")]
    count = len(judgement(scene, whole).checks)
    for arrays in (*some, *times, *spoilt):
        checks = [check.to_dict() for check in judgement(scene, arrays).checks]
        assert len(checks) == count and "nan" not in json.dumps(checks, allow_nan=False)


@pytest.mark.parametrize("form", FORMS)
def test_a_small_motion_in_few_figures_is_no_other_material(form):
    """Where F is 1 to a thousandth, rounding it is much of the stress while that passes through 0."""
    scene = PROBLEMS["bar"].scene(amplitude=2.5e-4, periods=0.6, estimators=(), effects=())
    arrays = honest(scene)
    assert arrays is not None
    assert not judged(scene, FORMS[form](arrays)).told


@pytest.mark.parametrize("particle", [63, 198])
def test_one_that_is_stuck_on_the_ring_is_blamed_alone(particle):
    run = run_of("ring")
    arrays = files(run)
    arrays["x"] = arrays["x"].copy()
    arrays["x"][:, particle] = arrays["X"][particle]
    found = judgement(run.scene, arrays)
    assert (
        found.position_outliers is not None
        and found.position_outliers.which.tolist() == [particle]
        and not found.notes()
    )


CELLS = {"bar": 20, "ring": 12, "vortex": 16}


def at_the_start(problem):
    """The particles of a problem before anything has moved, and its scene."""
    scene = PROBLEMS[problem].scene(cells=CELLS[problem])
    frame = problem_handout.initial_frame(scene)
    return scene, {"t": np.array(0.0), "cells": np.array(scene.cells), "X": frame.material_position,
                   "x": frame.position, "v": frame.velocity}


@pytest.mark.parametrize("problem", CELLS)
@pytest.mark.parametrize("key, change, words", [
    ("x", lambda a: a["x"], None), ("x", lambda a: a["x"] - a["X"], "x seems to be the displacement"),
    ("x", lambda a: a["x"][np.random.default_rng(0).permutation(len(a["x"]))], "are permuted"),
    ("x", lambda a: 1000 * a["x"], "off the initial positions of the"),
    ("v", lambda a: 1.2 * a["v"], "it is 1.2 times that")])
def test_what_is_wrong_shows_at_the_start_which_is_no_pass(problem, key, change, words):
    scene, arrays = at_the_start(problem)
    found = judgement(scene, arrays | {key: change(arrays)})
    told = [check.says for check in found.checks if check.verdict == OFF]
    assert any(words in one for one in told) if words else not told
    if problem == "ring" and words == "off the initial positions of the":  # the others' bodies are periodic, or
        assert any("another unit" in one or "in mm" in one for one in told)
    error = summarise_norms(found.grid.times, found.norms)
    assert all(error[q]["max"] is None for q in ("x", "v", "sigma"))  # whatever it is, nothing was computed
