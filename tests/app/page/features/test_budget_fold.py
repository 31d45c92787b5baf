"""Who made this error? The chart on the page, the sentence above the stage, and a cause that is taken away, of series
made by hand: that the numbers are those of runs, ``tests/browser/features/test_budget.py`` sees."""

import json
import re
from dataclasses import replace
from html import unescape
from importlib import import_module
from itertools import pairwise
from types import SimpleNamespace

import numpy as np

from app import shareable_state
from app.frame.budget_chart_data import (
    BELOW_ZERO,
    MEANINGS,
    budget_field,
    error_rms,
    format_percent,
    largest_share,
    stack_layers,
)
from app.names_and_units import difference_text, with_unit
from app.page.feature import VisiblePageState
from app.page.features.budget.chart import HEIGHT, MOST, WIDTH, RunBudget, budget_chart
from app.page.features.budget.panel import BudgetPanel
from app.page.features.budget.shared_budgets import SharedBudgets
from app.page.panels.time_axis import TimelineState
from app.page.readout_panel import ReadoutContent
from app.page.stage_source import ViewChoice
from app.shareable_state import State
from solvers.problems.ring import RingScene
from solvers.running import budget_cause_removal as running
from solvers.scene.error_causes import CAUSES, FIELDS
from solvers.solver import budget_shares
from tests.app.page.panel import Gui

HATS = shareable_state.parse_state("bar;method=mpm;cells=20;ppc=2;estimators=none;effects=truth,crossings,budget").scene
UGIMP = replace(HATS, method="ugimp")
RING = RingScene(cells=8, ppc=1, periods=0.2, method="ugimp", estimators=())


def made(crossings=0.9, grid=0.2, size=1e-3, periods=1.0, count=41):
    """Samples of a run whose error of x, v and F rises to ``size``; of it crossings make a share, the coarse grid
    another, and the time step the rest, which makes it smaller. The parts of any two causes pull one way."""
    time = np.linspace(0, periods, count)
    series = {"time": time * HATS.period}
    for field in FIELDS:
        series[f"budget/error_{field}"] = whole = size * np.sin(time) ** 2
        for cause, share in zip(CAUSES, (crossings, grid, 0.0, 1 - crossings - grid), strict=True):
            series[f"budget/part_{field}_{cause}"] = share * whole
            series[f"budget/size_{field}_{cause}"] = abs(share) * whole
    return series


def of(series, name="", scene=HATS):
    return RunBudget(name, scene, series, series)


def past(scene, series):
    """The history of a run on the stage."""
    return SimpleNamespace(scene=scene, series=series, latest_periods_series=series)


def test_the_largest_cause_makes_the_error_larger():
    """One that reduces it by more than any other adds is none."""
    series = made(0.6, 0.65)
    for cause, share in (("body_force", 0.55), ("time_step", -0.8)):
        series[f"budget/part_v_{cause}"] = share * series["budget/error_v"]
        series[f"budget/size_v_{cause}"] = abs(share) * series["budget/error_v"]
    cause, share = largest_share(series, "v")
    assert cause == "coarse_grid" and abs(share - 0.65) < 1e-9


class Beside(SharedBudgets):
    """Budgets that are there, by scene, and those that were asked for; others are none."""

    def __init__(self, found):
        super().__init__()
        self.found, self.asked = found, []

    def find(self, scene, time, starts):
        self.asked += [scene] * starts
        return self.found.get(scene, {})


class Stage:
    """A visitor's fold, and a session that shows at once what it is told."""

    def __init__(self, shown):
        self.state, self.gui, self.refused, self.time = shown, Gui(), [], 0.0
        self.session = SimpleNamespace(scene=shown.scene, refuse=self.refused.append)
        self.budgets = Beside({})
        self.fold = BudgetPanel(self.gui, self.session, lambda: self.state, self.show, lambda: self.time, self.budgets)

    def show(self, shown):
        self.state, self.session.scene = shown, shown.scene

    def look(self, history=None, pinned=None, quantity="x", studying=False, scene=HATS, playing=False, time=0.0):
        """What is read in the fold after another refresh."""
        now = TimelineState(time, (0.0, 0.0), playing)
        numbers = ReadoutContent(SimpleNamespace(), history, (), (), None, now, "", pinned, scene=scene)
        self.fold.refresh(VisiblePageState(ViewChoice(quantity, None, False, False, 1, False), numbers, studying, True))
        fold = self.fold
        return "".join(html.content for html in (fold._offer, fold._chart, fold._outcome) if html.visible)


def shares(text):
    """The legend: of each cause the shares that are said."""
    rows = re.findall(r"data-cause='(\w+)'.*?</td>(.*?)</tr>", text)
    return {cause: re.findall(r"<td>(.*?)</td>", cells) for cause, cells in rows}


def test_layers_add_up_to_the_error_and_leave_no_gap():
    series = made()
    for field in FIELDS:
        layers = stack_layers(series, field)
        assert [layer.cause for layer in layers] == ["crossings", "coarse_grid", "time_step"], "who makes none has none"
        whole = sum(np.diff(edges, axis=0)[0] for layer in layers for edges in (layer.above, layer.below))
        np.testing.assert_allclose(whole, error_rms(series, field), rtol=0, atol=1e-18)
        assert not layers[0].above[0].any() and layers[-1].below[1].min() < 0
        for one, other in pairwise(layers):
            assert np.array_equal(one.above[1], other.above[0]) and np.array_equal(one.below[1], other.below[0])


def test_the_line_is_the_error_at_its_times():
    """Whole units of the chart; few enough points whatever the run's length."""
    series = made()
    line = re.search(r"lab-whole' d='M(.*?)'", budget_chart([of(series)], "x"))[1]
    points = np.array([point.split() for point in line.split("L")], float)
    sizes = series["budget/error_x"]
    assert len(points) == len(sizes) <= MOST
    assert np.abs(points[:, 0] - WIDTH * series["time"] / HATS.period).max() <= 0.5 + 1e-9
    assert np.abs(points[:, 1] - np.polyval(np.polyfit(sizes, points[:, 1], 1), sizes)).max() < 1
    assert HEIGHT / 2 < np.ptp(points[:, 1]) <= HEIGHT
    assert budget_chart([of(made(periods=12.0, count=30 * MOST))], "v").count("L") < 12 * MOST


def test_the_legend_has_shares_and_two_runs_have_one_scale():
    text = budget_chart([of(made())], "v")
    assert shares(text) == dict(zip(CAUSES, (["90 %"], ["20 %"], ["0 %"], ["−10 %"]), strict=True))
    assert all(words in text for words in (*CAUSES.values(), *MEANINGS.values()))
    assert str(BELOW_ZERO) in text and str(BELOW_ZERO) not in budget_chart([of(made(0.9, 0.1))], "v")
    assert format_percent(-0.001) == "0 %" and format_percent(None) == "–"
    text = budget_chart([of(made(), "pinned: MPM"), of(made(0.4, 0.7, 3e-4), "this run: uGIMP", UGIMP)], "v")
    assert text.count("<figure>") == 2 and text.count(">pinned</th>") == 1
    assert shares(text)["crossings"] == ["90 %", "40 %"]
    heights = [min(float(point.split()[1]) for point in line.split("L"))
               for line in re.findall(r"lab-whole' d='M(.*?)'", text)]
    assert heights[0] < heights[1] / 2  # nearer to the top, which is 0


def test_where_shares_mean_nothing_the_reason_stands_in_place_of_the_chart():
    series = made() | {f"budget/size_x_{cause}": 5 * made()["budget/error_x"] for cause in CAUSES}
    text = budget_chart([of(series)], "x")
    assert "the causes have errors of x that cancel and are 20 times as large" in text and "<svg" not in text
    assert "data-cause" not in text


def test_a_quantity_has_the_budget_of_its_field():
    assert [budget_field(quantity) for quantity in ("x", "v", "sigma", "a")] == ["x", "v", "F", "F"]


def test_it_is_asked_for_by_a_button_and_follows_the_quantity():
    plain = replace(HATS, effects=("truth", "crossings"))
    stage = Stage(State(plain, pinned=replace(plain, method="ugimp")))
    assert "Which part of the error" in stage.look(scene=plain) and stage.gui.by_label["Find out"].visible
    stage.fold.on_button_click(True)
    assert stage.state == State(HATS, pinned=UGIMP), "the pinned run is divided too"
    stage.fold.on_button_click(True)
    stage.fold.on_button_click("anything")
    assert stage.state.scene == HATS
    assert "starts again" in stage.look() and not stage.gui.by_label["Find out"].visible
    history = past(HATS, made())
    for quantity, field in (("x", "x"), ("v", "v"), ("a", "F"), ("sigma", "F")):
        assert f"share of the error of {field} over the run" in stage.look(history, quantity=quantity)
    stage.gui.by_label["Divide the error of"].value = "velocity v"
    assert "share of the error of v over the run" in stage.look(history, quantity="sigma")
    assert "crossings" in stage.fold._mark.content


def line(stage):
    """What the line says, and the parts of its bar."""
    return json.loads(unescape(re.search("data-said='(.*?)'", stage.fold._line.content)[1])).values()


def test_the_line_divides_the_error_of_the_instant_shown():
    """It is asked for once the scene has been the same for a while. What no particle has crossed is no crossing's."""
    plain = replace(HATS, effects=("truth", "crossings"))
    stage, series = Stage(State(plain)), made() | {"crossings": np.arange(41.0) - 20}
    stage.budgets.found[plain] = None
    stage.look(scene=plain, time=0.5)
    assert [*line(stage)] == ["…", []] and not stage.budgets.asked
    stage.time += 2
    stage.look(scene=plain, time=0.5)
    assert stage.budgets.asked == [plain]
    stage.budgets.found[plain] = series
    stage.look(scene=plain, time=1.0 * HATS.period)
    said, parts = line(stage)
    assert said == "crossings 90 % · coarse grid 20 %" and parts[0] == ["made-crossings", 0.9] and parts[3][1] == 0
    stage.look(scene=plain, time=0.25 * HATS.period)
    assert next(iter(line(stage))) == "particle sums 90 % · coarse grid 20 %"
    stage.look(scene=plain, time=0.0)
    assert [*line(stage)] == ["no error yet", []]
    stage.budgets.found[plain] = {}
    stage.look(scene=plain, time=0.5)
    assert [*line(stage)] == ["not for this run", []]
    stage.look(scene=plain, studying=True)
    assert stage.fold._line.content == "", "it might be an answer"


def test_the_press_on_it_shows_the_chart_of_the_same_run():
    plain = replace(HATS, effects=("truth", "crossings"))
    stage = Stage(State(plain))
    stage.budgets.found = {plain: made(), replace(plain, method="ugimp"): made(0.4, 0.7)}
    pinned = SimpleNamespace(scene=replace(plain, method="ugimp"), history=past(plain, {}))
    stage.fold.on_button_click(True)
    assert stage.state.scene == plain, "it goes on"
    assert shares(stage.look(scene=plain, pinned=pinned, time=HATS.period))["crossings"] == ["40 %", "90 %"]


def test_a_chart_that_moves_is_drawn_about_once_a_second():
    stage, history, longer = Stage(State(HATS)), past(HATS, made()), past(HATS, made(0.5))
    first = stage.look(history, playing=True)
    stage.time += 0.5
    assert stage.look(longer, playing=True) == first
    stage.time += 0.5
    assert stage.look(longer, playing=True) != first
    assert stage.look(history) == first, "at once where it stands"


def at_once(monkeypatch, jobs, said):
    """The function that a process would be asked for is called here, and what it says goes the same way."""
    def hear(message):
        said.append(message)
        jobs._on_message(json.loads(json.dumps(message)))

    def start(status, question, patience):
        jobs.status = replace(status, running=True)
        getattr(import_module(jobs.WORK), status.kind)(question, hear)
        jobs.status = replace(jobs.status, running=False)

    monkeypatch.setattr(jobs, "_start", start)


def test_in_the_plane_it_is_found_beside_the_stage_when_asked_for(monkeypatch):
    """Of runs that are at hand; what a job has found goes with its scene."""
    def run_budget(scene, cause, show):
        show(0.5)
        result = SimpleNamespace(series=made(), status="ok")
        return SimpleNamespace(result=result, again=None if cause == "nothing" else
                               SimpleNamespace(series=made(0.0, 0.9, 1e-4), status="lost", reason="it is lost"))

    stage, said = Stage(State(RING)), []
    monkeypatch.setattr(running, "run_budget", run_budget)
    at_once(monkeypatch, stage.fold.jobs, said)
    assert "Found beside your stage" in stage.look(scene=RING)
    stage.fold.on_button_click(True)
    assert stage.state.scene == RING and said[0] == {"part": 0.5}
    assert shares(stage.look(scene=RING))["crossings"] == ["90 %"]
    stage.gui.by_label["Suspect"].value = "crossings"
    stage.gui.by_label["Take it away and run again"].click()
    text = stage.look(scene=RING)
    assert text.count("<figure>") == 2 and "RMS of x over the run, without crossings" in text
    assert "The run goes bad: it is lost." in text
    for words, size in (("before", budget_shares.rms_error_over_run(made(), "x")),
                        ("predicted", 0.1 * budget_shares.rms_error_over_run(made(), "x")),
                        ("run again", 0.1 * budget_shares.rms_error_over_run(made(), "x"))):
        assert f"<span>{words}</span> <b>{with_unit(size, 'm')}</b>" in text
    assert stage.state.scene == RING and stage.state.pinned is None and not stage.gui.by_label["Put it back"].visible
    other, unknown = replace(RING, cells=10), replace(RING, body_force="none", effects=())
    stage.show(State(other))
    assert "Found beside your stage" in stage.look(scene=other)
    monkeypatch.undo()
    at_once(monkeypatch, stage.fold.jobs, said)
    stage.show(State(unknown))
    stage.fold.on_button_click(True)
    assert "leaves no exact solution" in stage.look(scene=unknown) and stage.gui.by_label["Find out"].visible


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
    """Of the time that both runs have."""
    stage = Stage(State(HATS, quantity="v"))
    stage.look(past(HATS, made()), quantity="v")
    stage.gui.by_label["Suspect"].value = "crossings"
    stage.gui.by_label["Take it away and run again"].click()
    shown = stage.state
    assert shown.scene == replace(HATS, take_away="crossings") and shown.pinned == HATS and shown.quantity == "v"
    assert shareable_state.parse_state(shareable_state.write_state(shown)) == shown
    assert (
        difference_text(shown.scene, HATS) == "without crossings" and difference_text(HATS, shown.scene) == "as it is"
    )
    half = budget_shares.rms_error_over_run(made(periods=0.5, count=21), "v")
    assert half < 0.5 * budget_shares.rms_error_over_run(made(), "v")
    text = stage.look(past(shown.scene, made(0.0, 1.0, 2e-4, 0.5, 21)),
                      SimpleNamespace(scene=HATS, history=past(HATS, made())), "v", scene=shown.scene)
    for words, size in (("before", half), ("predicted", 0.1 * half), ("run again", 0.2 * half)):
        assert f"<span>{words}</span> <b>{with_unit(size, 'm/s')}</b>" in text
    assert "RMS of v over the run, without crossings" in text and text.count("<figure>") == 2
    stage.gui.by_label["Put it back"].click()
    assert stage.state.scene == HATS and stage.state.pinned is None


def test_another_pinned_run_foretells_nothing():
    taken = replace(HATS, take_away="crossings")
    stage, shown = Stage(State(taken)), past(taken, made(0.0, 1.0))
    text = stage.look(shown, SimpleNamespace(scene=UGIMP, history=past(UGIMP, made())), scene=taken)
    assert "predicted" not in text and text.count("<figure>") == 2
    assert text.index("this run") < text.index("pinned")
    empty = SimpleNamespace(scene=HATS, history=past(HATS, {}))
    assert stage.look(shown, empty, scene=taken).count("<figure>") == 1
