"""What the pages of a class share, and what the lecturer's has: the board, and the link and code to join by."""

from dataclasses import dataclass, field, replace
from urllib.parse import quote, urlsplit

from app.access.allowed_hosts import is_loopback
from app.classroom.board import Board, BoardSeat
from app.language.translation import lazy, tr
from app.lessons.lesson import Lesson
from app.lessons.lesson_runs import RunCache
from app.lessons.student_progress import Progress

POLITE = 10  # more than the engines: marks can wait, stages cannot
OF_NO_USE = lazy("Only this computer can open this address: serve with --host 0.0.0.0 for a class.")


@dataclass(frozen=True)
class JoinInfo:
    """By which a class comes in: its ``link`` without the code, the ``code``, a ``warning`` where nobody else can."""

    link: str
    code: str
    warning: str = ""

    @property
    def whole(self) -> str:
        """The link that brings the code along."""
        return f"{self.link}#code={quote(self.code)}"


@dataclass(frozen=True)
class LecturerContext:
    """What a lecturer's page has: the ``board`` and the ``door`` by which a class comes in."""

    board: Board
    door: JoinInfo

    def seen_from(self, here: str) -> JoinInfo:
        """The door for a class, where the lecturer's browser has found the lab under this address."""
        known = self.door.link
        link = here if here and not is_loopback(urlsplit(here).hostname or "") else known
        return replace(self.door, link=link, warning=tr(OF_NO_USE) * is_loopback(urlsplit(link).hostname or ""))


@dataclass(frozen=True)
class Classroom:
    """What the visitors of a server share: the ``lesson`` opened, teacher's notes, outcomes, whether lessons begin with
    the core; and of each visitor a ``seat``, where a board paces the lesson."""

    lesson: str = ""
    teacher: bool = False
    outcomes: RunCache = field(default_factory=lambda: RunCache(politeness=POLITE))
    core: bool = False
    seat: BoardSeat | None = None

    def begun(self, lesson: Lesson) -> Progress:
        """How somebody begins a lesson, or goes on with the one that is paced."""
        if self.seat and self.seat.lesson == lesson.name:
            return self.seat.progress()
        return Progress(lesson.name, lesson.fingerprint, core=self.core and bool(lesson.deeper))
