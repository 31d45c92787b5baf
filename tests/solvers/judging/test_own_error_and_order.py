"""What the judge does not know itself, and the order in h of several grids."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from solvers.judging import handout
from solvers.judging.measure import QUANTITIES, Companions, rms
from solvers.judging.verdict import Judgement
from solvers.problems import PROBLEMS
from solvers.problems.bar.scene import BarScene


@pytest.mark.parametrize("problem", PROBLEMS)
def test_the_companions_own_error_is_the_difference_of_its_two_meshes(problem):
    """Of exact particles, and not nothing: the two meshes are two, and differ by about the error of the coarser one."""
    scene = PROBLEMS[problem].scene(cells=12, periods=0.3)
    times = (0.1 * scene.period, 0.3 * scene.period)
    judge, frame = Companions(scene, times), handout.exact(scene, times[1])
    doubt = judge.doubt(frame)
    X, found = frame.material_position, []
    for fine in (True, False):
        body, solved = handout.solution(scene, fine, times)
        u, v, _, sigma = handout.carried(scene, body, solved[1], X)
        found.append((u, v, sigma))
    coarser = judge.errors(frame, fine=False)
    for q, one, other in zip(QUANTITIES, *found, strict=True):
        assert doubt[q] == pytest.approx(rms(one - other), rel=1e-9)
        assert doubt[q] > 0 and doubt[q] == pytest.approx(rms(coarser[q]), rel=0.5)


@pytest.mark.parametrize("cells", [(20, 30, 60), (12, 16), (10, 11, 13, 40)], ids=str)
def test_the_order_of_any_grids_is_that_of_their_errors(cells):
    """Errors made up as C h^2 of x, C h^1.3 of v and C h^0.4 of sigma have these orders, pair by pair, to rounding."""
    orders, times = {"x": 2.0, "v": 1.3, "sigma": 0.4}, np.array([0.0, 0.1, 0.2])
    scenes = [BarScene(cells=n) for n in cells]
    grids = [SimpleNamespace(scene=scene, grid=SimpleNamespace(times=times),
                             norms={q: 0.07 * scene.spacing**p * np.array([9.0, 1.0, 0.5]) for q, p in orders.items()})
             for scene in scenes]
    found = Judgement(scenes[0], grids).orders()
    for q, p in orders.items():
        assert found[q]["order"] == pytest.approx(p, abs=1e-9)
        assert found[q]["pairwise"] == pytest.approx([p] * (len(cells) - 1), abs=1e-9)
