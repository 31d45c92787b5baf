"""A question's widgets: what the stage has is the answer to where a control was left, and sizes may have any prefix."""

from dataclasses import replace

import pytest
import viser

from app import shareable_state
from app.lessons import catalogue
from app.lessons.answer_marking import format_answer, mark_answer, why_invalid
from app.lessons.lesson import DRAG, PREDICT
from app.lessons.lesson_runs import RunCache
from app.page.features.lesson.answer_widgets import AnswerWidgets, parse_number
from solvers.workers.worker_process import free_port


@pytest.fixture(scope="module")
def gui():
    server = viser.ViserServer(port=free_port(), verbose=False)
    yield server.gui
    server.stop()


@pytest.fixture(scope="module")
def dragged():
    lesson = catalogue.load_lesson("04-grid-crossing")
    [step] = [step for step in lesson.steps if step.question and step.question.kind == DRAG]
    return lesson, step


def test_where_a_control_is_left_is_what_the_stage_has(gui, dragged):
    """In the stage's units, and it follows the stage."""
    lesson, step = dragged
    on_stage = ["bar;method=mpm;amplitude=0.0032"]
    widgets = AnswerWidgets(gui, step, {}, None, False, lambda: shareable_state.parse_state(on_stage[0]).scene)
    assert widgets.value == 0.0032 and "The stage has Amplitude A = <b>3.2 mm</b>" in widgets._note.content
    assert mark_answer(lesson, step, widgets.value, {}, RunCache()).right is True
    on_stage[0] = "bar;amplitude=0.002"
    widgets.refresh()
    assert widgets.value == 0.002 and "<b>2 mm</b>" in widgets._note.content
    assert mark_answer(lesson, step, widgets.value, {}, RunCache()).right is False
    on_stage[0] = "bar;motion=patch"
    widgets.refresh()
    assert why_invalid(step.asked_question, widgets.value) and "put the run there first" in widgets._note.content


def test_a_prediction_of_a_control_is_a_slider(gui, dragged):
    step = replace(dragged[1], kind=PREDICT)
    widgets = AnswerWidgets(gui, step, {}, 0.01, False, lambda: shareable_state.parse_state("bar").scene)
    assert widgets.value == pytest.approx(0.01, rel=0.02)
    assert "Your value: Amplitude A = <b>10 mm</b>" in widgets._note.content
    strange = replace(step, question=replace(step.question, unit="<i>m</i>"))
    widgets = AnswerWidgets(gui, strange, {}, 0.01, False, lambda: shareable_state.parse_state("bar").scene)
    assert "&lt;i&gt;m" in widgets._note.content and "<i>" not in widgets._note.content


def test_only_an_option_that_there_is_can_be_chosen(gui):
    [step, *_] = [step for step in catalogue.load_lesson("04-grid-crossing").steps if step.question]
    widgets = AnswerWidgets(gui, step, {}, None, False, lambda: shareable_state.parse_state("bar").scene)
    for said in (0, 4, -1, True, 1.0, "1", None, [1], 10**9):
        widgets.choose(said)
        assert widgets.value is None
    widgets.choose(3)
    assert widgets.value == 3


@pytest.mark.parametrize("text, unit, value", [
    ("75.6 mPa", "Pa", 0.0756), ("75,6mPa", "Pa", 0.0756), ("0.0756", "Pa", 0.0756), ("330 nm", "µm", 0.33),
    ("0.33", "µm", 0.33), ("2.75 mm/s", "µm/s", 2750), ("3,2 mm", "m", 0.0032), ("12 %", "%", 12),
    ("much", "Pa", None)])
def test_a_size_is_read_with_any_prefix(text, unit, value):
    assert parse_number(text, unit) == (None if value is None else pytest.approx(value, rel=1e-12))


def test_an_answer_is_shown_as_the_page_writes_sizes():
    lesson = catalogue.load_lesson("04-grid-crossing")
    asked = next(step.question for step in lesson.steps if step.question and step.question.unit == "Pa")
    assert format_answer(asked, 0.0756) == "75.6 mPa"
    assert format_answer(replace(asked, kind="interval"), [0.0001, 0.025]) == "100 µPa to 25 mPa"
