"""The widgets by which a question of a lesson is answered."""

import math
from contextlib import suppress
from html import escape
from string import ascii_lowercase
from typing import Any

import viser

from app.lessons.lesson import CHOICE, DRAG, INTERVAL, NAMES, POWERS, REACH, TEXT, Numbers, Question, filled
from app.words import PREFIXES, SYMBOLS, size_in

UNANSWERED = "choose one"


class AnswerWidgets:
    """Made where the gui stands. ``value`` is what they say now: None, or a text, where it is no answer yet."""

    def __init__(self, gui: viser.GuiApi, asked: Question, numbers: Numbers, answer: Any, fixed: bool):
        self._asked = asked
        self.texts: list[viser.GuiTextHandle] = []
        label = f"Answer, {asked.unit}" if asked.unit else "Answer"
        if asked.kind == CHOICE:
            options = tuple(f"{letter}) {filled(option, numbers)}"
                            for letter, option in zip(ascii_lowercase, asked.options, strict=False))
            rows = "".join(f"<li>{escape(option)}</li>" for option in options)  # a box may be too narrow for them
            gui.add_html(f"<div class='lab-lesson'><ul class='lab-options'>{rows}</ul></div>")
            self._choices = {option: k for k, option in enumerate(options, 1)}
            self._widget: Any = gui.add_dropdown("Answer", (UNANSWERED, *options), disabled=fixed,
                                                 initial_value=options[answer - 1] if answer else UNANSWERED)
        elif asked.kind == DRAG:
            self._build_slider(gui, answer, fixed)
        elif asked.kind == INTERVAL:
            ends = answer or ("", "")
            self.texts = [gui.add_text(f"{side}{f', {asked.unit}' * bool(asked.unit)}", _shown(end), disabled=fixed)
                          for side, end in zip(("At least", "At most"), ends, strict=True)]
        else:
            hint = f"a number in {asked.unit}; as the page writes it, with its unit, will do" if asked.unit else ""
            self.texts = [gui.add_text(label, _shown(answer), multiline=asked.kind == TEXT, disabled=fixed,
                                       hint=hint or None)]

    @property
    def value(self) -> Any:
        asked = self._asked
        if asked.kind == CHOICE:
            return self._choices.get(self._widget.value)
        if asked.kind == DRAG:
            return self._dragged(float(self._widget.value))
        found = [text.value if asked.kind == TEXT else _number(text.value, asked.unit) for text in self.texts]
        return found if asked.kind == INTERVAL else found[0]

    def _build_slider(self, gui: viser.GuiApi, answer: Any, fixed: bool) -> None:
        control = self._asked.control
        low, high, step = REACH[control]
        start = 0.5 * (low + high) if answer is None else math.log10(answer) if control in POWERS else answer
        start = low + step * round((start - low) / step)
        name = SYMBOLS.get(control, "")
        self._shown = gui.add_html("")
        self._widget = gui.add_slider(f"{NAMES[control]} {name}".strip(), low, high, step, start, disabled=fixed)
        self._widget.on_update(lambda _: self._say())
        self._say()

    def _say(self) -> None:
        value = self._dragged(float(self._widget.value))
        self._shown.content = f"<div class='lab-lesson'>{NAMES[self._asked.control]}: <b>{value:g}</b> " \
                              f"{self._asked.unit}</div>"

    def _dragged(self, at: float) -> float:
        return float(f"{10**at:.3g}") if self._asked.control in POWERS else round(at)


def _shown(answer: Any) -> str:
    return "" if answer is None else answer if isinstance(answer, str) else f"{answer:g}"


def _number(text: str, unit: str) -> float | None:
    """A number, also with a decimal comma, or a size as the page writes it: 2.75 mm/s."""
    plain = text.strip().replace(",", ".").replace("−", "-")
    with suppress(ValueError):
        return float(plain)
    for power, prefix in PREFIXES.items():  # that unit, or another of its prefixes: 330 nm where µm are asked for
        with suppress(ValueError):
            if unit.startswith(prefix) and unit != prefix:
                return size_in(plain, unit.removeprefix(prefix)) / 1000.0**power
    return None
