"""Data of a lesson, and its variants: numbers drawn from a student's name, which replace ``{A}`` in texts."""

import functools
import hashlib
import re
import unicodedata
from collections.abc import Mapping
from dataclasses import dataclass

from app.language.translation import ENGLISH, lazy
from solvers.untrusted import quoting

PREDICT, RUN, OBSERVE, EXPLAIN = KINDS = ("predict", "run", "observe", "explain")
NUMBER, CHOICE, DRAG, INTERVAL, TEXT = ("number", "choice", "drag", "interval", "text")

#: Allowed and required blocks of a step, by kind.
ALLOWED = {PREDICT: ("question", "claims", "teacher"), RUN: ("run", "claims", "teacher"),
           OBSERVE: ("question", "claims", "teacher"), EXPLAIN: ("claims", "teacher", "run", "bets")}
NEEDED = {PREDICT: "question", RUN: "run", OBSERVE: "question"}
#: Keys of a question beside ``kind``, by kind; True for required ones.
QUESTIONS: dict[str, dict[str, bool]] = {NUMBER: {"expected": True, "tolerance": False, "unit": False},
                                         CHOICE: {"options": True, "correct": False, "holds": False},
                                         DRAG: {"control": True, "expected": True, "tolerance": False, "unit": False},
                                         INTERVAL: {"expected": True, "unit": False, "level": False}, TEXT: {}}

#: Controls of the page that a lesson may show, by its names for them.
CONTROLS = ("problem", "method", "cells", "ppc", "amplitude", "motion", "stretch", "modulus", "step", "speed", "pin",
            "slow-motion", "look-back", "quantity", "magnify", "estimators", "colours", "trace", "domains", "details",
            "effects")

#: Ends and step of a slider for predictions; exponents of ten for ``POWERS``.
REACH = {"cells": (8.0, 160.0, 1.0), "ppc": (1.0, 8.0, 1.0), "amplitude": (-4.0, -0.8, 0.01),
         "modulus": (0.0, 3.0, 0.01), "cfl": (-2.0, 0.5, 0.01)}
POWERS = ("amplitude", "modulus", "cfl")
NAMES = {"cells": lazy("Cells"), "ppc": lazy("Particles / cell"), "amplitude": lazy("Amplitude"),
         "modulus": lazy("Modulus"), "cfl": lazy("CFL number")}
#: Titles of the kinds of steps.
TITLES = {PREDICT: lazy("Predict"), RUN: lazy("Run"), OBSERVE: lazy("Observe"), EXPLAIN: lazy("Explain")}
PLACE = re.compile(r"\{([A-Za-z]\w*)\}")
Numbers = Mapping[str, float | int | str]


class LessonError(ValueError):
    """Raised for an invalid lesson; the message gives file, line (from 1), what is wrong and what is expected."""

    def __init__(self, line: int, sentence: str, file: str = ""):
        self.line, self.sentence = line, quoting.one_line(sentence)
        super().__init__(quoting.one_line(f"{quoting.file_name(file or 'lesson')}, line {line}: {sentence}"))


@dataclass(frozen=True)
class LessonRun:
    """Named run of a lesson: a scene, or several that differ in one field, as texts of states with {placeholders}."""

    name: str
    texts: tuple[str, ...]
    line: int
    varied: str = ""  # the field in which several differ


@dataclass(frozen=True)
class ShownPhase:
    """A ``phase`` (from 1) of a run's first time step, to be shown in slow motion round a ``particle`` (from 0)."""

    particle: int
    phase: int


@dataclass(frozen=True)
class Question:
    """Question of a step. A number is right within the relative ``tolerance`` of ``expected``; of the ``options`` the
    one is right whose claim in ``holds`` holds, or the ``correct`` one, counted from 1. ``control`` is the scene's
    field to drag, ``unit`` that of the number. An interval is a bet that should contain the result with probability
    ``level`` (``app.lessons.interval_bets``). Free text is not marked."""

    kind: str
    line: int
    options: tuple[str, ...] = ()
    correct: int | None = None
    holds: tuple[str, ...] = ()
    expected: str = ""
    tolerance: float = 0.1
    unit: str = ""
    control: str = ""
    level: float = 0.8


@dataclass(frozen=True)
class Claim:
    """Claim about the results of runs, such as "error.x.max < 1e-5" (:mod:`app.lessons.claims`), and its line."""

    text: str
    line: int


@dataclass(frozen=True)
class Step:
    """Step of a lesson. ``key`` identifies it in a handed-in file, ``text`` is Markdown, ``notes`` are the teacher's,
    ``stage`` is a template of its button's state, which begins with ``shown_phase`` if not None, ``bets`` are the
    bettors compared. It is optional if not ``core``."""

    kind: str
    title: str
    key: str
    line: int
    text: str = ""
    notes: str = ""
    runs: tuple[LessonRun, ...] = ()
    stage: str = ""
    shown_phase: ShownPhase | None = None
    question: Question | None = None
    claims: tuple[Claim, ...] = ()
    core: bool = True
    bets: tuple[str, ...] = ()

    @property
    def asked_question(self) -> Question:
        """The question of a step that certainly has one."""
        assert self.question is not None
        return self.question


@dataclass(frozen=True)
class Lesson:
    """Lesson with the page's ``controls`` that it needs, ``variants`` of its numbers, of which a student gets one, and
    a ``fingerprint`` to verify that a handed-in file belongs to it. ``minutes`` are for all steps, ``core_minutes`` for
    the core (:mod:`app.lessons.duration`). Only words depend on its ``language``."""

    name: str
    title: str
    goals: tuple[str, ...]
    controls: tuple[str, ...]
    prerequisites: tuple[str, ...] = ()
    variants: tuple[Numbers, ...] = ({},)
    intro: str = ""
    notes: str = ""
    steps: tuple[Step, ...] = ()
    fingerprint: str = ""
    minutes: int = 0
    core_minutes: int = 0
    language: str = ENGLISH

    @property
    def file_stem(self) -> str:
        """The name of the lesson's file without ".md": "04-...", or "04-....de" for a translation."""
        return self.name if self.language == ENGLISH else f"{self.name}.{self.language}"

    @functools.cached_property
    def questions(self) -> dict[str, Step]:
        """The steps with a question, by key."""
        return {step.key: step for step in self.steps if step.question}

    @property
    def optional_steps(self) -> tuple[Step, ...]:
        """The optional steps, which are not of the core."""
        return tuple(step for step in self.steps if not step.core)

    def steps_to_take(self, core: bool) -> tuple[Step, ...]:
        """Returns the steps to take, all or only the ``core``."""
        return tuple(step for step in self.steps if step.core or not core)

    def neighbour_step(self, at: int, by: int, core: bool) -> int:
        """Returns the number of the step after number ``at``, or before it if ``by`` < 0; with ``core`` skips optional
        steps. Number 0 is the introduction, the one after the last step the end."""
        end = len(self.steps) + 1
        places = [0, *(k for k, step in enumerate(self.steps, 1) if step.core or not core), end]
        return min((k for k in places if k > at), default=end) if by > 0 else \
            max((k for k in places if k < at), default=0)

    @property
    def runs(self) -> dict[str, LessonRun]:
        return {run.name: run for step in self.steps for run in step.runs}

    def main_run(self, step: Step) -> str:
        """Returns the name of the run meant by paths without one in a step's claims: for a prediction the next run from
        there, else the latest up to there; "" if there is none."""
        at = self.steps.index(step)
        steps = self.steps[at:] if step.kind == PREDICT else self.steps[at::-1]
        return next((other.runs[0].name for other in steps if other.runs), "")


def draw_numbers(lesson: Lesson, name: str) -> Numbers:
    """Returns one of the lesson's variants, drawn from a student's name, or the first for an empty name."""
    plain = " ".join(unicodedata.normalize("NFKC", name).casefold().split())
    if not plain:
        return lesson.variants[0]
    digest = hashlib.sha256(f"{lesson.name}\n{plain}".encode()).digest()
    return lesson.variants[int.from_bytes(digest[:8], "big") % len(lesson.variants)]


def fill_numbers(text: str, numbers: Numbers) -> str:
    """Replaces placeholders such as {A} by the numbers of a variant. Other braces, as in formulas, stay."""
    return PLACE.sub(lambda found: f"{numbers[found[1]]}" if found[1] in numbers else found[0], text)
