"""Results that are corrected: the particles minus their estimated errors."""

from dataclasses import replace

import numpy as np
import pytest

from solvers.problems.bar.scene import BarScene
from solvers.problems.ring import RingScene
from solvers.running.run import build, run
from solvers.solver.particle_snapshot import TRUTH

SCENES = {"bar": BarScene(cells=20, ppc=2, cfl=0.3, periods=0.3, estimators=("transport", "recovered")),
          "ring": RingScene(cells=24, cfl=0.3, periods=0.3, estimators=("recovered",))}


@pytest.mark.parametrize("problem", SCENES)
def test_the_corrected_error_is_that_of_the_particles_minus_the_estimate(problem):
    """Vectors and tensors are subtracted, not sizes; transport, whose size is not reliable, corrects nothing."""
    scene = replace(SCENES[problem], effects=("truth", "estimate"))
    result, solver = run(scene), build(scene)
    while solver.step < scene.steps:
        solver.advance(scene.steps - solver.step)
    errors = solver.fields().errors
    assert list(result.corrected) == ["recovered"] and result.corrected["recovered"]["a"]["max"] is None
    for q, missed in zip(("x", "v", "sigma"), errors[TRUTH].minus_errors(errors["recovered"]), strict=True):
        weights = (1, 2, 1)[:missed.shape[1]] if q == "sigma" else 1  # xx, xy, yy
        left = np.sqrt(np.mean(np.sum(weights * missed**2, axis=1)))
        assert result.corrected["recovered"][q]["final"] == pytest.approx(left, rel=1e-9), q
        assert result.corrected["recovered"][q]["max"] < 0.6 * result.error[q]["max"], q


def test_nothing_is_corrected_where_the_estimate_is_not_valid():
    result = run(BarScene(cells=40, ppc=1, amplitude=0.025, cfl=0.3, periods=0.5, estimators=("two-grid",)))
    assert "two-grid" in result.not_valid
    assert result.corrected["two-grid"]["x"] == {"final": None, "max": None, "mean": None}
