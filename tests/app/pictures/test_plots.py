"""The picture of a run, in every state that a run can end in."""

from __future__ import annotations

import sys
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.collections import PathCollection
from matplotlib.colors import to_rgb

from app.colour_palette import CAUSES as CAUSE_COLOURS
from app.colour_palette import ESTIMATE, TRUTH
from app.frame.budget_chart_data import format_percent
from app.pictures.run_errors import png_bytes, run_figure
from app.problems.bar.picture_panels import _particle_intervals
from solvers.problems.bar.scene import BarScene
from solvers.problems.ring import RingScene
from solvers.running.result import Result
from solvers.running.run import picture_step, run
from solvers.scene.error_causes import CAUSES, FIELDS
from solvers.scene.estimator_registry import ESTIMATORS, Estimator

SCENE = BarScene(cells=8, ppc=2, periods=0.3, estimators=("transport",))
RING = RingScene(cells=12, periods=0.1, estimators=("transport",))


@pytest.fixture(scope="module")
def result() -> Result:
    return run(SCENE, prices=False)


def panels(figure) -> dict:
    """The panels in the order in which they are drawn: three of norms, the index, the curve, the lanes."""
    return {"norms": figure.axes[:3], "index": figure.axes[3], "curve": figure.axes[4], "particles": figure.axes[5]}


def test_the_picture_of_a_bar_shows_its_result(result):
    """Norms in the two colours, the index, lanes on one scale with the boundaries of cells, and the scene."""
    figure = run_figure(result)
    shown, title = panels(figure), figure.get_suptitle()
    for axes, quantity in zip(shown["norms"], ("x", "v", "sigma"), strict=True):
        assert axes.get_yscale() == "log"
        truth, estimate = axes.get_lines()
        assert (truth.get_color(), estimate.get_color()) == (TRUTH, ESTIMATE)
        np.testing.assert_array_equal(truth.get_ydata()[1:], result.series[f"error_{quantity}"][1:])
    lines = {line.get_label(): line for line in shown["index"].get_lines()}
    assert lines["x"].get_ydata()[-1] == pytest.approx(result.index["transport"]["x"])
    assert lines["σ"].get_ydata()[-1] == pytest.approx(result.index["transport"]["sigma"])
    truth, estimate, boundaries = shown["particles"].collections[:3]
    assert truth.norm is estimate.norm
    np.testing.assert_array_equal(truth.get_array(), np.abs(result.final.error[:, 0]))
    np.testing.assert_array_equal(estimate.get_array(), np.abs(result.final.estimate["transport"][:, 0]))
    assert truth.norm.vmax == max(truth.get_array().max(), estimate.get_array().max())
    np.testing.assert_allclose([line[0][0] for line in boundaries.get_segments()], np.arange(9) / 8)
    assert "uGIMP" in title and "8 cells" in title and "A = 0.025 m" in title


def test_particles_fill_their_lane_and_bury_no_line(result):
    """Without gaps that form a pattern, except where particles are missing; the exact line lies over the dots."""
    left, right = _particle_intervals(np.array([0.3, 0.1, 0.2, 0.9]))
    np.testing.assert_allclose((left, right), ([0.25, 0, 0.15, 0.7125], [0.4875, 0.15, 0.25, 1]))
    shown = panels(run_figure(result))
    assert shown["curve"].get_lines()[0].get_zorder() > shown["curve"].collections[0].get_zorder()
    assert "logarithmic" in shown["norms"][0].get_title(loc="left")


@pytest.mark.parametrize("changes, colours, named, ring_says", [
    ({"effects": ("estimate",)}, [ESTIMATE], ["estimate\n(transport)"], "estimate (transport) truth not computed"),
    ({"estimators": ()}, [TRUTH], ["truth"], "not estimated truth"),
    ({"effects": ()}, [], ["particles"], "not estimated truth not computed")], ids=str)
def test_what_is_not_there_is_not_drawn_and_said(changes, colours, named, ring_says):
    """Alone the estimate, the truth, or the particles."""
    figure = run_figure(run(replace(SCENE, **changes), prices=False))
    shown = panels(figure)
    assert [line.get_color() for line in shown["norms"][0].get_lines()] == colours
    assert [label.get_text() for label in shown["particles"].get_yticklabels()] == named
    assert "nothing to show" in words(shown["index"]) and (colours or "nothing to show" in words(figure.axes[0]))
    figure = run_figure(run(replace(RING, **changes), prices=False))
    assert ring_says in words(figure.axes[5]) and png_bytes(figure).startswith(b"\x89PNG")


@pytest.mark.parametrize("scene", [replace(SCENE, cells=40, cfl=1.5, periods=5.0), replace(RING, cfl=1.2, periods=1.0)],
                         ids=["bar", "ring"])
def test_an_unstable_run_is_drawn_at_its_end_and_with_its_reason(scene):
    unstable = run(scene, prices=False)
    assert unstable.status == "unstable" and unstable.picture_snapshot is unstable.final
    figure = run_figure(unstable)
    assert " ".join(unstable.reason.split()) == " ".join(" ".join(figure.get_suptitle().split("\n")[2:]).split())
    low, high = panels(figure)["norms"][0].get_ylim()
    assert 0 < low < high <= 1.01e8 * low
    assert png_bytes(figure).startswith(b"\x89PNG")


def test_all_errors_zero(result):
    series = {name: np.zeros_like(values) if "error" in name or "estimate" in name else values
              for name, values in result.series.items()}
    final = replace(result.final, error=0 * result.final.error, estimate={"transport": 0 * result.final.error})
    figure = run_figure(replace(result, series=series, final=final))
    assert all("nothing to show" in axes.texts[0].get_text() for axes in figure.axes[:3])
    assert png_bytes(figure).startswith(b"\x89PNG")


@pytest.mark.parametrize("rows", [slice(0, 1), slice(-1, None)], ids=["start", "end"])
def test_a_single_sample_is_a_visible_mark(result, rows):
    figure = run_figure(replace(result, series={name: values[rows] for name, values in result.series.items()}))
    marks = [line.get_marker() for axes in figure.axes[:3] for line in axes.get_lines()]
    assert all(mark == "o" for mark in marks) and (marks or rows.start == 0)
    assert png_bytes(figure).startswith(b"\x89PNG")


def test_who_made_the_error_is_drawn_where_the_run_has_it(result):
    """Three panels more, with the colours and the share of the cause that made most; none where shares mean nothing."""
    scene = replace(result.scene, method="mpm", effects=("truth", "budget"))
    divided = run(scene, prices=False)
    figure, plain = run_figure(divided), run_figure(result)
    titles = [axes.get_title(loc="left") for axes in figure.axes]
    for field in FIELDS:
        cause, share = max(divided.budget[field].items(), key=lambda item: item[1])
        assert f"Error of {field}, RMS: {CAUSES[cause]} made {format_percent(share)}" in titles
    assert len(figure.legends[0].get_texts()) == len(CAUSES) and not plain.legends
    assert not any(" made " in axes.get_title(loc="left") for axes in plain.axes)
    crossings = to_rgb(CAUSE_COLOURS["crossings"].light)
    assert any(np.allclose(part.get_facecolor()[0, :3], crossings) for axes in figure.axes[-3:]
               for part in axes.collections)
    noise = {f"budget/size_x_{cause}": 5 * divided.series["budget/error_x"] for cause in CAUSES}
    assert not run_figure(replace(divided, series=divided.series | noise)).legends


def test_pictures_leave_no_global_figure(result):
    run_figure(result)
    pyplot = sys.modules.get("matplotlib.pyplot")
    assert pyplot is None or pyplot.get_fignums() == []


@pytest.fixture(scope="module")
def ring() -> Result:
    return run(RING, prices=False)


def ring_halves(figure) -> tuple:
    """The estimate's dots on the left and the truth's on the right."""
    left, right = [drawn for drawn in figure.axes[5].collections if isinstance(drawn, PathCollection)]
    return left, right


def words(axes) -> str:
    return " ".join(text.get_text() for text in axes.texts)


def test_ring_shows_the_estimate_mirrored_and_the_truth_on_one_scale(ring):
    """Which the truth caps; and a profile in the two colours."""
    figure = run_figure(ring)
    estimate, truth = ring_halves(figure)
    np.testing.assert_array_equal(estimate.get_offsets(), ring.final.position * (-1, 1))
    np.testing.assert_array_equal(truth.get_offsets(), ring.final.position)
    np.testing.assert_array_equal(estimate.get_array(), ring.final.estimate["transport"][:, 0])
    np.testing.assert_array_equal(truth.get_array(), ring.final.error[:, 0])
    assert estimate.norm is truth.norm
    assert estimate.norm.vmax == min(max(estimate.get_array().max(), truth.get_array().max()),
                                     10 * truth.get_array().max())
    assert figure.axes[5].get_aspect() == 1.0 and "estimate (transport) truth" in words(figure.axes[5])
    wild = replace(ring.final, estimate={"transport": 1e6 * ring.final.estimate["transport"]})
    estimate, truth = ring_halves(run_figure(replace(ring, final=wild)))
    assert estimate.norm.vmax == truth.norm.vmax == 10 * truth.get_array().max()
    truth, estimate = figure.axes[4].get_lines()
    assert (truth.get_color(), estimate.get_color()) == (TRUTH, ESTIMATE)
    shells = len(truth.get_xdata())
    squares = ring.final.error[:, 0].reshape(-1, shells) ** 2  # the polar layout runs through R first
    np.testing.assert_allclose(truth.get_ydata(), np.sqrt(squares.mean(axis=0)))


def test_ring_says_what_is_not_estimated(ring):
    figure = run_figure(ring)
    assert "not estimated by transport" in words(figure.axes[2])
    assert "not estimated: σ by transport" in words(figure.axes[3])
    assert len(figure.axes[2].get_lines()) == 1


def test_ring_without_a_finite_particle_is_drawn(ring):
    lost = replace(ring.final, position=np.full_like(ring.final.position, np.nan),
                   error=np.full_like(ring.final.error, np.nan))
    figure = run_figure(replace(ring, final=lost))
    assert "no particle is left" in words(figure.axes[5])
    assert png_bytes(figure).startswith(b"\x89PNG")


def test_a_fifth_estimator_is_drawn_as_it_is_registered(result, monkeypatch):
    monkeypatch.setitem(ESTIMATORS, "zero", Estimator("zero", "says nothing", "#aa0000", dashes=(5, 5), symbol="P"))
    monkeypatch.setattr(BarScene, "active_estimators", ("transport", "zero"))
    series = {**result.series, **{f"zero/{key.removeprefix('transport/')}": values
                                  for key, values in result.series.items() if key.startswith("transport/")}}
    final = replace(result.final, estimate=dict.fromkeys(("transport", "zero"), result.final.estimate["transport"]))
    scene = replace(result.scene)  # another one, which has not yet worked out its own estimators
    figure = run_figure(replace(result, scene=scene, series=series, final=final))
    dashes = [line.get_linestyle() for line in figure.axes[0].get_lines()]
    assert dashes == ["-", "-", "--"] and "estimate (zero)" in figure.axes[0].get_legend_handles_labels()[1]
    assert {line.get_color() for line in figure.axes[3].get_lines()} >= {"#aa0000", ESTIMATORS["transport"].colour}
    assert png_bytes(figure).startswith(b"\x89PNG")


@pytest.mark.parametrize(("scene", "share"), [
    (replace(SCENE, periods=1), 0.75), (replace(RING, periods=1), 0.75), (replace(SCENE, periods=1.5), 1.25 / 1.5),
    (replace(SCENE, periods=1.2), 1), (replace(SCENE, periods=0.05), 1), (replace(SCENE, cfl=10, periods=0.5), None)],
    ids=["bar", "ring", "three halves", "large at its end", "too short", "few steps"])
def test_the_moment_shown_has_something_to_see(scene, share):
    """Not the end of whole and half periods, where u = 0; never a step beyond the run."""
    step = picture_step(scene)
    assert 0 < step <= scene.steps and (share is None or step == pytest.approx(share * scene.steps, abs=1))


def test_the_moment_changes_no_bit_of_the_result():
    """The picture's particles are those of a run that ends there, and the rest is as without."""
    scene = replace(SCENE, periods=1)
    kept, without = run(scene, prices=False), run(scene, prices=False, mid_run=False)
    for name, values in without.series.items():
        np.testing.assert_array_equal(values, kept.series[name])
    np.testing.assert_array_equal(kept.final.estimate["transport"], without.final.estimate["transport"])
    np.testing.assert_array_equal(kept.final.position, without.final.position)
    pictured = kept.picture_snapshot
    assert without.picture_snapshot is without.final and pictured.step == picture_step(scene) < kept.final.step
    ended = run(replace(scene, periods=None, t_end=pictured.time, sample_every=scene.sample_interval), prices=False)
    assert ended.steps == pictured.step
    np.testing.assert_array_equal(pictured.position, ended.final.position)
    figure = run_figure(kept)
    at = f"at t = {pictured.time:.4g} s (last peak of the motion)"
    assert sum(at in axes.get_title("left") for axes in figure.axes) == 2
