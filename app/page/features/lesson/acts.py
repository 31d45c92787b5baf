"""What a lesson tells its reader to do, as buttons that do it: "Set **Cells** to `80`" on a line of its own."""

import itertools
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from html import unescape

from app import words
from app.frame.budget import QUESTION
from app.page.features.lesson.hands import Hands
from app.words import size_in, unit_of
from solvers.scene.scene import Scene

LINE = re.compile(r"<li>\s*(?:<p>)?(Press|Set|Choose) <strong>([^<]+)</strong>(?: to)?(?: <code>([^<]+)</code>)?\.?"
                  r"(?:</p>)?\s*</li>")
#: Widgets that say a field of the scene, by the words that stand beside them.
FIELDS = {"Cells": "cells", "Particles / cell": "ppc", "Amplitude A": "amplitude", "Modulus E": "modulus",
          "CFL number": "cfl", "Method": "method", "Body force": "body_force"}
STAGE = "On the stage"  # pressed it puts the step's run there; chosen, an estimator
LOOKS, PRESSED = ("Error of", STAGE), ("Play", "Pause", "Reset", "Step")
ASKED = QUESTION  # pressed it opens the error budget, by the page's script (``js/budget.js``)
PUT = f"<button type='button' class='lab-act lab-put' data-act='stage'>{STAGE}</button>"
WHO = f"<button type='button' class='lab-act' data-act='budget'>{ASKED}</button>"


@dataclass(frozen=True)
class Act:
    """Such as to "Set" what is called "Cells" to "80"; what is pressed has no value."""

    verb: str
    name: str
    value: str

    @property
    def known(self) -> bool:
        """Whether a button can do it; the reader does the rest."""
        if self.verb == "Press":
            return self.name in PRESSED
        return bool(self.value) and (self.name in FIELDS or self.name in LOOKS)


def found(html: str) -> list[Act]:
    """What can be done of what a step's html asks for, in its order."""
    return [act for act in map(_act, LINE.finditer(html)) if act.known]


def with_buttons(html: str) -> str:
    """The html with a button in the place of each act that :func:`found` gives, of the one that puts the step's run on
    the stage, and of that which asks who made its error."""
    count = itertools.count()

    def button(line: re.Match[str]) -> str:
        act = _act(line)
        if (act.verb, act.name) == ("Press", STAGE):
            return f"<li class='lab-to-do'>{PUT}</li>"
        if (act.verb, act.name) == ("Press", ASKED):
            return f"<li class='lab-to-do'>{WHO}</li>"
        if not act.known:
            return line[0]
        verb, name, value = line.groups()
        to = f"{' to' * (verb == 'Set')} <b>{value}</b>" if value else ""
        return f"<li class='lab-to-do'><button type='button' class='lab-act' data-act='{next(count)}'>{verb} " \
               f"<b>{name}</b>{to}</button></li>"

    return LINE.sub(button, html)


def pressed(said: object, step: int, known: Sequence[Act]) -> Act | str | None:
    """What of the step that is shown a browser says is pressed, by the step's number and the act's, which may be
    anything: one of the acts, or :data:`STAGE` for the step's run."""
    if not isinstance(said, list) or len(said) != 2 or said[0] != step:
        return None
    number = said[1]
    if number == "stage":
        return STAGE
    return known[number] if type(number) is int and 0 <= number < len(known) else None


def _act(line: re.Match[str]) -> Act:
    return Act(*(unescape(part or "") for part in line.groups()))


def do(act: Act, controls: Hands) -> None:
    """Do it as the reader would with the widget."""
    if act.verb == "Press":
        controls.press(act.name)
    elif act.name in LOOKS:
        controls.look(**_looked(act))
    else:
        controls.change(FIELDS[act.name], f"{act.name} {act.value}", _meant(act))


def _looked(act: Act) -> dict[str, str]:
    quantities = {str(quantity): key for key, quantity in words.QUANTITIES.items()}
    return {"quantity": quantities[act.value]} if act.name == "Error of" else {"estimator": act.value}


def _meant(act: Act) -> Callable[[Scene], object]:
    """What the value is of a scene's field; ValueError where it has none such."""
    field = FIELDS[act.name]

    def of(scene: Scene) -> object:
        names = words.choices(type(scene), field)
        if names:
            return next((code for code, name in names.items() if name == act.value), act.value)
        number = size_in(act.value, unit_of(type(scene), field))
        return int(number) if number.is_integer() and field in ("cells", "ppc") else number

    return of
