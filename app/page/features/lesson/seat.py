"""A seat in a class whose lesson is paced from the board: what a player tells it and asks of it."""

from collections.abc import Callable
from typing import Any, Protocol

from app.lessons.lesson import Step
from app.lessons.progress import Progress


class Seat(Protocol):
    """One page's. Steps are counted as :class:`~app.lessons.progress.Progress` counts them."""

    @property
    def lesson(self) -> str:
        """The name of the lesson that is paced; in others a visitor goes on as he likes."""

    @property
    def opened(self) -> int:
        """The last step that is open."""

    def progress(self) -> Progress:
        """What this visitor has answered so far, and where he was: the class has it, and not the browser."""

    def listen(self, on_open: Callable[[], None]) -> None:
        """Have ``on_open`` called, on another thread, when a further step is open."""

    def shows(self, step: int) -> None:
        """This step is seen."""

    def answered(self, step: Step, answer: Any) -> None:
        """The question of a step is answered, perhaps once more."""

    def leave(self) -> None:
        """The page has gone."""
