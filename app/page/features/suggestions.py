"""Suggestions under the headline: three experiments per problem, an answer from the runs' own numbers, and ways on from
a lost run: to the moment it broke, or with a change that was tried and held. ``sparks.js`` draws the buttons."""

import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from html import escape
from typing import Any

import viser

from app.language.translation import lazy, tr, translate_message
from app.names_and_units import difference_text, format_number
from app.page.feature import Feature, VisiblePageState
from app.page.features.shared_cure_trials import SHARED, SharedCureTrials, scene_to_try
from app.page.headline_panel import elapsed_periods, live_to_pinned_ratio
from app.page.page_context import PageContext
from app.page.visit.history import series_until
from app.page.visit.run_session import RunSession
from app.problems.suggested_experiment import (
    Answer,
    ComparedRuns,
    SuggestedExperiment,
    SuggestionNotApplicable,
    changed_state,
)
from app.problems.views import VIEWS
from app.shareable_state import State
from solvers.engine.engine_messages import FrameReport
from solvers.solver.soundness import OK, UNSTABLE

BEFORE = 0.03  # periods to go back before a run broke: more than half the time between frames


@dataclass(frozen=True)
class SuggestionButton:
    """Button of a suggestion: the browser sends ``key`` at a click; ``done`` if clicked before, ``off`` if disabled."""

    key: str
    icon: str
    title: str
    hint: str
    done: bool = False
    off: bool = False


def lost_run_cards(state: State, report: FrameReport, held: Sequence[Mapping[str, Any]] | None,
                   seek: Callable[[float], bool],
                   show: Callable[[State], None]) -> list[tuple[SuggestionButton, Callable[[], None]]]:
    """Returns buttons for a lost run, each with its action. ``state`` is on the stage, ``report`` its last frame;
    ``held`` are the cures that were tried and held, None as long as trials go on; ``seek`` looks back to a time in s,
    and returns False if it is not stored; ``show`` puts a state on the stage."""
    scene = report.scene
    back = max(scene.time_step, (report.since or report.time) - BEFORE * scene.period)

    def look_back() -> None:
        if not seek(back):  # not stored: run again until then
            show(replace(state, scene=replace(scene, periods=None, t_end=back), speed=None, stops=True))

    hint = tr("back to t = {time} s, paused", time=format_number(back))
    ways = [(SuggestionButton("back", "back", tr("See the moment it broke"), hint), look_back)]
    if not held:
        title, hint = (tr("Trying changes …"), tr("until one gives a run that is ok")) if held is None else \
            (tr("No change found"), tr("none that was tried gives a run that is ok"))
        return [*ways, (SuggestionButton("trials", "filter", title, hint, off=True), lambda: None)]
    return ways + [_restart_card(f"cure-{k}", cure, state, show) for k, cure in enumerate(held)]


def _restart_card(key: str, cure: Mapping[str, Any], state: State,
                  show: Callable[[State], None]) -> tuple[SuggestionButton, Callable[[], None]]:
    """Returns a button for a ``cure`` that held, and its action, to ``show`` the state with its change."""
    changes = {name: tuple(value) if isinstance(value, list) else value for name, value in cure["change"].items()}
    wanted = changed_state(state, changes, pinned=False)
    title = difference_text(wanted.scene, replace(state.scene, periods=None, t_end=None))
    return SuggestionButton(key, "filter", f"{title[:1].upper()}{title[1:]}", tr("tried: the run is ok")), \
        lambda: show(wanted)


TRY, COMPARING, ANSWER, LOST = lazy("Try one"), lazy("Comparing …"), lazy("The answer"), lazy("What now?")
WHOLE = 1e-9  # relative rounding of a run's end time


class Suggestions(Feature):
    """One visitor's suggestions: ``state`` returns the state shown, ``show`` puts one on the stage, ``seek`` looks back
    to a time in s, and returns False if it is not stored."""

    def __init__(self, gui: viser.GuiApi, session: RunSession, state: Callable[[], State],
                 show: Callable[[State], None], seek: Callable[[float], bool], is_touring: Callable[[], bool],
                 trials: SharedCureTrials = SHARED):
        self._session, self._state, self._show, self._seek, self._trials = session, state, show, seek, trials
        trials.open(lambda: session.links.playing)
        self._is_touring = is_touring
        self.messages = {"spark": self.on_button_click}
        self._html = gui.add_html("")
        self._done: set[str] = set()
        self._offered: tuple[State, int, list[SuggestionButton]] | None = None  # last buttons, and for what
        # The suggestion, the state before it, and the state it has put on the stage.
        self._running: tuple[SuggestedExperiment, State, State] | None = None
        self._answers: dict[str, Answer] = {}  # by quantity
        self._ways: dict[str, Callable[[], None]] = {}  # ways on from a lost run

    @classmethod
    def build(cls, page: PageContext) -> "Suggestions":
        with page.tabs["explore"]:
            page.gui.add_html("<div class='lab-sparks-here'></div>")  # on a phone
        return cls(page.gui, page.session, lambda: page.controls.state, page.controls.show, page.history.seek_if_stored,
                   lambda: page.is_touring())

    def on_button_click(self, key: object) -> None:
        """Starts the suggestion or the way on from a lost run that has this ``key``; ignores unknown ones."""
        if isinstance(key, str) and key in self._ways:
            self._running, ways, self._ways = None, self._ways, {}
            ways[key]()
            return
        base = self._base_state()
        spark = next((spark for spark in VIEWS[base.scene.problem].suggestions(base) if spark.key == key), None)
        if spark is None:
            return
        try:
            state = spark.offer(base).state
        except SuggestionNotApplicable:
            return
        self._done.add(f"{base.scene.problem} {spark.key}")
        self._running, self._answers = None, {}
        self._show(state)
        self._running = spark, base, state  # only now: meanwhile another state was on the stage

    def close(self) -> None:
        self._trials.close()

    def refresh(self, view: VisiblePageState) -> None:
        """Sends the present buttons or answer to the browser; nothing during a lesson or the tour."""
        content = ""
        if view.has_stage and not self._is_touring() and self._session.report is not None:
            label, answer, cards = self._current()
            said = json.dumps({"label": tr(label), "answer": answer, "cards": [asdict(card) for card in cards]},
                              ensure_ascii=False)
            content = f"<i class='lab-sparks' data-sparks=\"{escape(said)}\"></i>"
        self._html.content = content

    def _current(self) -> tuple[str, Answer | None, list[SuggestionButton]]:
        """Returns the label, the answer if there is one, and the buttons that are shown now."""
        self._discard_outdated_suggestion()
        report, asked = self._session.report, self._running
        assert report is not None
        here = report.scene == self._session.scene
        lost = here and report.status != OK
        answer = self._answer() if asked and here and not (lost and asked[0].breaks) else None
        if lost and answer is None and (asked is None or asked[0].breaks or report.status == UNSTABLE):
            ways = lost_run_cards(self._state(), report, self._trials.answer(scene_to_try(report)), self._seek,
                                  self._show)
            self._ways = {card.key: act for card, act in ways}
            return LOST, None, [card for card, _ in ways]
        self._ways = {}
        cards = self._cards(self._base_state())
        if asked is None:
            return TRY, None, cards
        if answer is None:
            return COMPARING, None, [replace(card, off=card.off or card.key == asked[0].key) for card in cards]
        keys = [card.key for card in cards]
        at = keys.index(asked[0].key)
        following = next((card for card in (*cards[at + 1:], *cards[:at]) if not card.off), None)
        return ANSWER, answer, [] if following is None else [
            replace(following, title=tr("Next: {title}", title=following.title))]

    def _cards(self, base: State) -> list[SuggestionButton]:
        """Returns a button for each suggestion for the state ``base``; disabled where it does not apply."""
        if self._offered and self._offered[:2] == (base, len(self._done)):
            return self._offered[2]
        cards = []
        for spark in VIEWS[base.scene.problem].suggestions(base):
            done = f"{base.scene.problem} {spark.key}" in self._done
            try:
                offer = spark.offer(base)
                cards.append(SuggestionButton(spark.key, spark.icon, offer.title, offer.hint, done))
            except SuggestionNotApplicable as reason:
                why = translate_message(str(reason))
                cards.append(SuggestionButton(spark.key, spark.icon, tr(spark.title), why, done, off=True))
        self._offered = base, len(self._done), cards
        return cards

    def _base_state(self) -> State:
        """Returns the state that suggestions change: the one shown, or that before the running suggestion."""
        self._discard_outdated_suggestion()
        return self._state() if self._running is None else self._running[1]

    def _discard_outdated_suggestion(self) -> None:
        """Discards the running suggestion when another scene or pinned run is on the stage."""
        if self._running:
            shown = self._running[2]
            if shown.scene != self._session.scene or shown.pinned != self._session.pinned_scene:
                self._running = None

    def _answer(self) -> Answer | None:
        """Returns the running suggestion's answer for the quantity shown; None until its runs are long enough."""
        assert self._running is not None
        spark, _, state = self._running
        quantity = self._state().quantity
        if quantity not in self._answers and (ran := self._result(spark, replace(state, quantity=quantity))):
            self._answers[quantity] = spark.answer(ran)
        return self._answers.get(quantity)

    def _result(self, spark: SuggestedExperiment, state: State) -> ComparedRuns | None:
        """Returns a suggestion's runs up to its length; None until they are long enough."""
        session = self._session
        report, pinned, scene = session.report, session.pinned if state.pinned else None, state.scene
        histories = [session.history, *([pinned.history] if pinned else [])]
        scenes = [scene, *([state.pinned] if state.pinned else [])]
        if report is None or [history.scene for history in histories] != scenes:
            return None
        series = [history.series for history in histories]
        if min(map(elapsed_periods, series, scenes)) < spark.periods - WHOLE:
            return None
        series = [series_until(one, spark.periods * its.period * (1 + WHOLE)) for one,
                  its in zip(series, scenes, strict=True)]
        ratio = math.nan if pinned is None or state.pinned is None else \
            live_to_pinned_ratio(series[0], series[1], f"error_{state.quantity}", (scene, state.pinned))
        return ComparedRuns(state, series[0], series[1] if pinned else {}, ratio, report.not_valid)
