"""Buttons for the instructions in a lesson's text, such as "Set **Cells** to `80`"."""

import itertools
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from html import unescape
from typing import Protocol

import viser

from app import names_and_units
from app.frame.budget_chart_data import QUESTION
from app.language.translation import ENGLISH, current_language, language_cache, lazy, tr, use_language, with_language
from app.lessons.lesson import ShownPhase
from app.lessons.markdown_html import FIELDS, SENTENCES
from app.names_and_units import parse_size, unit_of
from app.shareable_state import State
from solvers.scene.scene import Scene


class LessonControls(Protocol):
    """The methods of :class:`~app.page.controls.Controls` that lessons use."""

    @property
    def state(self) -> State:
        """The state that the visitor sees."""

    def show(self, state: State) -> None:
        """Puts a state on the stage."""

    def show_only(self, controls: tuple[str, ...], place: viser.GuiFolderHandle | None = None) -> None:
        """Shows only the ``controls`` of these names, in ``place``; with () all in their own tab."""

    def set_field_from_text(self, field: str, said: str, meant: Callable[[Scene], object]) -> None:
        """Sets a scene's field to what ``meant`` returns for the scene; ``said`` is the lesson's text."""

    def show_error(self, quantity: str = "", estimator: str = "") -> None:
        """Shows the error of a quantity by its key, or the error as estimated by an estimator of this name."""

    def press(self, name: str) -> None:
        """Triggers the playback button of this name: Play, Pause, Reset or Step."""


PUT, PHASE = "stage", "phase"  # messages of the buttons for a step's run
STAGE = lazy("On the stage")  # as a button it shows the step's run; as a choice, an estimator
LOOKS, PRESSED = (lazy("Error of"), STAGE), (lazy("Play"), lazy("Pause"), lazy("Reset"), lazy("Step"))
ASKED = QUESTION  # opens the error budget (``js/budget.js``)
NAMES = (*FIELDS, *LOOKS, *PRESSED, ASKED)


@dataclass(frozen=True)
class Instruction:
    """Instruction in a lesson: verb and control in English, and a value as written in its ``language``, or ""."""

    verb: str
    name: str
    value: str
    language: str = ENGLISH

    @property
    def has_button(self) -> bool:
        """Whether a button can carry it out; otherwise the reader must."""
        if self.verb == "Press":
            return self.name in PRESSED
        return bool(self.value) and (self.name in FIELDS or self.name in LOOKS)


def run_on_stage_button_html() -> str:
    """Returns the button that puts a lesson step's run on the stage."""
    return f"<button type='button' class='lab-act lab-put' data-act='stage'>{tr(STAGE)}</button>"


def phase_button_html(shown: ShownPhase) -> str:
    """Returns the button that puts a lesson step's run on the stage and shows a phase of its first time step."""
    name = tr("Show phase {phase} of particle {particle}", phase=shown.phase, particle=shown.particle)
    return f"<button type='button' class='lab-act lab-put lab-all' data-act='phase'>{name}</button>"


def list_below_phase_button(html: str, shown: ShownPhase, done: bool) -> str:
    """Returns a step's html with the button of its phase above the first list, which says what it does or has done."""
    kind = "lab-does lab-did" if done else "lab-does"
    before, acts, after = re.split("(?s)<ul>(.*?)</ul>", html, maxsplit=1)
    return f"{before}{phase_button_html(shown)}<ul class='{kind}' aria-label='{tr('what it does')}'>" \
           f"{re.sub('[.](?=</li>)', '', acts)}</ul>{after}"


def budget_button_html() -> str:
    """Returns the button that opens the error budget."""
    return f"<button type='button' class='lab-act' data-act='budget'>{tr(ASKED)}</button>"


def find_instructions(html: str) -> list[Instruction]:
    """Returns the instructions in a lesson step's html that a button can carry out, in order."""
    return [act for act in map(_parse_instruction, _instruction_pattern().finditer(html)) if act.has_button]


def with_buttons(html: str) -> str:
    """Returns a lesson step's html with buttons: for the instructions of :func:`find_instructions`, for the step's run,
    and for its error budget."""
    count = itertools.count()

    def button(line: re.Match[str]) -> str:
        act = _parse_instruction(line)
        if (act.verb, act.name) == ("Press", STAGE):
            return f"<li class='lab-to-do'>{run_on_stage_button_html()}</li>"
        if (act.verb, act.name) == ("Press", ASKED):
            return f"<li class='lab-to-do'>{budget_button_html()}</li>"
        if not act.has_button:
            return line[0]
        name, value = (f"<b>{part}</b>" for part in _name_and_value(line))
        return f"<li class='lab-to-do'><button type='button' class='lab-act' data-act='{next(count)}'>" \
               f"{tr(SENTENCES[act.verb]).format(name=name, value=value)}</button></li>"

    return _instruction_pattern().sub(button, html)


@language_cache(8)
def _instruction_pattern() -> re.Pattern[str]:
    """Returns the pattern of html list items that are instructions."""
    patterns = {verb: re.escape(tr(sentence)).replace(r"\{name\}", rf"<strong>(?P<{verb}_name>[^<]+)</strong>").replace(
        r"\{value\}", rf"<code>(?P<{verb}_value>[^<]+)</code>") for verb, sentence in SENTENCES.items()}
    told = "|".join(f"(?P<{verb}>{pattern})" for verb, pattern in patterns.items())
    return re.compile(rf"<li>\s*(?:<p>)?(?:{told})\.?(?:</p>)?\s*</li>")


def _name_and_value(line: re.Match[str]) -> tuple[str, str]:
    """Returns control's name and value ("" for none) of a matched instruction, as written in the text."""
    said = line.groupdict()
    return said[f"{line.lastgroup}_name"], said.get(f"{line.lastgroup}_value") or ""


def parse_click(message: object, step: int, instructions: Sequence[Instruction]) -> Instruction | str | None:
    """Returns the one of a step's ``instructions`` that the browser's ``message`` [step, index] is about, the second
    itself for [step, "stage"] and [step, "phase"]; None for other steps and invalid messages."""
    if not isinstance(message, list) or len(message) != 2 or message[0] != step:
        return None
    number = message[1]
    if number in (PUT, PHASE):
        return str(number)
    return instructions[number] if type(number) is int and 0 <= number < len(instructions) else None


def _parse_instruction(line: re.Match[str]) -> Instruction:
    """Returns a match of the pattern as an instruction, its control's name in English if it is known."""
    name, value = map(unescape, _name_and_value(line))
    known = {tr(one): one for one in NAMES}
    return Instruction(f"{line.lastgroup}", known.get(name, name), value, current_language())


def perform_instruction(act: Instruction, controls: LessonControls) -> None:
    """Carries out an instruction as the reader would with the widget."""
    if act.verb == "Press":
        controls.press(act.name)
    elif act.name in LOOKS:
        with use_language(act.language):
            quantities = {str(quantity): key for key, quantity in names_and_units.QUANTITIES.items()}
        if act.name == "Error of":
            controls.show_error(quantity=quantities[act.value])
        else:
            controls.show_error(estimator=act.value)
    else:
        controls.set_field_from_text(FIELDS[act.name], f"{tr(act.name)} {act.value}",
                                     with_language(_field_value_reader(act), act.language))


def _field_value_reader(act: Instruction) -> Callable[[Scene], object]:
    """Returns a function from a scene to the field's value; that raises ValueError if the field has no such value."""
    field = FIELDS[act.name]

    def read_value(scene: Scene) -> object:
        names = names_and_units.choice_labels(type(scene), field)
        if names:
            return next((code for code, name in names.items() if name == act.value), act.value)
        number = parse_size(act.value, unit_of(type(scene), field))
        return int(number) if number.is_integer() and field in ("cells", "ppc") else number

    return read_value
