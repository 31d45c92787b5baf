"""The message that a visitor should read now, and doubts about a sound run."""

from dataclasses import dataclass

from app.language.translation import tr
from app.names_and_units import format_ratio, reword_for_page
from app.page.visit.history import NormHistory
from solvers.untrusted.quoting import escape_html

LONGEST = 1000  # most letters of a sentence; refusals have less
BROKEN = 30.0  # error index from which an estimate is useless


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
