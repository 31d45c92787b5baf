"""Index and distance of an estimator also where it says itself that it does not hold, and a result has none."""

from solvers.running.result import Result
from solvers.solver.norms import RATIOS, error_index
from solvers.solver.rounding import rounding
from solvers.solver.samples import QUANTITIES


def ratio_of(result: Result, kind: str, estimator: str) -> dict[str, float | None]:
    """The "index" or the "distance" of each quantity."""
    return {q: error_index(result.series[f"{estimator}/{RATIOS[kind]}_{q}"], result.series[f"error_{q}"],
                           rounding(result.scene, q, result.steps)) for q in QUANTITIES}
