"""The error budget of a run over time as data and words, for the page, exported files and pictures."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from app.language.translation import lazy, tr
from solvers.scene.error_causes import CAUSES, FIELDS
from solvers.scene.scene import Scene
from solvers.solver import budget_shares

QUESTION = lazy("Who made this error?")
CAPTION = lazy("The line is the error, RMS over particles; each colour is the part from one cause, below zero if the "
               "cause reduces the error.")
BELOW_ZERO = lazy("; below zero: reduces it, all add up to 100 %")
#: Short explanation of each cause.
MEANINGS = {"crossings": lazy("counted in the wrong cell"), "coarse_grid": lazy("cells too wide for the motion"),
            "body_force": lazy("taken at nodes, not at particles"),
            "time_step": lazy("changes within a step; shorter steps also map more often")}
UNITS = {"x": "m", "v": "m/s", "F": ""}
SEEN = 2e-3  # of the largest error: a cause that never contributes more is not drawn


@dataclass(frozen=True)
class BudgetLayer:
    """Area of one ``cause`` (of ``CAUSES``) in a stacked chart of an error over T times: between the rows of ``above``
    (2, T) where the cause increases the error, of ``below`` (2, T) where it reduces it, in the unit of the error."""

    cause: str
    above: np.ndarray
    below: np.ndarray


def stack_layers(series: Mapping[str, np.ndarray], field: str) -> list[BudgetLayer]:
    """Returns the stacked contributions of all visible causes to the error of a field, x, v or F; ``series`` are those
    of a run with the effect ``budget``, by name, (T,) each."""
    largest = float(np.max(np.abs(error_rms(series, field)), initial=0.0))
    up = down = np.zeros(len(series["time"]))
    layers = []
    for cause in CAUSES:
        part = np.nan_to_num(series[f"budget/part_{field}_{cause}"], posinf=0.0, neginf=0.0)
        if np.max(np.abs(part), initial=0.0) > SEEN * largest:
            above, below = np.stack([up, up + np.maximum(part, 0)]), np.stack([down, down + np.minimum(part, 0)])
            layers.append(BudgetLayer(cause, above, below))
            up, down = above[1], below[1]
    return layers


def error_rms(series: Mapping[str, np.ndarray], field: str) -> np.ndarray:
    """Returns a field's error (T,), x in m, v in m/s or F, RMS over particles, from a run's series; 0 if not finite."""
    return np.nan_to_num(series[f"budget/error_{field}"], posinf=0.0, neginf=0.0)


def has_budget(series: Mapping[str, np.ndarray]) -> bool:
    """Returns whether a run's series contain an error budget at two times or more."""
    return len(series.get("budget/error_x", ())) > 1


def budget_field(quantity: str) -> str:
    """Returns the field, x, v or F, whose budget is shown for a quantity (key x, v, sigma or a): F for the last two."""
    return quantity if quantity in FIELDS else FIELDS[-1]


def format_percent(share: float | None) -> str:
    """Returns a share, 1 for the whole, as text in whole per cent (97 %, −4 %); "–" for None."""
    return "–" if share is None else f"{round(100 * share) + 0:d} %".replace("-", "−")


def below_zero_note(shares: Iterable[float | None]) -> str:
    """Returns a note to append if a share is shown below zero, which makes others add up to more than 100 %; else
    ""."""
    return tr(BELOW_ZERO) if any(format_percent(share).startswith("−") for share in shares) else ""


def largest_share(series: Mapping[str, np.ndarray], field: str) -> tuple[str, float] | None:
    """Returns the largest cause of a field's (x, v, F) error so far and its share (1: all); None if none is valid."""
    if not has_budget(series) or budget_shares.why_not_valid(series):
        return None
    known = {cause: share for cause, share in budget_shares.shares(series, field).items() if share is not None}
    return max(known.items(), key=lambda item: item[1]) if known else None


def estimated_error_note(scene: Scene) -> str:
    """Returns a note to append if the error in a budget is the companion's estimate; "" if it is the true one."""
    return "" if scene.has("truth") else tr(", as companion sees it")
