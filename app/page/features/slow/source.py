"""One step in slow motion as what is on the stage."""

from dataclasses import replace

from app.page.features.slow.panel import SlowMotion
from app.page.measurements import Numbers
from app.page.source import Choice, Picture, Sight, Source
from app.page.visit.notice import Notice


class SlowStep:
    """The step that is shown (:class:`~app.page.source.Source`), on a stage of its own. What is said is of its
    phase; the numbers are those of the ``run`` that rests meanwhile, which is drawn where nobody sees it."""

    def __init__(self, slow: SlowMotion, run: Source):
        self._slow, self._run = slow, run

    @property
    def on(self) -> bool:
        return self._slow.showing

    @property
    def at_once(self) -> bool:
        return bool(self._slow.sentence)

    def sight(self, choice: Choice) -> Sight | None:
        sight = self._run.sight(choice)
        return sight and replace(sight, hidden=True)

    def numbers(self, choice: Choice, picture: Picture | None, probed: str | None) -> Numbers | None:
        return self._run.numbers(choice, picture, probed)

    def sentence(self, choice: Choice, picture: Picture) -> str:
        said = self._run.sentence(choice, picture)
        return said and (self._slow.sentence or said)

    def notice(self) -> Notice | None:
        return self._run.notice()
