"""Who made this error? The chart on the page, the sentence above the stage, and a cause that is taken away: every
number is that of the same run without a page."""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest

from app import state
from app.frame.budget import MEANINGS, blamed, error, field_of, percent, stacked
from app.page.features.budget.panel import BudgetFold
from app.page.measurements import Numbers
from app.page.panels.budget_chart import HEIGHT, MOST, WIDTH, Divided, chart
from app.page.panels.timeline import Now
from app.page.source import Choice
from app.page.visit.history import History
from app.state import State
from app.words import differing, per_cent, with_unit
from solvers.problems.ring.scene import RingScene
from solvers.running.budget import run_budget
from solvers.running.run import run
from solvers.scene.causes import CAUSES, FIELDS
from solvers.solver import budget
from tests.app.page.test_sparks import ran
from tests.processes import until

HATS = state.read("bar;method=mpm;cells=20;ppc=2;estimators=none;effects=truth,crossings,budget").scene
UGIMP = replace(HATS, method="ugimp")


@pytest.fixture(scope="module")
def hats():
    return run(replace(HATS, periods=1), prices=False, mid_run=False)


def of(result, name=""):
    return Divided(name, result.scene, result.series, result.series)


class Handle(SimpleNamespace):
    """A widget that remembers what it calls."""

    def on_click(self, act):
        self.press = lambda: act(None)

    on_update = on_click

    def __enter__(self):
        return self

    def __exit__(self, *_):
        return None


class Gui:
    """Widgets by their labels."""

    def __init__(self):
        self.made = {}

    def add_html(self, content):
        return Handle(content=content, visible=True)

    def __getattr__(self, kind):
        def add(label, options=(None,), **_):
            self.made[label] = Handle(visible=True, value=options[0])
            return self.made[label]

        return add


class Stage:
    """A visitor's fold, and a session that shows at once what it is told."""

    def __init__(self, shown):
        self.state, self.gui, self.refused, self.time = shown, Gui(), [], 0.0
        self.session = SimpleNamespace(scene=shown.scene, refuse=self.refused.append)
        self.fold = BudgetFold(self.gui, self.session, lambda: self.state, self.show, lambda: self.time)

    def show(self, shown):
        self.state, self.session.scene = shown, shown.scene

    def look(self, history=None, pinned=None, quantity="x", studying=False, scene=HATS, playing=False, time=0.0):
        """What is read in the fold after another refresh."""
        now = Now(time, (0.0, 0.0), playing)
        numbers = Numbers(SimpleNamespace(), history, (), (), None, now, "", pinned, scene=scene)
        self.fold.show(numbers, Choice(quantity, None, False, False, 1, False), studying)
        fold = self.fold
        return "".join(html.content for html in (fold._offer, fold._chart, fold._outcome, fold._map) if html.visible)


def shares(text):
    """The legend: of each cause the shares that are said."""
    rows = re.findall(r"data-cause='(\w+)'.*?</td>(.*?)</tr>", text)
    return {cause: re.findall(r"<td>(.*?)</td>", cells) for cause, cells in rows}


def test_layers_add_up_to_the_error_and_leave_no_gap(hats):
    for field in FIELDS:
        layers = stacked(hats.series, field)
        whole = sum(np.diff(edges, axis=0)[0] for layer in layers for edges in (layer.above, layer.below))
        whole_error = error(hats.series, field)
        assert np.abs(whole - whole_error).max() < 4 * 2e-3 * whole_error.max()  # traces are left out
        assert layers[0].cause == "crossings" and not layers[0].above[0].any()
        for one, other in pairwise(layers):
            assert np.array_equal(one.above[1], other.above[0]) and np.array_equal(one.below[1], other.below[0])
        assert all((layer.above >= 0).all() and (layer.below <= 0).all() for layer in layers)


def test_the_legend_has_the_shares_of_the_run(hats):
    for field in FIELDS:
        text, said = chart([of(hats)], field), hats.budget[field]
        assert shares(text) == {cause: [percent(said[cause])] for cause in CAUSES}
        assert all(words in text for words in (*CAUSES.values(), *MEANINGS.values()))
    assert percent(-0.038) == "−4 %" and percent(-0.001) == "0 %" and percent(None) == "–"


def test_the_line_is_the_error_at_its_times(hats):
    """Whole units of the chart; few enough points whatever the run's length."""
    line = re.search(r"lab-whole' d='M(.*?)'", chart([of(hats)], "x"))[1]
    points = np.array([point.split() for point in line.split("L")], float)
    sizes = hats.series["budget/error_x"]
    assert len(points) == len(sizes) <= MOST
    assert np.abs(points[:, 0] - WIDTH * hats.series["time"]).max() <= 0.5 + 1e-9
    assert np.abs(points[:, 1] - np.polyval(np.polyfit(sizes, points[:, 1], 1), sizes)).max() < 1
    assert HEIGHT / 2 < np.ptp(points[:, 1]) <= HEIGHT
    long = {name: np.tile(values, 30) for name, values in hats.series.items()} | {
        "time": np.arange(30 * len(sizes)) * 0.01}
    assert chart([Divided("", HATS, long, long)], "v").count("L") < 12 * MOST


def test_two_runs_have_one_scale_and_a_share_each(hats):
    other = run(replace(UGIMP, periods=1), prices=False, mid_run=False)
    text = chart([of(hats, "pinned: MPM"), of(other, "this run: uGIMP")], "v")
    assert text.count("<figure>") == 2 and text.count(">pinned</th>") == 1
    assert shares(text)["crossings"] == [percent(one.budget["v"]["crossings"]) for one in (hats, other)]
    heights = [min(float(point.split()[1]) for point in line.split("L"))
               for line in re.findall(r"lab-whole' d='M(.*?)'", text)]
    assert heights[0] < heights[1] / 2  # nearer to the top, which is 0


def test_where_shares_mean_nothing_the_reason_stands_in_place_of_the_chart(hats):
    series = hats.series | {f"budget/size_x_{cause}": 5 * hats.series["budget/error_x"] for cause in CAUSES}
    text = chart([Divided("", HATS, series, series)], "x")
    assert "Not valid here: the causes have made errors of x 20 times as large" in text and "<svg" not in text
    assert "data-cause" not in text
    assert blamed(HATS, series, "x") == ""


def test_the_sentence_names_who_made_most(hats):
    x = hats.budget["x"]["crossings"]
    assert blamed(HATS, hats.series, "x") == f"crossings made {per_cent(x)} of the error of x"
    assert blamed(HATS, hats.series, "sigma") == blamed(replace(HATS, effects=("truth",)), hats.series, "x") == ""
    fine = run(replace(HATS, amplitude=2.5e-4, periods=0.3), prices=False, mid_run=False)
    assert blamed(HATS, fine.series, "v").startswith("the coarse grid made ")
    early = {name: values[:2] for name, values in hats.series.items()}
    assert blamed(HATS, early, "x") == ""
    assert [field_of(quantity) for quantity in ("x", "v", "sigma", "a")] == ["x", "v", "F", "F"]


def test_it_is_asked_for_by_a_button_and_follows_the_quantity():
    plain = replace(HATS, effects=("truth", "crossings"))
    stage = Stage(State(plain, pinned=replace(plain, method="ugimp")))
    assert "Which part of the error" in stage.look(scene=plain) and stage.gui.made["Find out"].visible
    stage.fold.press(True)
    assert stage.state == State(HATS, pinned=UGIMP), "the pinned run is divided too"
    stage.fold.press(True)
    stage.fold.press("anything")
    assert stage.state.scene == HATS
    assert "begins again" in stage.look() and not stage.gui.made["Find out"].visible
    history = ran(HATS, 0.5)
    for quantity, field in (("x", "x"), ("v", "v"), ("a", "F"), ("sigma", "F")):
        assert f"share of the error of {field} over the run" in stage.look(history, quantity=quantity)
    stage.gui.made["Divide the error of"].value = "velocity v"
    assert "share of the error of v over the run" in stage.look(history, quantity="sigma")
    assert "crossings" in stage.fold._mark.content


def test_a_chart_that_moves_is_drawn_about_once_a_second():
    stage, history = Stage(State(HATS)), ran(HATS, 0.2)
    first = stage.look(history, playing=True)
    longer = ran(HATS, 0.4)
    stage.time += 0.5
    assert stage.look(longer, playing=True) == first
    stage.time += 0.5
    assert stage.look(longer, playing=True) != first
    assert stage.look(history) == first, "at once where it stands"


def test_in_the_plane_it_is_found_beside_the_stage_when_asked_for():
    """The charts are of the command's runs; what a job has found goes with its scene."""
    ring = RingScene(cells=8, ppc=1, periods=0.2, method="ugimp", estimators=())
    stage = Stage(State(ring))
    assert "Found beside your stage" in stage.look(scene=ring)
    stage.fold.press(True)
    assert stage.state.scene == ring and stage.fold.jobs.status.running
    until(lambda: not stage.fold.jobs.status.running, "the budget")
    found = run_budget(ring, "crossings")
    said = {cause: percent(share) for cause, share in budget.shares(found.result.series, "x").items()}
    assert shares(stage.look(scene=ring)) == {cause: [share] for cause, share in said.items()}
    stage.gui.made["Suspect"].value = "crossings"
    stage.gui.made["Take it away and run again"].press()
    until(lambda: not stage.fold.jobs.status.running, "the run without crossings")
    text, taken = stage.look(scene=ring), found.take_away()
    assert text.count("<figure>") == 2 and "RMS of x over the run, without crossings" in text
    for key, words in (("before", "before"), ("predicted", "foretold"), ("again", "run again")):
        assert f"<span>{words}</span> <b>{with_unit(taken[key]['x'], 'm')}</b>" in text
    assert stage.state.scene == ring and stage.state.pinned is None and not stage.gui.made["Put it back"].visible
    other = replace(ring, cells=10)
    stage.show(State(other))
    assert "Found beside your stage" in stage.look(scene=other)


def test_what_has_no_budget_in_the_plane_is_refused_in_words():
    ring = RingScene(cells=8, ppc=1, periods=0.1, body_force="none", effects=(), estimators=())
    stage = Stage(State(ring))
    stage.fold.press(True)
    until(lambda: not stage.fold.jobs.status.running, "the refusal")
    assert "leaves no exact solution" in stage.look(scene=ring) and stage.gui.made["Find out"].visible


def test_where_and_when_is_a_picture_of_the_moment_that_is_shown(hats):
    """It goes with the moment: what is played on has another."""
    stage, history = Stage(State(HATS)), ran(HATS, 0.25)
    stage.look(history, time=0.25 * HATS.period, playing=True)
    assert not stage.gui.made["Where and when?"].visible
    stage.look(history, time=0.25 * HATS.period)
    stage.gui.made["Where and when?"].press()
    until(lambda: not stage.fold.jobs.status.running, "the map", 60)
    assert "data:image/png;base64,iVBOR" in stage.look(history, time=0.25 * HATS.period)
    assert "base64" not in stage.look(history, time=0.26 * HATS.period)
    stage.fold.press("seen")
    assert "base64" not in stage.look(history, time=0.25 * HATS.period)
    cancelling = Stage(State(UGIMP))
    cancelling.look(ran(UGIMP, 1.0), time=UGIMP.period, scene=UGIMP)
    cancelling.gui.made["Where and when?"].press()
    until(lambda: not cancelling.fold.jobs.status.running, "the refusal", 60)
    assert "There is no map of this error: " in cancelling.look(ran(UGIMP, 1.0), time=UGIMP.period, scene=UGIMP)


def test_where_there_is_none_nothing_is_seen():
    lesson = Stage(State(replace(HATS, effects=("truth",))))
    lesson.look(studying=True)
    assert not lesson.fold._fold.visible, "a lesson that does not ask for it"
    lesson.look()
    assert lesson.fold._fold.visible
    lesson.look(scene=None)  # a file of the visitor's own
    assert not lesson.fold._fold.visible
    nobody = Stage(State(replace(HATS, effects=("crossings", "budget"))))
    assert "switch one of the two on" in nobody.look(scene=nobody.session.scene)


def test_a_cause_is_taken_away_foretold_and_run_again():
    """The two runs and the three sizes are those of the command."""
    stage = Stage(State(HATS, quantity="v"))
    stage.look(ran(HATS, 0.5), quantity="v")
    stage.gui.made["Suspect"].value = "crossings"
    stage.gui.made["Take it away and run again"].press()
    shown = stage.state
    assert shown.scene == replace(HATS, take_away="crossings") and shown.pinned == HATS and shown.quantity == "v"
    assert state.read(state.write(shown)) == shown
    assert differing(shown.scene, HATS) == "without crossings" and differing(HATS, shown.scene) == "as it is"
    before, again = ran(HATS, 1.0), ran(shown.scene, 1.0)
    text = stage.look(again, SimpleNamespace(scene=HATS, history=before), "v", scene=shown.scene)
    found = run_budget(replace(HATS, periods=1), "crossings").take_away()
    for key, words in (("before", "before"), ("predicted", "foretold"), ("again", "run again")):
        value = float(re.search(rf"<span>{words}</span> <b>(\S+) mm/s</b>", text)[1])
        assert value == pytest.approx(1e3 * found[key]["v"], rel=5e-3)
    assert "RMS of v over the run, without crossings" in text and text.count("<figure>") == 2
    stage.gui.made["Put it back"].press()
    assert stage.state.scene == HATS and stage.state.pinned is None


def test_another_pinned_run_foretells_nothing():
    stage, taken = Stage(State(replace(HATS, take_away="crossings"))), replace(HATS, take_away="crossings")
    other = ran(UGIMP, 0.3)
    text = stage.look(ran(taken, 0.3), SimpleNamespace(scene=UGIMP, history=other), scene=taken)
    assert "foretold" not in text and text.count("<figure>") == 2
    empty = SimpleNamespace(scene=HATS, history=History(HATS, HATS.particles))
    assert stage.look(ran(taken, 0.3), empty, scene=taken).count("<figure>") == 1


def test_what_is_foretold_is_over_the_time_that_both_have():
    taken, before = replace(HATS, take_away="crossings"), ran(HATS, 1.0)
    stage = Stage(State(taken))
    text = stage.look(ran(taken, 0.5), SimpleNamespace(scene=HATS, history=before), scene=taken)
    half = {name: values[before.series["time"] <= 0.5 + 1e-9] for name, values in before.series.items()}
    assert f"<span>before</span> <b>{with_unit(budget.rms(half, 'x'), 'm')}</b>" in text
    assert budget.rms(half, "x") != budget.rms(before.series, "x")
