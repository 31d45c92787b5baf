"""What a run gone bad leaves: numbers up to the largest there are, and beyond. It is a result like any other."""

import json
from dataclasses import replace

import numpy as np
import pytest

from app.commands.run.text_summary import run_table
from app.pictures.run_errors import png_bytes, run_figure
from solvers import BarScene, RingScene
from solvers.study import convergence_analysis
from solvers.study.convergence_order import fit_order

SCENES = (BarScene(cells=20, ppc=2, amplitude=0.004, periods=0.2, estimators=("companion",)),
          RingScene(cells=12, amplitude=0.05, periods=0.5, cfl=0.2, estimators=("companion",)))
LEFT = {"huge": [1e308], "tiny": [5e-324], "anything": [1e308, np.inf, np.nan, 1e-300, 0.0, 1e155]}


def spoilt(values: np.ndarray, left: list[float], signed: bool = False) -> np.ndarray:
    """The second half of the values as a run gone bad may leave them; of both signs where they may be negative."""
    changed = np.array(values, dtype=float)
    half = np.resize(left, changed.size - changed.size // 2)
    changed.flat[changed.size // 2:] = half * np.resize([1.0, -1.0], half.shape) if signed else half
    return changed


@pytest.mark.parametrize(("scene", "left"), [
    pytest.param(scene, left, marks=() if scene.problem == "bar" or left == "anything" else pytest.mark.slow)
    for scene in SCENES for left in LEFT],
    ids=lambda value: value if isinstance(value, str) else value.problem)
def test_object_table_and_picture_survive_what_a_run_leaves(scene, left, simulate):
    result, numbers = simulate(scene), LEFT[left]
    series = {name: values if name in ("time", "place") else spoilt(values, numbers)
              for name, values in result.series.items()}
    final = result.final
    final = replace(final, position=spoilt(final.position, numbers, True), error=spoilt(final.error, numbers),
                    velocity=spoilt(final.velocity, numbers, True),
                    deformation_gradient=spoilt(final.deformation_gradient, numbers, True),
                    estimate={name: spoilt(values, numbers) for name, values in final.estimate.items()})
    gone = replace(result, series=series, final=final, status="unstable", explanation="gone", broken_at=0.1)
    values = gone.to_dict()
    json.dumps(values, allow_nan=False)
    values["grid_crossings"] = 8 * 10**32
    assert max(map(len, run_table(values).splitlines())) < 100
    assert png_bytes(run_figure(gone))


def test_fits_of_errors_at_the_ends_of_numbers_are_fits_or_nothing():
    h = [0.1, 0.09, 0.08]
    for errors in ([1e308, 1e-300, 1e308], [1e-308, 1e-300, 1e300], [5e-324, 1e-300, 1.0], [1e308] * 3):
        fit, balance = fit_order(h, errors), convergence_analysis.fit_space_time(h, errors)
        assert fit.order is None and np.isfinite(fit.pairwise).all()
        assert balance is None or np.isfinite([balance.space, balance.factor]).all()
