"""Samples: rows that a kernel writes about a run at intervals, and their conversion to named series.

A sample is one row of sums over particles; :func:`read_rows` turns rows into named series of RMS norms. All problems
have the same columns, so that results, plots and the page need only names.
"""

import numpy as np

from solvers.scene.displacement_moments import MODES
from solvers.scene.effects import ALL
from solvers.scene.kernel_options import KernelOptions
from solvers.scene.scene import Scene

QUANTITIES = ("x", "v", "sigma", "a")

#: Columns of every run. ``error_*`` are sums of squares over particles. ``error_extra`` is the problem's own norm (bar:
#: stress as E ln F); ``neighbour_gap`` to ``displacement_mismatch`` are contradictions (``solvers.solver.soundness``)
#: in m, ``place`` is the particle where they are worst; ``motion_square`` and ``motion_0`` ... are sums of
#: displacements for ``solvers.scene.displacement_moments``, ``margin`` is dt over its bound; what is off is NaN.
BASE_COLUMNS = ("step", "error_x", "error_v", "error_sigma", "error_a", "error_extra", "kinetic", "strain", "work",
                "crossings", "neighbour_gap", "mean_drift", "out_of_shape", "displacement_mismatch", "place",
                "motion_square", *(f"motion_{k}" for k in range(MODES)), "margin")
MARGIN = BASE_COLUMNS.index("margin")  # filled in by the host, once per launch
LOOKS = slice(BASE_COLUMNS.index("neighbour_gap"), MARGIN + 1)  # columns that only some samples have
#: Columns of each estimator: squares of the estimate and of its difference from the true error.
ESTIMATOR_COLUMNS = tuple(f"{kind}_{q}" for kind in ("estimate", "difference") for q in QUANTITIES)
#: Columns of the effect ``budget``, with its name in front.
BUDGET = tuple(f"budget/{name}" for name in ALL["budget"].columns)
SQUARE_PREFIXES = ("error_", "estimate_", "difference_", "size_")  # columns of sums of squares
MAX_ROWS = 512  # capacity, after which the host has to collect the rows


def column_names(estimators: tuple[str, ...], effects: tuple[str, ...]) -> list[str]:
    """Returns the names of the columns of a row of samples, in order, for a run with these estimators and effects;
    columns of an effect are prefixed with its name."""
    return [*BASE_COLUMNS, *(f"{estimator}/{name}" for estimator in estimators for name in ESTIMATOR_COLUMNS),
            *(f"{effect}/{name}" for effect in effects for name in ALL[effect].columns)]


def column_index(name: str, on: KernelOptions | None = None) -> int:
    """Returns the index of a column of samples in kernels, in ``ti.static``: of a base column, or with ``on`` of any
    column of the run, such as ``spin/torque``."""
    return BASE_COLUMNS.index(name) if on is None else column_names(on.estimators, on.effects).index(name)


def read_rows(rows: np.ndarray, scene: Scene, particles: int, margin_unit: float = 1.0) -> dict[str, np.ndarray]:
    """Returns rows of samples (T, C), with the C columns of the scene's run, as named series (T,).

    ``particles`` is the number in the sums, ``margin_unit`` the factor of margins, which kernels compute from
    Gershgorin's circles (``solvers.scene.step_bound``). The series are ``time`` in s, ``error_x`` ... (RMS over
    particles, SI), ``kinetic``, ``strain``, ``work`` (J), ``crossings`` (NaN if not counted) and, for each estimator,
    ``transport/estimate_x``, ``transport/difference_x`` and so on (RMS too). Of the budget, of ``FIELDS`` and
    ``CAUSES``, ``budget/error_x`` (RMS), ``budget/part_x_crossings``, the signed part that the cause made, mean(e_c
    e)/RMS(e), and ``budget/size_x_crossings``, the RMS of e_c. Other effects' columns as they are: ``spin/torque``.
    """
    names = column_names(scene.active_estimators, scene.active_effects)
    as_they_are = {*column_names((), scene.active_effects)} - {*BASE_COLUMNS, *BUDGET}
    series = dict(zip(names, rows.T.copy(), strict=True))
    series["time"] = series.pop("step") * scene.time_step
    series["margin"] *= margin_unit
    if not scene.has("crossings"):
        series["crossings"][:] = np.nan  # not counted: no reason to say that there were none
    for name, values in series.items():
        if name not in as_they_are and name.rpartition("/")[2].startswith(SQUARE_PREFIXES):
            np.sqrt(values / particles, out=values)
    for name in BUDGET:
        if name in series and "/part_" in name:
            error = series[f"budget/error_{name.split('_')[1]}"]
            series[name] = np.divide(series[name] / particles, error, out=np.zeros_like(error), where=error != 0)
    return series
