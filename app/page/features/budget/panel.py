"""The folder *Who made this error?*: chart of the error budget, and a rerun without one cause beside the pinned first
run. Runs of the bar record their budget; that of plane problems is computed in the background on request."""

import math
from collections.abc import Callable
from dataclasses import replace
from html import escape
from time import monotonic
from typing import Any

import viser

from app.frame.budget_chart_data import QUESTION, budget_field, format_percent, has_budget, largest_share
from app.language.translation import lazy, tr, translate_message
from app.names_and_units import difference_text
from app.page.feature import Feature, VisiblePageState
from app.page.features.budget.chart import RunBudget, as_sentence, budget_chart, removal_outcome, removed_cause
from app.page.features.budget.jobs import BudgetJobs, BudgetJobStatus
from app.page.features.budget.line import (
    BEING_FOUND,
    ON_REQUEST,
    budget_button_html,
    budget_line_at,
    budget_line_html,
)
from app.page.features.budget.shared_budgets import SHARED, SharedBudgets
from app.page.page_context import PageContext
from app.page.panels.page_header import widget_marker_html
from app.page.readout_panel import ReadoutContent
from app.page.visit.history import series_until
from app.page.visit.run_session import RunSession
from app.shareable_state import State
from solvers.scene.error_causes import CAUSES, NOTHING, cause_labels
from solvers.scene.scene import Scene
from solvers.scene.validation import SceneError
from solvers.solver import budget_shares

EFFECT = "budget"
REDRAWN = 0.9  # seconds between two redraws for a playing run
REST = 1.4  # seconds without another scene after which its budget is computed
OFFER = lazy("Which part of the error have crossings made, and which the coarse grid, the body force and the time "
             "step? Computed beside the run, from t = 0 on.")
ON_DEMAND = lazy("Which part of the error have crossings made, and which the coarse grid and the time step? Found "
                 "beside your stage, from t = 0 to the end of the scene.")
WAITING = lazy("The run starts again, with the errors of each cause.")
PINNED, THIS = (lazy("pinned"), lazy("pinned: {run}")), (lazy("this run"), lazy("this run: {run}"))
_NAMES = {"x": lazy("displacement x"), "v": lazy("velocity v"), "F": lazy("deformation F, which sets the stress")}


class BudgetPanel(Feature):
    """Error budget of one visitor's run: ``state`` returns the state shown, ``show`` puts another one on the stage."""

    def __init__(self, gui: viser.GuiApi, session: RunSession, state: Callable[[], State],
                 show: Callable[[State], None], clock: Callable[[], float] = monotonic,
                 budgets: SharedBudgets = SHARED):
        self._session, self._state, self._show, self._clock, self._budgets = session, state, show, clock, budgets
        self.jobs = BudgetJobs()
        self.messages = {"budget": self.on_button_click}
        self._followed, self._drawn_at = "", -math.inf
        self._numbers: ReadoutContent | None = None  # the last ones
        self._in_lesson = self._asked = False
        self._rests: tuple[Scene | None, float] = None, 0.0  # the scene on the stage, and since when it is that
        self._line = gui.add_html("")
        budgets.open(lambda: session.links.playing)
        self._mark = gui.add_html(widget_marker_html("lab-budget"))
        self._fold = gui.add_folder(tr(QUESTION), expand_by_default=False)
        with self._fold:
            self._offer = gui.add_html(_offer_html(OFFER))
            self._find = gui.add_button(tr("Find out"),
                                        hint=tr("with the causes' errors beside the run, from t = 0 on"))
            self._cancel = gui.add_button(tr("Cancel"), hint=tr("keep the current result"))
            self._field = gui.add_dropdown(
                tr("Divide the error of"), tuple(map(tr, _NAMES.values())),
                hint=tr("it follows the quantity on the stage, as far as that has a budget"))
            self._chart = gui.add_html("")
            self._cause = gui.add_dropdown(tr("Suspect"), tuple(map(tr, CAUSES.values())),
                                           hint=tr("the cause that is taken out of the run"))
            self._again = gui.add_button(tr("Take it away and run again"), hint=tr(
                "the same scene without this cause, from t = 0; the run as it is stays beside it"))
            self._outcome = gui.add_html("")
            self._back = gui.add_button(tr("Put it back"), hint=tr("the scene as it is, by itself"))
        self._cancel.on_click(lambda _: self.jobs.cancel())
        self._find.on_click(lambda _: self.request_budget())
        self._again.on_click(lambda _: self._remove_cause())
        self._back.on_click(lambda _: self._show(replace(
            state := self._state(), scene=_scene_without(NOTHING, state.scene), pinned=None)))
        self._field.on_update(lambda _: setattr(self, "_drawn_at", -math.inf))

    @classmethod
    def build(cls, page: PageContext) -> "BudgetPanel":
        page.controls.add_extension("estimators", lambda: page.gui.add_html(budget_button_html()))
        return cls(page.gui, page.session, lambda: page.controls.state, page.controls.show)

    def close(self) -> None:
        self.jobs.close()
        self._budgets.close()

    def on_button_click(self, message: object) -> None:
        """Requests a budget at the click on *Who made this error?*: the ``message`` is then True."""
        if message is True:
            self._asked = True
            self.request_budget()

    def request_budget(self) -> None:
        """Starts the error budget of the run on the stage, and of a pinned run beside it, where it is missing."""
        state = self._state()
        if EFFECT not in state.scene.OWN_EFFECTS:
            if self.jobs.status.scene != state.scene or self.jobs.status.series is None:
                self.jobs.start_budget(state.scene)
        elif EFFECT not in state.scene.effects and (self._in_lesson or self._has_none(state.scene)):
            self._show(replace(state, scene=_with_budget(state.scene),
                               pinned=None if state.pinned is None else _with_budget(state.pinned)))

    def _has_none(self, scene: Scene) -> bool:
        """Whether no budget of a scene is computed beside it."""
        return self._budgets.find(scene, self._numbers.now.time if self._numbers else 0.0, starts=True) == {}

    def refresh(self, view: VisiblePageState) -> None:
        """Shows the budget of the run on the stage; in a lesson only if the run records it."""
        self._numbers, self._in_lesson = view.numbers or self._numbers, view.in_lesson
        if (numbers := self._numbers) is None:
            return
        line = self._line_html(view, numbers)
        if view.numbers is None and line == self._line.content:
            return
        self._line.content = line
        choice = view.choice
        scene = self._session.scene if numbers.scene is not None else None
        own = scene is not None and EFFECT in scene.OWN_EFFECTS
        on = scene is not None and EFFECT in scene.effects
        found = self._status_after_cancelling_stale(scene)
        _set_visible(scene is not None and (on or not view.in_lesson), self._mark, self._fold)
        if scene is None or not self._fold.visible:
            return
        runs = _computed_runs(found) if not own else self._recorded_runs(numbers, scene, choice.latest) if on else \
            self._runs_beside(scene, numbers)
        _set_visible(not on and not runs and not found.running, self._find)
        _set_visible(not own and found.running, self._cancel)
        _set_visible(not runs or (not own and (found.running or bool(found.trouble))), self._offer)
        _set_visible(on or bool(runs), self._field)
        _set_visible(bool(runs), self._chart)
        _set_visible(bool(runs) and not found.running, self._cause, self._again)
        _set_visible(own and removed_cause(scene) != NOTHING, self._back)
        # The reason why there is no chart.
        reason = next((text for text in scene.warnings() if text.startswith("error budget")), "") if own and on else ""
        why = f"<p class='lab-budget-offer'>{escape(as_sentence(translate_message(reason).partition(': ')[2]))}</p>" \
            if reason else ""
        self._offer.content = why or _offer_html(WAITING if on else OFFER) if own else \
            _status_html(found) or _offer_html(ON_DEMAND)
        if choice.quantity != self._followed:  # show the budget of its field
            self._followed, self._drawn_at = choice.quantity, -math.inf
            self._field.value = tr(_NAMES[budget_field(choice.quantity)])  # type: ignore[misc]
        self._draw(runs, self._removed_cause_between(runs) if own else found.cause, on, numbers.now.playing)

    def _line_html(self, view: VisiblePageState, numbers: ReadoutContent) -> str:
        """Returns the line for the instant shown; computes a budget once the scene has been the same for a while."""
        scene, time = self._session.scene, numbers.now.time
        if scene != self._rests[0]:
            self._rests = scene, self._clock()
        recorded = EFFECT in scene.effects
        if numbers.scene is None or (view.in_lesson and not recorded):
            return ""
        if recorded:
            past = numbers.past
            series = past.series if past is not None and past.scene == scene and has_budget(past.series) else None
        elif EFFECT in scene.OWN_EFFECTS:
            series = self._budgets.find(scene, time, starts=self._clock() > self._rests[1] + REST)
        else:
            status = self.jobs.status
            series = status.series if status.scene == scene else None
            if series is None and not status.running:
                return budget_line_html(tr(ON_REQUEST))
        return budget_line_html(BEING_FOUND) if series is None else budget_line_at(series, view.choice.quantity, time)

    def _runs_beside(self, scene: Scene, numbers: ReadoutContent) -> list[RunBudget]:
        """Returns the pinned run and the one on the stage until now, as far as their budgets have been computed beside
        them; that of a pinned run once the visitor has asked."""
        time, pinned = numbers.now.time, numbers.pinned.scene if numbers.pinned and self._asked else None
        named = [("", scene)] if pinned is None else [
            (_run_name(PINNED, pinned, scene), pinned), (_run_name(THIS, scene, pinned), scene)]
        found = [(name, one, series_until(self._budgets.find(one, time, starts=one == pinned) or {}, time))
                 for name, one in named]
        return [RunBudget(name, one, series, series) for name, one, series in found if has_budget(series)]

    def _status_after_cancelling_stale(self, scene: Scene | None) -> BudgetJobStatus:
        """Returns the jobs' status for a scene; if they are about another one, cancels them."""
        status = self.jobs.status
        if status.scene == scene:
            return status
        self.jobs.cancel()
        return BudgetJobStatus()

    def _draw(self, runs: list[RunBudget], cause: str, on: bool, playing: bool) -> None:
        """Draws the chart of the runs, and the outcome of leaving ``cause`` out of the second; ``on``: recorded."""
        field, now = next(field for field, name in _NAMES.items() if tr(name) == self._field.value), self._clock()
        if not runs:
            self._drawn_at = -math.inf
            self._mark.content = widget_marker_html("lab-budget", words="" if on else tr("not asked yet"))
            self._outcome.content = ""
        elif not playing or now >= self._drawn_at + REDRAWN:
            self._drawn_at = now
            # The run on the stage first; one without a cause after the run as it is, as its outcome below.
            self._chart.content = budget_chart(runs[::-1] if on and cause == NOTHING else runs, field)
            most = largest_share(runs[-1].series, field)  # the largest cause
            words = cause_labels(budget_shares.has_crossed(runs[-1].series))
            self._mark.content = widget_marker_html("lab-budget", words=tr("not valid here") if most is None else
                                                    f"{tr(words[most[0]])} {format_percent(most[1])}")
            self._outcome.content = "" if cause == NOTHING or len(runs) < 2 else \
                removal_outcome(runs[0], runs[-1], field, cause)

    @staticmethod
    def _removed_cause_between(runs: list[RunBudget]) -> str:
        """Returns the cause that the second of two otherwise equal runs leaves out, else ``NOTHING``."""
        if len(runs) < 2:
            return NOTHING
        before, again = (run.scene for run in runs)
        return removed_cause(again) if before == _scene_without(NOTHING, again) else NOTHING

    def _recorded_runs(self, numbers: ReadoutContent, scene: Scene, latest: bool) -> list[RunBudget]:
        """Returns the pinned run and the one on the stage, if they have a budget; ``latest`` plots their end only."""
        past, pinned = numbers.past, numbers.pinned
        if past is None or past.scene != scene or not has_budget(past.series) \
                or not has_budget(past.latest_periods_series):
            return []
        both = []
        if pinned is not None and has_budget(pinned.history.series) \
                and has_budget(pinned.history.latest_periods_series):
            both = [RunBudget(_run_name(PINNED, pinned.scene, scene), pinned.scene, pinned.history.series,
                              pinned.history.latest_periods_series if latest else pinned.history.series)]
        name = "" if pinned is None or not both else _run_name(THIS, scene, pinned.scene)
        return [*both, RunBudget(name, scene, past.series, past.latest_periods_series if latest else past.series)]

    def _remove_cause(self) -> None:
        """Runs the scene again without the selected cause."""
        state = self._state()
        suspect = next(cause for cause, words in CAUSES.items() if tr(words) == self._cause.value)
        if EFFECT not in state.scene.OWN_EFFECTS:
            self.jobs.start_budget(state.scene, suspect)
            return
        before = _scene_without(NOTHING, _with_budget(state.scene))
        try:
            after = _scene_without(suspect, before)
        except SceneError as error:
            self._session.refuse(tr("Take it away: {reason}", reason=translate_message(str(error))))
        else:
            self._show(replace(state, scene=after, pinned=before))


def _computed_runs(status: BudgetJobStatus) -> list[RunBudget]:
    """Returns the run of a finished job, and the one without a cause, if any; none before its end."""
    if status.scene is None or status.series is None:
        return []
    runs = {"": status.series} if status.again is None else {
        tr("as it is"): status.series, tr("without {cause}", cause=tr(CAUSES[status.cause])): status.again}
    return [RunBudget(name, status.scene, series, series) for name, series in runs.items()]


def _status_html(status: BudgetJobStatus) -> str:
    """Returns the progress or the failure of a job as html; "" if there is neither."""
    if status.running:
        return f"<p class='lab-budget-offer' role='status'>" \
               f"{tr('Being computed in the background: {share}', share=format_percent(status.part))}</p>"
    said = tr("It was cancelled") if status.cancelled else status.trouble
    return f"<p class='lab-budget-offer' role='alert'>{escape(as_sentence(said.removesuffix('.')))}</p>" if said else ""


def _with_budget(scene: Scene) -> Scene:
    return replace(scene, effects=(*scene.effects, EFFECT)) if EFFECT not in scene.effects else scene


def _scene_without(cause: str, scene: Scene) -> Scene:
    """Returns the scene with ``cause``, a key or ``NOTHING``, left out of its run."""
    change: dict[str, Any] = {"take_away": cause}
    return replace(scene, **change) if removed_cause(scene) != cause else scene


def _run_name(name: tuple[str, str], scene: Scene, other: Scene) -> str:
    said = difference_text(scene, other)
    return tr(name[bool(said)], run=said)


def _offer_html(text: str) -> str:
    return f"<p class='lab-budget-offer'>{tr(text)}</p>"


def _set_visible(visible: bool, *widgets: Any) -> None:
    for widget in widgets:
        widget.visible = visible  # viser sends nothing if the value is unchanged
