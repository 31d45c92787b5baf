"""What all visitors of one server share of lessons."""

from dataclasses import dataclass, field

from app.lessons.outcomes import Outcomes

POLITE = 10  # more than the engines: marks can wait, stages cannot


@dataclass(frozen=True)
class Classroom:
    """The lesson that everyone is opened on, if any, whether teacher's notes are shown, and what answers are marked
    by."""

    lesson: str = ""
    teacher: bool = False
    outcomes: Outcomes = field(default_factory=lambda: Outcomes(politeness=POLITE))
