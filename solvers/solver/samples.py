"""Samples: what a kernel writes about a run every so many steps, and how it reads afterwards.

A sample is one row of sums over particles; :func:`read` turns rows into named series of RMS norms. The same
columns serve every problem, so that results, plots and the page need to know only names.
"""

import numpy as np

QUANTITIES = ("x", "v", "sigma", "a")

#: Columns every run has. ``error_*`` are sums of squares over particles. ``error_extra`` is the problem's own norm
#: (bar: stress as E ln F); ``angular_momentum`` is about the centre, ``torque`` the impulse of the body force's, and
#: ``exact_angular_momentum`` what the exact solution has; ``neighbour_gap`` to ``displacement_mismatch`` are
#: contradictions (``solvers.solver.soundness``) in metres, ``place`` is the particle where they are worst, ``margin``
#: is dt over its bound; what is switched off stays NaN.
BASE = ("step", "error_x", "error_v", "error_sigma", "error_a", "error_extra",
        "kinetic", "strain", "work", "angular_momentum", "torque", "exact_angular_momentum", "crossings",
        "neighbour_gap", "mean_drift", "out_of_shape", "displacement_mismatch", "place", "margin")
MARGIN = BASE.index("margin")  # which the host fills in, once for every stretch of steps
LOOKS = slice(BASE.index("neighbour_gap"), MARGIN + 1)  # the columns that only some samples have
#: Columns of each estimator: squares of the estimate and of its difference from the true error.
EACH = tuple(f"{kind}_{q}" for kind in ("estimate", "difference") for q in QUANTITIES)

ROWS = 512  # that fit before the host has to collect them


def column_count(estimators: tuple[str, ...]) -> int:
    """Numbers in a row."""
    return len(BASE) + len(EACH) * len(estimators)


def column(name: str) -> int:
    """The index of a base column, for kernels (use inside ``ti.static``)."""
    return BASE.index(name)


def read(rows: np.ndarray, estimators: tuple[str, ...], particles: int, dt: float) -> dict[str, np.ndarray]:
    """Rows of samples as named series.

    Parameters
    ----------
    rows : (T, :func:`column_count`) array
    estimators
        Those of the run, in its order.
    particles
        Over how many the rows are sums.
    dt : float, s

    Returns
    -------
    dict of (T,) arrays
        ``time`` in s, ``error_x`` ... (RMS over particles, SI), ``kinetic``, ``strain``, ``work`` (J), ``crossings``
        and, for each estimator, ``transport/estimate_x``, ``transport/difference_x`` and so on (RMS too).
    """
    names = [*BASE, *(f"{e}/{name}" for e in estimators for name in EACH)]
    series = dict(zip(names, rows.T.copy(), strict=True))
    series["time"] = series.pop("step") * dt
    for name, values in series.items():
        if name.rpartition("/")[2].startswith(("error_", "estimate_", "difference_")):
            np.sqrt(values / particles, out=values)
    return series
