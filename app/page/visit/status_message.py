"""The message that a visitor should read now, and doubts about a sound run."""

from dataclasses import dataclass

from app.language.translation import lazy, tr
from app.names_and_units import format_ratio, reword_for_page
from app.page.visit.history import NormHistory
from solvers.untrusted.quoting import escape_html

LONGEST = 1000  # most letters of a sentence; refusals have less
BROKEN = 30.0  # error index from which an estimate is useless
SLOW_ANSWER = 0.4  # seconds without a frame after which the page shows that it is preparing
SAID_AFTER = 2.0  # seconds after which it shows for how long
PREPARING = lazy("Preparing this scene: a combination of method, estimators and effects is compiled the first time it "
                 "is used; several estimators at once take longest.")
STILL_PREPARING = lazy("Preparing this scene, for {seconds} s so far: a combination of method, estimators and effects "
                       "is compiled the first time it is used; several estimators at once take longest.")


@dataclass(frozen=True)
class Notice:
    """Message for the visitor; ``kind`` is "wait", "refused", "trouble", "lost" or "unstable", as in its CSS class. One
    that is ``seen`` elsewhere on the page is for screen readers only."""

    kind: str
    sentence: str
    seen: bool = False

    @property
    def html(self) -> str:
        return (f"<div class='lab-notice lab-{self.kind}{' lab-seen' * self.seen}' role='status'>"
                f"{escape_html(self.sentence[:1].upper() + self.sentence[1:], LONGEST)}</div>")


def preparing_notice(waited: float) -> Notice | None:
    """Returns the message that a scene is being prepared, ``waited`` seconds after its request; None at first."""
    if waited <= SLOW_ANSWER:
        return None
    return Notice("wait", tr(PREPARING if waited <= SAID_AFTER else STILL_PREPARING, seconds=f"{waited:.0f}"))


def doubt_notice(history: NormHistory, valid: tuple[str, ...]) -> Notice | None:
    """Returns a warning that one of the ``valid`` estimates has failed, or one about the scene; None if fine."""
    series, scene = history.series, history.scene
    if not len(series.get("error_x", ())):
        return None
    for estimator in valid:
        index = series[f"{estimator}/index_x"][-1]
        if index > BROKEN:
            return Notice("refused", tr("The estimate {estimator} has failed: it is {index} times the true error of x. "
                                        "Do not trust it here.", estimator=estimator, index=format_ratio(index)))
    warnings = scene.warnings()
    return Notice("refused", f"{reword_for_page(warnings[0])}.") if warnings else None
