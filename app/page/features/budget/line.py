"""Who made the error of this instant? One line and a bar below the estimators' cards (``js/budget.js``)."""

import json
from html import escape

from app.colour_palette import cause_css_variable
from app.frame.budget_chart_data import QUESTION, budget_field, format_percent, has_budget
from app.language.translation import lazy, tr
from app.page.features.budget.jobs import Series
from app.page.visit.history import series_until
from solvers.scene.error_causes import cause_labels
from solvers.solver import budget_shares

MOST = 2  # causes that are named: there is no room for more
BEING_FOUND, NO_BUDGET, ON_REQUEST = "…", lazy("not for this run"), lazy("press to find out")


def budget_button_html() -> str:
    """Returns the line as html: a button that opens the folder; empty, for what :func:`budget_line_html` has."""
    return f"<button type='button' class='lab-error-causes' hidden><span>{tr(QUESTION)} <small></small></span>" \
           "<i></i></button>"


def budget_line_html(says: str, parts: tuple[tuple[str, float], ...] = ()) -> str:
    """Returns an element that tells the line its text and the parts of its bar, each a CSS variable and a share."""
    said = json.dumps({"says": says, "parts": parts})
    return f"<i class='lab-parts' data-said='{escape(said)}'></i>"


def budget_line_at(series: Series, quantity: str, time: float) -> str:
    """Returns :func:`budget_line_html` for the error of a quantity (key x, v, sigma or a) at a ``time`` in s, from the
    budget's columns of a run."""
    if not has_budget(series):
        return budget_line_html(tr(NO_BUDGET))
    shares = budget_shares.shares_at(series, budget_field(quantity), time)
    if not shares:
        return budget_line_html(tr("no error yet") if time < series["time"][1] else tr(NO_BUDGET))
    if budget_shares.why_not_valid(series_until(series, time)):
        return budget_line_html(tr(NO_BUDGET))
    names = cause_labels(budget_shares.has_crossed(series, time))
    largest = sorted(shares, key=lambda cause: -abs(shares[cause]))[:MOST]
    said = " · ".join(f"{tr(names[cause])} {format_percent(shares[cause])}" for cause in largest
                      if round(100 * shares[cause]))
    return budget_line_html(said, tuple((cause_css_variable(cause), round(max(0.0, share), 3))
                                        for cause, share in shares.items()))
