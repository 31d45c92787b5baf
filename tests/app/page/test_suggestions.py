"""Sparks: what each puts on the stage, and answers that are made of what both runs have come to."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from app import shareable_state
from app.names_and_units import per_cent
from app.page.features.suggestions import Suggestions, lost_run_cards
from app.page.visit.first_scene import first_scene
from app.page.visit.history import NormHistory
from app.problems.suggested_experiment import SuggestionNotApplicable
from app.problems.views import VIEWS
from app.shareable_state import State
from solvers.problems import PROBLEMS
from solvers.running.run import build
from tests.app.frame.test_view import report_of
from tests.app.page.panel import page_view

BASES = [*map(first_scene, PROBLEMS),
         shareable_state.parse_state("bar;motion=patch;modulus=1000;cfl=0.2;estimators=companion").scene]


def ran(scene, periods):
    """A run's history, as long as that."""
    solver, history = build(scene), NormHistory(scene, scene.particles)
    history.add(solver.measure())
    while solver.time < periods * scene.period:
        history.add(solver.advance(scene.sample_interval))
    return history


@pytest.mark.parametrize("base", BASES, ids=lambda scene: scene.problem)
def test_three_a_problem_each_of_which_can_be_asked(base):
    """And has a link; what it compares with is what was on the stage."""
    sparks = VIEWS[base.problem].suggestions(State(base))
    assert len({spark.key for spark in sparks}) == 3
    for spark in sparks:
        asked = spark.offer(State(base)).state
        assert asked.scene != base and asked.pinned in (None, replace(base, periods=None, t_end=None))
        assert shareable_state.parse_state(shareable_state.write_state(asked)) == asked


def test_what_cannot_be_asked_says_why():
    bar = replace(first_scene("bar"), cells=100)
    with pytest.raises(SuggestionNotApplicable, match="160 cells are the most here"):
        VIEWS["bar"].suggestions(State(bar))[0].offer(State(bar))
    broken = VIEWS["bar"].suggestions(State(bar))[2].offer(State(bar)).state
    with pytest.raises(SuggestionNotApplicable, match="it is on the stage"):
        VIEWS["bar"].suggestions(broken)[2].offer(broken)
    crossing = replace(bar, method="mpm")
    assert VIEWS["bar"].suggestions(State(crossing))[1].offer(State(crossing)).title == "Smooth the crossing"


class Stage:
    """A session that shows at once, and the panel of a visitor."""

    def __init__(self, scene):
        self.state, self.report = State(scene), report_of(scene)
        self.session = SimpleNamespace(scene=scene, report=self.report, pinned=None, pinned_scene=None,
                                       history=None)
        self.html = SimpleNamespace(content="")
        gui = SimpleNamespace(add_html=lambda _: self.html)
        self.sparks = Suggestions(gui, self.session, lambda: self.state, self.show, lambda _: False,
                                  lambda: False, SimpleNamespace(open=lambda stages: None, answer=lambda _: self.held))

    def show(self, shown):
        self.state, session = shown, self.session
        session.scene, session.report = shown.scene, report_of(shown.scene)
        session.pinned_scene = shown.pinned
        session.pinned = shown.pinned and SimpleNamespace(scene=shown.pinned, history=None)

    def look(self):
        self.sparks.refresh(page_view())
        return self.html.content


@pytest.mark.parametrize(("key", "quantity", "says"), [("halve", "x", "It fell to {}"), ("cross", "sigma", "is {} ")])
def test_an_answer_is_the_ratio_of_the_runs_own_errors(key, quantity, says):
    """Once both have gone on for a period, and not before; after that it stays as it is."""
    stage = Stage(replace(first_scene("bar"), cells=20, ppc=2))
    assert "Try one" in stage.look() and stage.look().count("&quot;done&quot;: true") == 0
    stage.sparks.on_button_click(key)
    session, pinned = stage.session, stage.session.pinned
    assert pinned.scene.cells == 20 and stage.state.quantity == quantity
    session.history, pinned.history = ran(session.scene, 0.5), ran(pinned.scene, 1.0)
    assert "Comparing" in stage.look()
    session.history = ran(session.scene, 1.0)
    sizes = [history.series[f"error_{quantity}"].mean() for history in (session.history, pinned.history)]
    answer = says.format(f"{sizes[0] / sizes[1]:.3g}")
    assert "The answer" in stage.look() and answer in stage.look() and "Next: " in stage.look()
    assert ("&quot;Why?&quot;]" in stage.look()) == (key == "halve")  # a button: the error budget answers
    session.history = ran(session.scene, 1.5)
    assert answer in stage.look()
    session.scene = replace(session.scene, cells=25)  # the visitor has moved a slider
    session.report = report_of(session.scene)
    assert "Try one" in stage.look() and stage.look().count("&quot;done&quot;: true") == 1


def test_crossings_that_nobody_counted_are_not_told():
    cross = VIEWS["bar"].suggestions(State(first_scene("bar")))[1]
    counted, not_counted = {"crossings": np.array([0.0, 3.0])}, {"crossings": np.full(2, np.nan)}
    runs = SimpleNamespace(ratio=0.5, quantity_noun="stress", series=counted, pinned=counted)
    assert cross.answer(runs)[1].startswith("3 crossings, 3 in")
    for without in ({"series": not_counted}, {"pinned": not_counted}):
        assert "are not counted" in cross.answer(SimpleNamespace(**vars(runs) | without))[1]


def test_the_next_one_is_compared_with_the_run_before_the_first():
    stage = Stage(first_scene("bar"))
    base = stage.state.scene
    stage.sparks.on_button_click("halve")
    stage.sparks.on_button_click("cross")
    assert stage.state.pinned == replace(base, periods=None) == replace(stage.state.scene, method="ugimp")
    stage.sparks.on_button_click(["no key"])
    stage.sparks.on_button_click("nor this")
    assert stage.state.scene.method == "mpm"


def test_a_lost_run_has_ways_on():
    """Back to before it broke, or with what was tried and held; until that is known, trials are told of."""
    scene = shareable_state.parse_state("bar;method=mpm;amplitude=0.1;estimators=companion").scene
    report = replace(report_of(scene), status="lost", since=1.225, reason="the run is lost from t = 1.225 s on: so")
    shown, sought = [], []
    held = [{"change": {"remedies": ["pieces"]}}]
    ways = dict((card.key, act) for card, act in lost_run_cards(State(scene), report, held, sought.append,
                                                                shown.append))
    ways["back"]()
    assert sought == [pytest.approx(1.195)] and shown[0].stops and shown[0].scene.end_time == sought[0]
    ways["cure-0"]()
    assert shown[1].scene == replace(scene, remedies=("pieces",))
    stage = Stage(scene)
    stage.session.report = report
    for stage.held, title in ((None, "Trying changes"), (held, "Forces of pieces"), ([], "No change found")):
        assert "What now?" in stage.look() and title in stage.look(), stage.look()


def test_an_answer_of_a_patch_test_is_how_wrong_its_stress_is():
    scene = BASES[-1]
    stage = Stage(scene)
    for key in ("misfit-mpm", "misfit-ugimp"):
        stage.sparks.on_button_click(key)
        stage.session.history = history = ran(stage.session.scene, 0.5)
        wrong = history.series["error_sigma"].mean() / stage.session.scene.size_of("sigma")
        said = f"The stress is {per_cent(wrong)} wrong" if wrong > 0.1 else "Nothing happens, as expected."
        assert said in stage.look() and (key == "misfit-mpm") == (wrong > 0.1)
        stage.state = State(scene)
        stage.session.scene, stage.session.report = scene, report_of(scene)
        stage.look()
