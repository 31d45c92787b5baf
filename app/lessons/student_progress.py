"""What a student has done in a lesson, kept by the browser, handed in as a file: what has another form is refused."""

import json
import re
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from typing import Any

from app.lessons.answer_check import why_invalid
from app.lessons.lesson import Lesson
from solvers.study.json_schema import MapOf, mismatch, parsed
from solvers.untrusted import quoting

SCHEMA = "mpm-lab/answers/1"
LONGEST_NAME = 80
MOST_SECONDS = 1e7
ANSWER = {"first": object, "last": object, "attempts": int, "seconds": (int, float)}
FORM = {"schema": str, "lesson": str, "fingerprint": str, "name": str, "step": int, "answers": MapOf(ANSWER)}


class NotAnswers(ValueError):
    """A text that no lesson has written; the message says why."""

    def __init__(self, sentence: str):
        super().__init__(quoting.sentence(sentence))


@dataclass
class Answer:
    """What was answered ``first`` and ``last``, in how many attempts and how many seconds after the step was shown."""

    first: Any
    last: Any
    attempts: int
    seconds: float


@dataclass
class Progress:
    """A student's ``step`` in a lesson (0: introduction), answers by the steps' keys, and whether only the ``core``."""

    lesson: str
    fingerprint: str
    name: str = ""
    step: int = 0
    answers: dict[str, Answer] = field(default_factory=dict)
    core: bool = False

    def answer(self, key: str, given: Any, seconds: float) -> None:
        """Record an answer; the first stays."""
        before = self.answers.get(key)
        first, attempts = (before.first, before.attempts) if before else (given, 0)
        self.answers[key] = Answer(first, given, attempts + 1, round(seconds + (before.seconds if before else 0), 1))

    @property
    def file_name(self) -> str:
        """Of the file that is handed in."""
        called = re.sub(r"[^\w-]+", "-", self.name).strip("-") or "answers"
        return f"{self.lesson}-{called}.json"

    def text(self) -> str:
        """As JSON, for the browser to keep or the student to hand in."""
        return json.dumps({"schema": SCHEMA, **asdict(self)}, ensure_ascii=False)


def parse_progress(text: str, find: Callable[[str], Lesson | None]) -> Progress:
    """Reads the progress in a text, for a lesson that ``find`` gives by name; raises :class:`NotAnswers`."""
    try:
        values = parsed(text)
    except ValueError:
        raise NotAnswers("is no JSON; give a file that the page has handed in") from None
    if wrong := mismatch(values, FORM):
        raise NotAnswers(f"is no file of answers: {wrong}")
    if values["schema"] != SCHEMA:
        raise NotAnswers(f"is of another version ({quoting.quoted(values['schema'], 40)}); {SCHEMA} can be read")
    lesson = find(values["lesson"])
    if lesson is None:
        raise NotAnswers(f"is about a lesson that is not here: {quoting.quoted(values['lesson'])}")
    answers = {}
    for key, given in values["answers"].items():
        if key in lesson.questions and given["attempts"] > 0 and 0 <= given["seconds"] < MOST_SECONDS and not any(
                why_invalid(lesson.questions[key].asked, given[when]) for when in ("first", "last")):
            answers[key] = Answer(**{name: given[name] for name in ANSWER})
    step = min(max(values["step"], 0), len(lesson.steps) + 1)
    return Progress(lesson.name, values["fingerprint"][:64], values["name"][:LONGEST_NAME], step, answers,
                    values.get("core") is True and bool(lesson.deeper))


def of_lesson(text: str, lesson: Lesson) -> Progress | None:
    """Reads the progress in a text; None if it is none, or of another version of the lesson."""
    try:
        found = parse_progress(text, {lesson.name: lesson}.get)
    except NotAnswers:
        return None
    return found if found.fingerprint == lesson.fingerprint else None
