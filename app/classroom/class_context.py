"""Data shared by the pages of a class, and the lecturer's: the board, and the link and code to join."""

from dataclasses import dataclass, field, replace
from urllib.parse import quote, urlsplit

from app.access.allowed_hosts import is_loopback
from app.classroom.class_board_state import ClassBoardState, VisitorBoardSeat
from app.language.translation import lazy, tr
from app.lessons.lesson import Lesson
from app.lessons.lesson_runs import RunCache
from app.lessons.student_progress import StudentProgress

POLITE = 10  # nice value above the engines': marks can wait, stages cannot
OF_NO_USE = lazy("Only this computer can open this address: serve with --host 0.0.0.0 for a class.")


@dataclass(frozen=True)
class JoinInfo:
    """How a class joins: ``link`` without the code, the ``code``, and a ``warning`` or "" if others can connect."""

    link: str
    code: str
    warning: str = ""

    @property
    def full_link(self) -> str:
        """The link with the code."""
        return f"{self.link}#code={quote(self.code)}"


@dataclass(frozen=True)
class LecturerContext:
    """Data of a lecturer's page: the ``board``, and the ``join_info``, the link and code for the class."""

    board: ClassBoardState
    join_info: JoinInfo

    def join_info_for(self, opened_at: str) -> JoinInfo:
        """Returns link, code and warning, for the address (URL or "") at which the lecturer's browser has the lab."""
        known = self.join_info.link
        link = opened_at if opened_at and not is_loopback(urlsplit(opened_at).hostname or "") else known
        return replace(self.join_info, link=link, warning=tr(OF_NO_USE) * is_loopback(urlsplit(link).hostname or ""))


@dataclass(frozen=True)
class LessonContext:
    """Data shared by a server's visitors: name of the ``lesson`` opened, whether to show the ``teacher``'s notes, cache
    of runs, whether lessons begin with the ``core``; and the visitor's ``seat`` if a board opens the steps."""

    lesson: str = ""
    teacher: bool = False
    outcomes: RunCache = field(default_factory=lambda: RunCache(politeness=POLITE))
    core: bool = False
    seat: VisitorBoardSeat | None = None

    def start_progress(self, lesson: Lesson) -> StudentProgress:
        """Returns the progress to open a lesson with: an empty one, or the visitor's so far if a board opens steps."""
        if self.seat and self.seat.lesson == lesson.name:
            return self.seat.progress()
        return StudentProgress(lesson.name, lesson.fingerprint, core=self.core and bool(lesson.optional_steps))
