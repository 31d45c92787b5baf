"""Nothing broken is called ok: contradictions against numpy, strict bounds of the error, and what a verdict says."""

from dataclasses import replace

import numpy as np
import pytest

from solvers.problems.bar.scene import BarScene
from solvers.problems.ring import RingScene
from solvers.running.run import run
from solvers.solver import soundness

LOOKS = ("truth", "soundness")
ONE_EACH = BarScene(ppc=1, estimators=(), effects=LOOKS)


def columns(series, *names):
    return [series[name] for name in names]


@pytest.mark.parametrize("scene", [
    ONE_EACH, replace(ONE_EACH, ppc=4, method="mpm", amplitude=0.1, cfl=0.3, periods=2),
    replace(ONE_EACH, ppc=4, velocity="particle", amplitude=0.05, cfl=0.3, periods=3),
    RingScene(method="ugimp", ppc=1, cells=24, amplitude=0.1, periods=4, cfl=0.3, estimators=(), effects=LOOKS),
    RingScene(method="ugimp", cells=12, amplitude=1e-9, cfl=1.2, estimators=(), effects=())], ids=str)
def test_what_is_broken_is_not_ok(scene, simulate):
    """Settings that ended "ok" with errors of several amplitudes; the ring's last one with a million of them."""
    result = simulate(scene)
    assert result.status in ("lost", "unstable")
    assert f"t = {result.broken_at:.4g} s" in result.reason or result.status == "unstable"
    assert "X = " in result.reason and ";" in result.reason


def test_a_sound_run_has_no_contradiction(simulate):
    """The default runs: every kind of evidence stays below a twentieth of what would condemn."""
    for scene in (BarScene(periods=2, estimators=()), RingScene(estimators=(), cfl=0.3)):
        result = simulate(scene)
        assert (result.status, result.reason, result.broken_at) == ("ok", None, None)
        shown = {name: share for name, share in result.to_dict()["soundness"].items() if share is not None}
        assert shown and max(shown.values()) < 0.02


def test_the_bars_contradictions_are_what_they_say(simulate):
    """The kernel's sums against numpy on the particles: equal to rounding."""
    scene = replace(ONE_EACH, ppc=3, method="mpm", periods=0.73, amplitude=0.05)
    result = simulate(scene)
    shot, P = result.final, scene.particles
    u, F, dX = shot.position - shot.material_position, shot.deformation_gradient, 1 / P
    miss = np.roll(u, -1) - u - dX * (0.5 * (F + np.roll(F, -1)) - 1)
    gap = u[0] + np.concatenate([[0.0], np.cumsum(miss)[:-1]])
    neighbour_gap, mean_drift, mismatch, place = (values[-1] for values in columns(
        result.series, "neighbour_gap", "mean_drift", "displacement_mismatch", "place"))
    assert neighbour_gap == pytest.approx(np.sqrt(np.mean(miss**2)), rel=1e-12)
    assert mean_drift == pytest.approx(abs(u.mean()), abs=1e-15)
    assert mismatch == pytest.approx(gap.std(), rel=1e-9)
    assert place == np.argmax(abs(miss))


@pytest.mark.parametrize("layout", ["polar", "cartesian"])
def test_the_rings_contradictions_are_what_they_say(layout, simulate):
    """Pairs of lattice neighbours found again by their distance; the scatter around material circles by radius."""
    scene = RingScene(method="ugimp", cells=12, layout=layout, periods=0.6, cfl=0.3, estimators=(), effects=LOOKS)
    result = simulate(scene)
    shot, X = result.final, result.final.material_position
    R, angle = np.hypot(*X.T), np.arctan2(X[:, 1], X[:, 0])
    u = shot.position - X
    if layout == "polar":
        lattice = np.round(np.stack([angle / np.min(angle), (R - 0.4) / np.min(R - 0.4)], axis=1)).astype(int) // 2
    else:
        lattice = np.round(X / (0.1 / 2) - 0.5).astype(int)
    number = {tuple(place): p for p, place in enumerate(lattice)}
    misses = []
    for p, (i, j) in enumerate(lattice):
        for q in (number.get((i + 1, j)), number.get((i, j + 1))):
            if q is not None:
                F = 0.5 * (shot.deformation_gradient[p] + shot.deformation_gradient[q])
                misses.append(shot.position[q] - shot.position[p] - F @ (X[q] - X[p]))
    radial = (u * X).sum(axis=1) / R
    hoop = (u[:, 1] * X[:, 0] - u[:, 0] * X[:, 1]) / R
    scatter = sum(((radial[R.round(12) == r] - radial[R.round(12) == r].mean()) ** 2).sum() for r in set(R.round(12)))
    apart, shape = (values[-1] for values in columns(result.series, "neighbour_gap", "out_of_shape"))
    assert apart == pytest.approx(np.sqrt(np.mean(np.sum(np.square(misses), axis=1))), rel=1e-10)
    assert shape == pytest.approx(np.sqrt((np.sum(hoop**2) + scatter) / len(X)), rel=1e-8)


@pytest.mark.parametrize("cells", [4, 7, 8, 40])
def test_few_particles_of_the_exact_bar_are_no_contradiction(cells):
    """What neighbours of the exact motion at its largest miss by, and what half of their F - 1 adds, is what the scene
    allows them beside the rule's share; four of them would be condemned."""
    scene = BarScene(cells=cells, ppc=1, estimators=(), effects=("soundness",))
    X = (np.arange(cells) + 0.5) / cells
    u, F = np.sin(2 * np.pi * X), 2 * np.pi * np.cos(2 * np.pi * X)
    miss = np.roll(u, -1) - u - (F + np.roll(F, -1)) / (2 * cells)
    half_wrong = 0.5 * np.sqrt(np.mean(F**2)) / cells
    assert scene.neighbour_mismatch == pytest.approx(np.sqrt(np.mean(miss**2)) + half_wrong, rel=1e-9)
    result = run(replace(scene, method="ugimp", amplitude=0.0986482, cfl=0.0816778, periods=0.0750638,
                         velocity="particle"))
    assert result.status == "ok"  # four particles: x was off by 0.01, and it was called lost


def test_adrift_and_out_of_shape_are_lower_bounds_of_the_error(simulate):
    """Strict: the exact motion neither drifts nor differs around a circle. Of broken runs and sound ones alike."""
    bar = simulate(replace(ONE_EACH, linearity_preserving=True, ppc=4, amplitude=0.1, cfl=0.3, periods=45))
    assert (np.nan_to_num(bar.series["mean_drift"]) <= bar.series["error_x"] * (1 + 1e-9) + 1e-15).all()
    ring = simulate(RingScene(method="mpm", cells=12, periods=2, cfl=0.3, estimators=(), effects=LOOKS))
    assert (np.nan_to_num(ring.series["out_of_shape"]) <= ring.series["error_x"] * (1 + 1e-9) + 1e-12).all()


@pytest.mark.parametrize("effects", [("truth",), ("soundness",), ("estimate",)])
def test_each_kind_of_evidence_is_enough(effects, simulate):
    """The truth, the contradictions or a valid estimator alone; with nothing that looks, nothing is found."""
    scene = replace(ONE_EACH, effects=effects, estimators=("companion",))
    assert simulate(scene).status == "lost"
    assert simulate(replace(scene, effects=())).status == "ok"


def test_displacements_that_do_not_add_up_are_enough(simulate):
    """A fine bar whose force acts at the nodes, 1.2 amplitudes off: it does not drift, and neighbours are at most .07
    amplitudes apart, a third of what condemns; all along the bar these add up to 2.2."""
    result = simulate(BarScene(method="ugimp", cells=300, ppc=3, amplitude=0.1, body_force="node", cfl=0.2, periods=0.9,
                               estimators=(), effects=("soundness",)))
    shares = result.to_dict()["soundness"]
    assert shares["neighbour_gap"] < 0.1 and shares["mean_drift"] < 0.01 and shares["displacement_mismatch"] > 1
    assert result.status == "lost" and "displacements and deformation contradict each other" in result.reason


def test_a_run_is_lost_from_the_first_moment_that_shows_it():
    """At the particle that was the worst by then; of several rules by the first, of estimators that are valid."""
    series = {"time": np.arange(4.0), "place": np.array([np.nan, 4, np.nan, 7])}
    late, early = (soundness._first_exceedance(series, np.array(values), 0.5, 2.0, "{size}".format)
                   for values in ([0.0, 0.8, 1.8, 4.0], [0.0, 1.2, 0.1, 0.1]))
    assert (late.time, late.sentence, late.particle) == (2.0, "0.9", 4)
    assert soundness.earliest_finding({"mean_drift": late, "recovered/v": early}, ()) is early
    assert soundness.earliest_finding({"mean_drift": late, "recovered/v": early}, {"recovered": "why"}) is late
    assert soundness.earliest_finding({}, ()) is None


def test_evidence_is_the_largest_over_the_run():
    """In amplitudes; none of a rule that was not evaluated."""
    scene, unknown = BarScene(), np.full(3, np.nan)
    found = {"time": np.arange(3.0), "motion_square": unknown, **dict.fromkeys(soundness.CONTRADICTIONS, unknown),
             "mean_drift": scene.motion_amplitude * np.array([0.0, 0.75, 0.5])}
    known = {name: share for name, share in soundness.evidence(scene, found).items() if share is not None}
    assert known == {"mean_drift": pytest.approx(0.75)}


def test_a_finding_names_the_worst_particle_of_its_own_moment(simulate):
    result = simulate(ONE_EACH)
    found = soundness.findings(result.scene, result.series)
    assert found
    for name, one in found.items():
        worst = {**result.series, "place": np.where(result.series["time"] == one.time, 7.0, 3.0)}
        assert soundness.findings(result.scene, worst)[name].particle == 7
