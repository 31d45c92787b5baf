"""Who made this error? A fold with the chart of the error budget, and a cause to take away and run again without: the
first run stays pinned beside the second, with what the budget has foretold and what has come."""

import math
from collections.abc import Callable
from dataclasses import replace
from html import escape
from time import monotonic
from typing import Any

import viser

from app.frame.budget import QUESTION, divided, field_of, largest_share, percent
from app.page.measurements import Numbers
from app.page.panels.budget_chart import Divided, chart, outcome, taken_away
from app.page.panels.marks import marked
from app.page.source import Choice
from app.page.visit.session import Session
from app.state import State
from app.words import differing
from solvers.problems import PROBLEMS
from solvers.scene.causes import CAUSES, NOTHING
from solvers.scene.rules import SceneError
from solvers.scene.scene import Scene

EFFECT = "budget"
REDRAWN = 0.9  # seconds between two charts of a run that plays
#: Below the judges' cards: it opens the fold (``js/budget.js``).
WHO = (f"<button type='button' class='lab-who'><b>{QUESTION}</b> <span>crossings, grid, body force or time step"
       "</span></button>")
OFFER = ("<p class='lab-budget-offer'>Which part of the error have crossings made, and which the coarse grid, the body "
         "force and the time step? Computed beside the run, from t = 0 on.</p>")
WAITING = "<p class='lab-budget-offer'>The run begins again, with the errors of each cause beside it.</p>"
_NAMES = {"x": "displacement x", "v": "velocity v", "F": "deformation F"}


class BudgetFold:
    """Widgets of one visitor. ``state`` is what is seen, ``show`` puts another state on the stage."""

    def __init__(self, gui: viser.GuiApi, session: Session, state: Callable[[], State], show: Callable[[State], None],
                 clock: Callable[[], float] = monotonic):
        self._session, self._state, self._show, self._clock = session, state, show, clock
        self._followed, self._drawn_at = "", -math.inf
        self._mark = gui.add_html(marked("lab-budget"))
        self._fold = gui.add_folder(QUESTION, expand_by_default=False)
        with self._fold:
            self._offer = gui.add_html(OFFER)
            self._find = gui.add_button("Find out", hint="switch the effect error budget on: the run begins again")
            self._field = gui.add_dropdown("Divide the error of", tuple(_NAMES.values()),
                                           hint="it follows the quantity on the stage, as far as that has a budget")
            self._chart = gui.add_html("")
            self._cause = gui.add_dropdown("Suspect", tuple(CAUSES.values()),
                                           hint="the cause that is taken out of the run")
            self._again = gui.add_button("Take it away and run again", hint="the same scene without this cause, from "
                                         "t = 0; the run as it is stays beside it")
            self._outcome = gui.add_html("")
            self._back = gui.add_button("Put it back", hint="the scene as it is, by itself")
        self._find.on_click(lambda _: self.find_out())
        self._again.on_click(lambda _: self._take_away())
        self._back.on_click(lambda _: self._put_back())
        self._field.on_update(lambda _: self._redraw())

    def press(self, said: object) -> None:
        """The visitor has asked who made the error."""
        if said is True:
            self.find_out()

    def find_out(self) -> None:
        """Divide the error of the run, and of one that is pinned beside it."""
        state = self._state()
        if EFFECT in state.scene.OWN_EFFECTS and EFFECT not in state.scene.effects:
            self._show(replace(state, scene=_with_budget(state.scene),
                               pinned=None if state.pinned is None else _with_budget(state.pinned)))

    def show(self, numbers: Numbers, choice: Choice, studying: bool) -> None:
        """Show what is known of a run's budget. While one is ``studying`` there is only what the lesson has asked
        for."""
        scene = self._session.scene if numbers.scene is not None else None
        on = scene is not None and EFFECT in scene.effects
        offered = scene is not None and EFFECT in PROBLEMS[scene.problem].scene.OWN_EFFECTS and (on or not studying)
        _see(offered, self._mark, self._fold)
        if scene is None or not offered:
            return
        runs = self._runs(numbers, scene, choice.latest) if on else []
        _see(not on, self._find)
        _see(not runs, self._offer)
        _see(on, self._field)
        _see(bool(runs), self._chart, self._cause, self._again)
        _see(taken_away(scene) != NOTHING, self._back)
        _say(self._offer, _missing(scene) if on else OFFER)
        self._follow(choice.quantity)
        field = self._shown_field
        now = self._clock()
        if not runs:
            self._drawn_at = -math.inf
            _say(self._mark, marked("lab-budget", words="" if on else "not asked yet"))
            _say(self._outcome, "")
        elif not numbers.now.playing or now >= self._drawn_at + REDRAWN:
            self._drawn_at = now
            _say(self._chart, chart(runs, field))
            _say(self._mark, marked("lab-budget", words=_verdict(runs[-1], field)))
            before, again = runs[0], runs[-1]
            pair = len(runs) > 1 and taken_away(again.scene) != NOTHING and before.scene == _whole(again.scene)
            _say(self._outcome, outcome(before, again, field) if pair else "")

    @property
    def _shown_field(self) -> str:
        return next(field for field, name in _NAMES.items() if name == self._field.value)

    def _follow(self, quantity: str) -> None:
        """Another quantity is on the stage: its field is divided."""
        if quantity != self._followed:
            self._followed, self._drawn_at = quantity, -math.inf
            self._field.value = _NAMES[field_of(quantity)]  # type: ignore[misc]

    def _redraw(self) -> None:
        self._drawn_at = -math.inf

    def _runs(self, numbers: Numbers, scene: Scene, latest: bool) -> list[Divided]:
        """A pinned run with a budget, and the one on the stage, if that has one yet."""
        past, pinned = numbers.past, numbers.pinned
        if past is None or past.scene != scene or not divided(past.series) or not divided(past.latest):
            return []
        both = [] if pinned is None or not divided(pinned.history.series) or not divided(pinned.history.latest) else [
            Divided(_named("pinned", pinned.scene, scene), pinned.scene, pinned.history.series,
                    pinned.history.latest if latest else pinned.history.series)]
        name = "" if pinned is None or not both else _named("this run", scene, pinned.scene)
        return [*both, Divided(name, scene, past.series, past.latest if latest else past.series)]

    def _take_away(self) -> None:
        state = self._state()
        before = _whole(state.scene)
        changes: dict[str, Any] = {
            "take_away": next(cause for cause, words in CAUSES.items() if words == self._cause.value)}
        try:
            after = replace(before, **changes)
        except SceneError as error:
            self._session.refuse(f"Take it away: {error.sentence}")
        else:
            self._show(replace(state, scene=after, pinned=before))

    def _put_back(self) -> None:
        state = self._state()
        self._show(replace(state, scene=_whole(state.scene), pinned=None))


def _with_budget(scene: Scene) -> Scene:
    return replace(scene, effects=(*scene.effects, EFFECT)) if EFFECT not in scene.effects else scene


def _whole(scene: Scene) -> Scene:
    """The scene with nothing taken away."""
    nothing: dict[str, Any] = {"take_away": NOTHING}
    return replace(scene, **nothing) if taken_away(scene) != NOTHING else scene


def _named(name: str, scene: Scene, other: Scene) -> str:
    return f"{name}: {differing(scene, other)}".removesuffix(": ")


def _verdict(run: Divided, field: str) -> str:
    """Who has made most of the error, for the right of the fold's name."""
    found = largest_share(run.series, field)
    return "not valid here" if found is None else f"{CAUSES[found[0]]} {percent(found[1])}"


def _missing(scene: Scene) -> str:
    """Why there is no chart yet, or cannot be one."""
    reason = next((text for text in scene.warnings() if text.startswith("error budget")), "")
    return f"<p class='lab-budget-offer'>{escape(reason.partition(': ')[2].capitalize())}.</p>" if reason else WAITING


def _see(visible: bool, *widgets: Any) -> None:
    for widget in widgets:
        if widget.visible != visible:
            widget.visible = visible


def _say(html: viser.GuiHtmlHandle, content: str) -> None:
    if html.content != content:
        html.content = content
