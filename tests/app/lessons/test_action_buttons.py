"""What a lesson tells its reader to do, as buttons: each means what a widget would do."""

from __future__ import annotations

import re

import pytest

from app import shareable_state
from app.language.translation import ENGLISH, use_language
from app.lessons import catalogue
from app.lessons.lesson import draw_numbers, fill_numbers
from app.page.features.lesson import instruction_buttons
from app.page.features.lesson.instruction_buttons import (
    Instruction,
    budget_button_html,
    find_instructions,
    perform_instruction,
    run_on_stage_button_html,
    with_buttons,
)
from app.page.features.lesson.step_html import choices_html, lesson_list_html, step_html, text_html

SAID = "\n\n".join(("Words.", "- Press **On the stage**.", "- Set **Cells** to `80`.\n- Choose **Method** `B-spline`.",
                    "- Set **Particle** to `10`.\n- Press **Pause**.", "- Tick **Slow motion**."))


def test_what_can_be_done_is_a_button_and_the_rest_is_text():
    html = text_html(SAID, {})
    assert find_instructions(html) == [Instruction("Set", "Cells", "80"), Instruction("Choose", "Method", "B-spline"),
                                       Instruction("Press", "Pause", "")]
    shown = with_buttons(html)
    assert re.findall(r"data-act='(\w+)'", shown) == ["stage", "0", "1", "2"]
    assert run_on_stage_button_html() in shown and "Set <b>Cells</b> to <b>80</b></button>" in shown
    assert "Set <strong>Particle</strong> to <code>10</code>." in shown


def test_one_button_shows_a_phase_and_ticks_what_it_does():
    lesson = catalogue.load_lesson("01-one-step")
    step = next(step for step in lesson.steps if step.shown_phase)
    for done in (False, True):
        html = step_html(lesson, step, {}, "", False, done)
        button, does = html.index(">Show phase 2 of particle 10</button>"), html.index("<ul class='lab-does")
        assert button < does and html.count("<li", does) == 7 and ("<ul class='lab-does lab-did'" in html) == done


def test_who_made_the_error_is_asked_by_a_button():
    html = text_html("- Press **On the stage**.\n- Press **Who made this error?**\n", {})
    assert find_instructions(html) == [] and budget_button_html() in with_buttons(html)


class Hand:
    """Controls that only remember what was done with them."""

    def __init__(self, text: str):
        self.scene, self.done = shareable_state.parse_state(text).scene, []

    def set_field_from_text(self, field, said, meant):
        self.done.append((field, meant(self.scene)))

    def show_error(self, **what):
        self.done.append(next(iter(what.items())))

    def press(self, name):
        self.done.append(("press", name))


@pytest.mark.parametrize("act, meant", [
    (Instruction("Set", "Cells", "80"), ("cells", 80)), (Instruction("Set", "Particles / cell", "2.5"), ("ppc", 2.5)),
    (Instruction("Set", "Amplitude A", "0.16"), ("amplitude", 0.16)),
    (Instruction("Set", "Amplitude A", "3.2 mm"), ("amplitude", 0.0032)),
    (Instruction("Choose", "Method", "B-spline"), ("method", "bspline")),
    (Instruction("Choose", "Body force", "at the particles"), ("body_force", "material")),
    (Instruction("Choose", "Error of", "stress σ"), ("quantity", "sigma")),
    (Instruction("Choose", "On the stage", "recovered"), ("estimator", "recovered")),
    (Instruction("Press", "Reset", ""), ("press", "Reset"))])
def test_an_act_means_what_its_widget_would_do(act, meant):
    hand = Hand("bar")
    perform_instruction(act, hand)
    assert hand.done == [meant]


@pytest.mark.parametrize("core", [True, False], ids=["core", "all"])
@pytest.mark.parametrize("name", catalogue.lesson_names())
def test_every_act_of_a_lesson_can_be_done_in_its_scene(name, core):
    """Where the step's run is on the stage the value is one that the field may have; each run has a button. In the core
    alone the stage has only what the core has put there. A lesson in another language has the same acts."""
    for lesson in catalogue.load_every_language(name):
        with use_language(lesson.language):
            _done(lesson, core)


def _done(lesson, core):
    told = [
        [(act.verb, act.name) for act in find_instructions(text_html(step.text, draw_numbers(lesson, "")))]
        for step in lesson.steps
    ]
    with use_language(ENGLISH):
        assert told == [[(act.verb,
                          act.name) for act in find_instructions(text_html(step.text, draw_numbers(lesson, "")))]
                        for step in catalogue.load_lesson(lesson.name).steps]
    numbers, text = draw_numbers(lesson, ""), "bar"
    for step in lesson.steps_to_take(core):
        text = fill_numbers(step.stage, numbers) or text
        html = step_html(lesson, step, numbers, "", False)
        assert html.count(run_on_stage_button_html()) == bool(step.stage) or "data-act='phase'" in html
        hand = Hand(text)
        for act in find_instructions(text_html(step.text, numbers)):
            if act.name == "On the stage":
                assert act.value in hand.scene.estimators
            else:
                perform_instruction(act, hand)
                field, value = hand.done[-1]
                allowed = hand.scene.choices(field) if field in instruction_buttons.FIELDS.values() else ()
                assert not allowed or value in allowed


def test_answers_and_titles_are_escaped():
    html = choices_html(["<b>one", "two"], 2, False, "a'key")
    assert "&lt;b&gt;one" in html and html.count(" checked") == 1 and "data-question='a&#x27;key'" in html
    every = lesson_list_html(catalogue.load_lessons())
    assert every.count("class='lab-open'") == len(catalogue.lesson_names()) and "data-fingerprint=" in every
