"""What can be undone, as which steps, and what the button says. No page: the state is what a test says it is."""

from dataclasses import replace
from html import unescape

import pytest

from app.page.features.undo import MOST, TOGETHER, Undo, describe_change
from app.shareable_state import State, parse_state
from tests.app.page.panel import Gui, page_view

BAR = parse_state("bar;method=mpm;amplitude=0.0034;estimators=recovered,companion;error-of=sigma")


def changed(state: State = BAR, **fields) -> State:
    """The state with other fields of its scene."""
    return replace(state, scene=replace(state.scene, **fields))


class Visitor:
    """Changes the state, and looks at the page in between."""

    def __init__(self):
        self.state, self.time, self.touring = BAR, 0.0, False
        self.undo = Undo(Gui(), lambda: self.state, lambda state: setattr(self, "state", state), lambda: self.touring,
                         lambda: self.time)
        self.show(BAR)

    def show(self, state: State, after: float = 10.0, alone: bool = True) -> str:
        """What the button says once the state is on the stage, "" where it is not shown."""
        self.state, self.time = state, self.time + after
        self.undo.refresh(page_view(alone))
        return unescape(self.undo._html.content.split("'")[3]).removeprefix("Undo: ")

    def press(self) -> str:
        self.undo.undo()
        return self.show(self.state)


def test_changes_of_one_slider_in_a_row_are_one_step():
    visitor = Visitor()
    for amplitude in (0.0036, 0.004, 0.005):
        said = visitor.show(changed(amplitude=amplitude), after=0.9 * TOGETHER)
    assert said == "Amplitude A, 3.4 mm to 5 mm"
    assert visitor.show(changed(amplitude=0.006)) == "Amplitude A, 5 mm to 6 mm", "later"
    assert visitor.press() == "Amplitude A, 3.4 mm to 5 mm" and visitor.state == changed(amplitude=0.005)
    assert visitor.press() == "" and visitor.state == BAR
    visitor.undo.undo()
    assert visitor.state == BAR, "nothing is left"


def test_nothing_is_to_be_undone_of_what_is_put_back_at_once():
    visitor = Visitor()
    visitor.show(changed(cells=60))
    for amplitude, said in ((0.004, "Amplitude A, 3.4 mm to 4 mm"), (0.0034, "Cells, 40 to 60")):
        assert visitor.show(changed(cells=60, amplitude=amplitude), after=0.9 * TOGETHER) == said


@pytest.mark.parametrize("after, said", [
    (changed(method="bspline"), "Method, MPM (hat functions) to B-spline"), (changed(cells=80), "Cells, 40 to 80"),
    (changed(cfl=0.5), "CFL number, 0.05 to 0.5"), (changed(cfl=None, dt=1e-3), "CFL number, 0.05 to 0.08"),
    (replace(BAR, estimator="companion"), "On the stage, recovered to companion"),
    (replace(BAR, compared="bspline"), "Compare with, nothing to B-spline"),
    (replace(BAR, pinned=BAR.scene), "back to the run as it was"),
    (changed(method="ugimp", cells=80), "back to MPM (hat functions), 40 cells"),
    (changed(estimators=()), "Estimator, recovered, companion to none"),
    (parse_state("ring"), "back to the vibrating bar")])
def test_what_is_undone_is_said(after, said):
    visitor = Visitor()
    assert visitor.show(after) == said
    assert visitor.press() == "" and visitor.state == BAR


def test_what_is_no_change_of_the_run_is_no_step():
    for after in (replace(BAR, magnified=10), replace(BAR, speed=2.0), replace(BAR, traced=3),
                  replace(BAR, quantity="x", estimator="companion")):
        assert describe_change(BAR, after) == (None, "")


def test_a_tour_or_a_lesson_begins_anew_and_so_many_steps_are_kept():
    visitor = Visitor()
    assert visitor.show(changed(cells=80)) and not visitor.show(changed(cells=60), alone=False)
    assert not visitor.show(changed(cells=60)) and visitor.show(changed(cells=50))
    visitor.touring = True
    assert not visitor.show(changed(cells=40))
    visitor.touring = False
    for cells in range(20, 22 + MOST):
        visitor.show(changed(cells=cells))
    presses = 0
    while visitor.press():
        presses += 1
    assert presses == MOST - 1
