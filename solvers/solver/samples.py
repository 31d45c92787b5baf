"""Samples: what a kernel writes about a run every so many steps, and how it reads afterwards.

A sample is one row of sums over particles; :func:`read` turns rows into named series of RMS norms. The same
columns serve every problem, so that results, plots and the page need to know only names.
"""

import numpy as np

from solvers.scene.balance import MODES
from solvers.scene.causes import CAUSES, FIELDS

QUANTITIES = ("x", "v", "sigma", "a")

#: Columns every run has. ``error_*`` are sums of squares over particles. ``error_extra`` is the problem's own norm
#: (bar: stress as E ln F); ``angular_momentum`` is about the centre, ``torque`` the impulse of the body force's, and
#: ``exact_angular_momentum`` what the exact solution has; ``neighbour_gap`` to ``displacement_mismatch`` are
#: contradictions (``solvers.solver.soundness``) in metres, ``place`` is the particle where they are worst;
#: ``motion_square`` and ``motion_0`` ... are sums of displacements for ``solvers.scene.balance``, ``margin`` is dt over
#: its bound; what is switched off stays NaN.
BASE = ("step", "error_x", "error_v", "error_sigma", "error_a", "error_extra",
        "kinetic", "strain", "work", "angular_momentum", "torque", "exact_angular_momentum", "crossings",
        "neighbour_gap", "mean_drift", "out_of_shape", "displacement_mismatch", "place", "motion_square",
        *(f"motion_{k}" for k in range(MODES)), "margin")
MARGIN = BASE.index("margin")  # which the host fills in, once for every stretch of steps
LOOKS = slice(BASE.index("neighbour_gap"), MARGIN + 1)  # the columns that only some samples have
#: Columns of each estimator: squares of the estimate and of its difference from the true error.
EACH = tuple(f"{kind}_{q}" for kind in ("estimate", "difference") for q in QUANTITIES)
#: Columns of the effect ``budget``, behind all others: of each field sums of e^2, of e_c e and of e_c^2, c a cause.
BUDGET = tuple(name for field in FIELDS for name in (
    f"budget/error_{field}", *(f"budget/part_{field}_{cause}" for cause in CAUSES),
    *(f"budget/size_{field}_{cause}" for cause in CAUSES)))

ROWS = 512  # that fit before the host has to collect them


def column_count(estimators: tuple[str, ...], budget: bool = False) -> int:
    """Numbers in a row."""
    return len(BASE) + len(EACH) * len(estimators) + len(BUDGET) * budget


def column(name: str) -> int:
    """The index of a base column, for kernels (use inside ``ti.static``)."""
    return BASE.index(name)


def budget_column(estimators: tuple[str, ...], field: int) -> int:
    """The index of the first of the budget's columns of one of ``FIELDS``, for kernels."""
    return column_count(estimators) + len(BUDGET) // len(FIELDS) * field


def names(estimators: tuple[str, ...]) -> list[str]:
    """What the columns of a row are called, without those of the budget."""
    return [*BASE, *(f"{e}/{name}" for e in estimators for name in EACH)]


def read(rows: np.ndarray, estimators: tuple[str, ...], particles: int, dt: float,
         margin_unit: float = 1.0) -> dict[str, np.ndarray]:
    """Rows of samples as named series.

    Parameters
    ----------
    rows : (T, :func:`column_count`) array
        With the columns of the budget or without.
    estimators
        Those of the run, in its order.
    particles
        Over how many the rows are sums.
    dt : float, s
    margin_unit
        What margins are multiplied with, which the kernels count in Gershgorin's circles: see
        ``solvers.scene.step_bound``.

    Returns
    -------
    dict of (T,) arrays
        ``time`` in s, ``error_x`` ... (RMS over particles, SI), ``kinetic``, ``strain``, ``work`` (J), ``crossings``
        and, for each estimator, ``transport/estimate_x``, ``transport/difference_x`` and so on (RMS too). Of the
        budget, for each of ``FIELDS`` and ``CAUSES``, ``budget/error_x`` (RMS), ``budget/part_x_crossings``, the signed
        part of it that the cause has made, mean(e_c e)/RMS(e), and ``budget/size_x_crossings``, the RMS of e_c.
    """
    known = names(estimators)
    if rows.shape[1] > len(known):
        known += BUDGET
    series = dict(zip(known, rows.T.copy(), strict=True))
    series["time"] = series.pop("step") * dt
    series["margin"] *= margin_unit
    for name, values in series.items():
        if name.rpartition("/")[2].startswith(("error_", "estimate_", "difference_", "size_")):
            np.sqrt(values / particles, out=values)
    for name in BUDGET:
        if name in series and "/part_" in name:
            error = series[f"budget/error_{name.split('_')[1]}"]
            series[name] = np.divide(series[name] / particles, error, out=np.zeros_like(error), where=error != 0)
    return series
