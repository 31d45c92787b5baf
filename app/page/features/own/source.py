"""A visitor's own file as what is on the stage."""

from app.frame.silences import NO_INDEX
from app.page.features.own.panel import OwnCode
from app.page.features.own.run import JUDGE
from app.page.features.own.words import lines, readout, sentence
from app.page.measurements import Numbers
from app.page.source import Choice, Picture, Sight
from app.page.stage.worst import WorstRegions
from app.page.visit.notice import Notice


class OwnFile:
    """The file that is shown, at one of its times (:class:`~app.page.source.Source`). Its colours are those of
    all times."""

    def __init__(self, code: OwnCode):
        self._code = code

    @property
    def on(self) -> bool:
        return self._code.shown is not None

    @property
    def at_once(self) -> bool:
        return not self._code.playing

    def sight(self, choice: Choice) -> Sight | None:
        if (shown := self._code.shown) is None:
            return None
        run, k = shown
        report, arrays = run.frame(k, choice.quantity, self._code.playing)
        picture = Picture(report, arrays, run.view(arrays, choice.quantity, choice.difference), 1.0, foreign=True)
        return Sight(picture, run.largest(choice.quantity), 0.0, (run.name, choice.quantity))

    def numbers(self, choice: Choice, picture: Picture | None, probed: str | None) -> Numbers | None:
        if (shown := self._code.shown) is None:
            return None
        run, k = shown
        return Numbers(readout(run, k, choice.quantity, probed), lines(run, choice.quantity),
                       None if run.estimate is None else run, (JUDGE,), (JUDGE,), JUDGE, run.times[k],
                       "" if run.true is not None else NO_INDEX)

    def sentence(self, choice: Choice, picture: Picture) -> str:
        shown = self._code.shown
        if shown is None or not picture.foreign or picture.report.scene != shown[0].scene:
            return ""
        worst = WorstRegions()  # of this frame: at another time a file may have other particles
        worst.look(picture.report, picture.arrays, picture.view)
        return sentence(*shown, picture.view, worst, choice.quantity)

    def notice(self) -> Notice | None:
        return None  # its panel's comes first, whatever is on the stage
