"""A student's progress in a lesson, stored by the browser and handed in as a file; other formats are rejected."""

import json
import re
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from typing import Any

from app.lessons.answer_marking import why_invalid
from app.lessons.lesson import Lesson
from solvers.study.json_schema import MapOf, describe_mismatch, parse_json
from solvers.untrusted import quoting

SCHEMA = "mpm-lab/answers/1"
LONGEST_NAME = 80
MOST_SECONDS = 1e7
ANSWER = {"first": object, "last": object, "attempts": int, "seconds": (int, float)}
FORM = {"schema": str, "lesson": str, "fingerprint": str, "name": str, "step": int, "answers": MapOf(ANSWER)}


class InvalidProgress(ValueError):
    """Raised for a text that is no student's progress; the message is the end of a sentence about the file."""

    def __init__(self, sentence: str):
        super().__init__(quoting.one_line(sentence))


@dataclass
class RecordedAnswer:
    """Answers to one question: the first and last, number of attempts, and seconds with the step shown, of all."""

    first: Any
    last: Any
    attempts: int
    seconds: float


@dataclass
class StudentProgress:
    """Progress of the student ``name`` in a lesson: the number of the present step (0: introduction), answers by the
    steps' keys, and whether only the core is taken. ``fingerprint`` is that of the lesson."""

    lesson: str
    fingerprint: str
    name: str = ""
    step: int = 0
    answers: dict[str, RecordedAnswer] = field(default_factory=dict)
    core: bool = False

    def record(self, key: str, given: Any, seconds: float) -> None:
        """Adds an answer to the step ``key``, ``seconds`` after the step was shown; the first answer stays."""
        before = self.answers.get(key)
        first, attempts = (before.first, before.attempts) if before else (given, 0)
        self.answers[key] = RecordedAnswer(first, given, attempts + 1,
                                           round(seconds + (before.seconds if before else 0), 1))

    @property
    def file_name(self) -> str:
        """The name of the file to hand in: lesson and student, "04-...-Ann.json"."""
        called = re.sub(r"[^\w-]+", "-", self.name).strip("-") or "answers"
        return f"{self.lesson}-{called}.json"

    def text(self) -> str:
        """Returns the progress as JSON, for the browser to store or the student to hand in."""
        return json.dumps({"schema": SCHEMA, **asdict(self)}, ensure_ascii=False)


def parse_progress(text: str, find: Callable[[str], Lesson | None]) -> StudentProgress:
    """Parses a progress in JSON; ``find`` returns a lesson by name, or None. Raises :class:`InvalidProgress`."""
    try:
        values = parse_json(text)
    except ValueError:
        raise InvalidProgress("is no JSON; give a file that the page has handed in") from None
    if wrong := describe_mismatch(values, FORM):
        raise InvalidProgress(f"is no file of answers: {wrong}")
    if values["schema"] != SCHEMA:
        raise InvalidProgress(f"is of another version ({quoting.quote(values['schema'], 40)}); {SCHEMA} can be read")
    lesson = find(values["lesson"])
    if lesson is None:
        raise InvalidProgress(f"is about a lesson that is not here: {quoting.quote(values['lesson'])}")
    answers = {}
    for key, given in values["answers"].items():
        if key in lesson.questions and given["attempts"] > 0 and 0 <= given["seconds"] < MOST_SECONDS and not any(
                why_invalid(lesson.questions[key].asked_question, given[when]) for when in ("first", "last")):
            answers[key] = RecordedAnswer(**{name: given[name] for name in ANSWER})
    step = min(max(values["step"], 0), len(lesson.steps) + 1)
    return StudentProgress(lesson.name, values["fingerprint"][:64], values["name"][:LONGEST_NAME], step, answers,
                           values.get("core") is True and bool(lesson.optional_steps))


def parse_lesson_progress(text: str, lesson: Lesson) -> StudentProgress | None:
    """Parses a student's progress in a lesson; returns None if it is invalid, or of another version of the lesson."""
    try:
        found = parse_progress(text, {lesson.name: lesson}.get)
    except InvalidProgress:
        return None
    return found if found.fingerprint == lesson.fingerprint else None
