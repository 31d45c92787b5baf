"""What may be on a visitor's stage, and gives what is drawn, read and said: one interface for all of it."""

from typing import Protocol

from app.page.measurements import Numbers
from app.page.stage.sight import Choice, Picture, Sight
from app.page.visit.notice import Notice


class Source(Protocol):
    """Something that may be on the stage: the visitor's run, now or looked back on, alone or beside a pinned one; a
    step of it in slow motion; a file of the visitor's own."""

    @property
    def on(self) -> bool:
        """Whether it is what is to be seen."""
        ...

    @property
    def at_once(self) -> bool:
        """Whether its sentence is the answer to a click."""
        ...

    def sight(self, choice: Choice) -> Sight | None:
        """What to draw now; None as long as there is nothing."""
        ...

    def numbers(self, choice: Choice, picture: Picture | None, probed: str | None) -> Numbers | None:
        """What to read beside the ``picture`` that is drawn, and what was ``probed`` in it; None for no change."""
        ...

    def sentence(self, choice: Choice, picture: Picture) -> str:
        """What is seen in the picture; "" where that is of something else, and soon replaced."""
        ...

    def notice(self) -> Notice | None:
        """What is to be read now of it, if anything."""
        ...
