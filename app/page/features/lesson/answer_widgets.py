"""The widgets for answering a question of a lesson."""

import math
from collections.abc import Callable
from contextlib import suppress
from html import escape
from typing import Any

import viser

from app.language.translation import tr
from app.lessons import lesson
from app.lessons.lesson import Numbers, Question, Step, fill_numbers
from app.names_and_units import PREFIXES, SYMBOLS, parse_size, with_unit
from app.page.features.lesson import step_html as page
from solvers.scene.scene import Scene
from solvers.untrusted import number_parsing

SHORT = 4  # digits of a number beside the stage
LOGARITHMIC = "<i class='lab-logarithmic'></i>"  # a slider whose number box would show a logarithm, and is hidden
ENTER = "<i class='lab-enter'></i>"  # before a text in which Enter presses the main button


class AnswerWidgets:
    """Widgets for the answer to a ``step``'s question. ``answer`` is the one given so far, or None, and cannot be
    changed if ``fixed``; ``stage`` returns the scene on the stage, ``lang`` is a lang attribute for html, or ""."""

    def __init__(self, gui: viser.GuiApi, step: Step, numbers: Numbers, answer: Any, fixed: bool,
                 stage: Callable[[], Scene], lang: str = ""):
        self._question, self._stage = step.asked_question, stage
        self._chosen: int | None = answer if self._question.kind == lesson.CHOICE else None
        self.texts: list[viser.GuiTextHandle] = []
        self._note: viser.GuiHtmlHandle | None = None
        self._slider: Any = None
        asked = self._question
        if asked.kind == lesson.CHOICE:
            options = [fill_numbers(option, numbers) for option in asked.options]
            gui.add_html(page.choices_html(options, answer, fixed, step.key, lang))
        elif asked.kind == lesson.DRAG:
            self._note = gui.add_html("")
            if step.kind == lesson.PREDICT:  # about a run to come
                self._build_slider(gui, answer, fixed)
            self.refresh()
        elif asked.kind == lesson.INTERVAL:
            ends = answer or ("", "")
            gui.add_html(ENTER)
            self.texts = [gui.add_text(f"{side}{f', {asked.unit}' * bool(asked.unit)}", _format_answer(end),
                                       disabled=fixed, hint=_hint(asked))
                          for side, end in zip((tr("At least"), tr("At most")), ends, strict=True)]
        else:
            label = tr("Answer, {unit}", unit=asked.unit) if asked.unit else tr("Answer")
            gui.add_html(ENTER)
            self.texts = [gui.add_text(label, _format_answer(answer), multiline=asked.kind == lesson.TEXT,
                                       disabled=fixed, hint=_hint(asked))]

    @property
    def value(self) -> Any:
        """The answer: an option from 1, number, two numbers, or text; None where missing or invalid."""
        asked = self._question
        if asked.kind == lesson.CHOICE:
            return self._chosen
        if asked.kind == lesson.DRAG:
            return self._control_value
        found = [text.value if asked.kind == lesson.TEXT else parse_number(text.value, asked.unit)
                 for text in self.texts]
        return found if asked.kind == lesson.INTERVAL else found[0]

    def choose(self, option: Any) -> None:
        """Selects the option of this number, from 1; ignores invalid input."""
        if self._question.kind == lesson.CHOICE and type(option) is int and 1 <= option <= len(self._question.options):
            self._chosen = option

    def refresh(self) -> None:
        """Updates the text on the value that the slider or the stage has."""
        if self._note is None:
            return
        there, name = self._control_value, _control_label(self._question.control)
        if there is None:
            told = tr("The stage has no {name}: put the run there first.", name=name)
        else:
            value = escape(in_unit(there, self._question.unit))
            told = tr("Your value: {name} = <b>{value}</b>", name=name, value=value) if self._slider else \
                tr("The stage has {name} = <b>{value}</b>", name=name, value=value)
        self._note.content = f"<div class='lab-lesson lab-there'>{told}</div>"

    @property
    def _control_value(self) -> float | None:
        """The control's value in the question's unit, from the slider or the stage; None if there is none."""
        control = self._question.control
        if self._slider is not None:
            at = float(self._slider.value)
            return float(f"{10**at:.3g}") if control in lesson.POWERS else round(at)
        scene = self._stage()
        if control == "amplitude" and control not in scene.motion_fields:
            return None
        found = scene.courant_number if control == "cfl" else getattr(scene, control)
        return None if found is None else float(found)

    def _build_slider(self, gui: viser.GuiApi, answer: Any, fixed: bool) -> None:
        control = self._question.control
        low, high, step = lesson.REACH[control]
        start = 0.5 * (low + high) if answer is None else math.log10(answer) if control in lesson.POWERS else answer
        start = low + step * round((start - low) / step)
        if control in lesson.POWERS:
            gui.add_html(LOGARITHMIC)
        self._slider = gui.add_slider(_control_label(control), low, high, step, start, disabled=fixed)
        self._slider.on_update(lambda _: self.refresh())


def in_unit(value: float, unit: str) -> str:
    """Returns a value with its SI ``unit``, or "", in four digits."""
    return with_unit(value, unit, SHORT) if unit else f"{value:.{SHORT}g}"


def parse_number(text: str, unit: str) -> float | None:
    """Parses a number in ``unit``, also with a decimal comma, or with its own unit (2.75 mm/s); None if invalid."""
    plain = text.strip().replace(",", ".").replace("−", "-")
    with suppress(ValueError):
        return number_parsing.parse_float(plain)
    for power, prefix in PREFIXES.items():  # that unit, or another of its prefixes: 330 nm where µm are asked for
        with suppress(ValueError):
            if unit.startswith(prefix) and unit != prefix:
                return parse_size(plain, unit.removeprefix(prefix)) / 1000.0**power
    return None


def _format_answer(answer: Any) -> str:
    return "" if answer is None else answer if isinstance(answer, str) else f"{answer:g}"


def _hint(asked: Question) -> str | None:
    return tr("a number in {unit}; as the page writes it, with its unit, will do", unit=asked.unit) if asked.unit \
        else None


def _control_label(control: str) -> str:
    """Returns the translated name of a control, by its key, with its symbol."""
    return f"{tr(lesson.NAMES[control])} {SYMBOLS.get(control, '')}".strip()
