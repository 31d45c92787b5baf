"""Where an estimator keeps silent before anything has run, and where not: each rule in words. Of what it finds out in a
run tells the file of its name; that what it says is right, test_accuracy.py."""

from dataclasses import replace

import numpy as np
import pytest

from solvers.estimators.recovered_common import DAMPING
from solvers.problems.bar.estimator_limits import MOST_WAVE_CFL
from solvers.problems.bar.scene import BarScene
from solvers.problems.ring import RingScene
from solvers.problems.vortex import VortexScene
from solvers.scene import estimator_registry
from solvers.scene.scene import Scene, SceneError

RECOVERED, TWO_GRID = {"estimators": ("recovered",)}, {"estimators": ("two-grid",)}
BAR, RING, VORTEX = BarScene(), RingScene(), VortexScene()
#: Of which nothing is refused.
SMALL_BAR = replace(BAR, linearity_preserving=True, amplitude=2.5e-4, periods=1.0, **TWO_GRID)
FINE_RING = replace(RING, dt=2e-5, **TWO_GRID)
QUIET_VORTEX = replace(VORTEX, cells=24, amplitude=0.25, cfl=0.2, t_end=1.0, **RECOVERED)
TRANSPORT, COMPANION = {"estimators": ("transport",)}, {"estimators": ("companion",)}
#: Of an estimator's scene what is changed, and a word of the reason.
RULES = [
    *((replace(scene, **TRANSPORT), {"remedies": ("frozen-weights",)}, "transport assumes")
      for scene in (BAR, RING, QUIET_VORTEX)),
    (replace(BAR, **RECOVERED), {"cfl": 0.95}, "cfl of 0.94"),
    (replace(BAR, **TRANSPORT), {"method": "bspline"}, ""), (replace(RING, **COMPANION), {"amplitude": 0.35}, ""),
    *((SMALL_BAR, changes, word) for changes, word in (
        ({"cells": 15}, "too few"), ({"cells": 31, "body_force": "two-tone"}, "too few"),
        ({"cells": 40, "body_force": "two-tone", "amplitude": 0.025}, "too few"),
        ({"body_force": "node", "amplitude": 0.025}, "both grids"),
        ({"method": "mpm", "amplitude": 0.025}, "hat functions"),
        ({"linearity_preserving": False, "amplitude": 0.025}, "linearity preservation"),
        ({"periods": 6.0}, "radians behind"), ({"body_force": "two-tone", "periods": 0.8}, "radians behind"),
        ({"cells": 80, "amplitude": 0.025, "periods": 7.0}, "cause noise"),
        ({"ppc": 2, "amplitude": 0.01}, "with 2 per cell"), ({"ppc": 1, "amplitude": 0.004}, "with 1 per cell"),
        ({"remedies": ("pieces",), "linearity_preserving": False}, "leave pieces out"))),
    (replace(BAR, amplitude=1e-3, **TWO_GRID), {"remedies": ("null-space-filter", "coupled-deformation")},
     "leave coupled-deformation out"),
    *((FINE_RING, changes, word) for changes, word in (
        ({"cells": 11}, "too few"), ({"method": "ugimp"}, "tile"), ({"layout": "cartesian"}, "staircase"),
        ({"cells": 12, "amplitude": 0.25}, "grid of the second run"), ({"ppc": 1}, "one particle per cell"),
        ({"cells": 36, "body_force": "two-tone"}, "too few"), ({"body_force": "none"}, "too few"),
        ({"cells": 48, "body_force": "none"}, "radians behind"), ({"method": "cpgimp", "ppc": 3, "cells": 25}, "tile"),
        ({"amplitude": 0.15, "periods": 3.0}, "disturbances grow"), ({"remedies": ("frozen-weights",)}, "remedies"),
        ({"amplitude": 0.21, "periods": 0.7}, "the two runs part"),
        ({"cells": 14, "remedies": ("null-space-filter",)}, "give 15"))),
    *((replace(RING, **RECOVERED), changes, word) for changes, word in (
        ({"layout": "cartesian"}, "polar"), ({"cells": 12, "ppc": 1}, "needs 3 particles"),
        ({"cells": 14, "ppc": 1}, "needs 3 particles"), ({"ppc": 1, "velocity": "particle"}, "velocity grid"),
        ({"amplitude": 0.23, "periods": 0.7}, "0.6 periods"))),
    *((QUIET_VORTEX, changes, word) for changes, word in (
        ({"layout": "cartesian"}, "polar"), ({"cells": 12, "ppc": 1}, "cubic"),
        ({"cells": 23, "amplitude": 0.1, "ppc": 1}, "24 cells"), ({"cells": 20, "ppc": 1}, "24 cells"),
        ({"cells": 23, "amplitude": 0.1, "velocity": "particle"}, "24 cells"),
        ({"cells": 23, "amplitude": 0.1}, "frequency of 0.77/s"), ({"amplitude": 1.0}, "give 48 cells"),
        ({"cells": 48, "amplitude": 1.05}, "give 50 cells"),
        ({"cells": 28, "ppc": 2, "amplitude": 0.86, "cfl": 0.09}, "against each other"),
        ({"amplitude": 1.0, "cells": 48, "cfl": 0.3}, "cfl of")))]


@pytest.mark.parametrize(("scene", "changes", "word"), RULES, ids=lambda value: (
    f"{value.problem} {value.estimators[0]}" if isinstance(value, Scene) else str(value)))
def test_what_each_rule_refuses(scene, changes, word):
    """In words, at the number where it begins; without the change nothing is refused."""
    refused, [name] = replace(scene, **changes), scene.estimators
    assert refused.not_valid[name].startswith("not valid here: ") and word in refused.not_valid[name]
    assert refused.active_estimators == () and not scene.not_valid


def test_with_longer_steps_than_allowed_recovereds_own_motion_of_the_bar_is_unstable():
    """Waves exp(i theta k) on the quadratic B-splines of its error grid, h = c = 1: the largest factor of a step, with
    the symbols of their stiffness and of the smoothing C, Stoermer's correction and the damping of short waves."""
    def growth(H: float, theta: float) -> float:
        stiffness = 1 - 2 / 3 * np.cos(theta) - np.cos(2 * theta) / 3
        C = (66 + 52 * np.cos(theta) + 2 * np.cos(2 * theta)) / 120
        U, w, before, earlier = np.eye(4)  # the new ones from the last four
        U = U + H * w
        a = -stiffness * ((2 - C) * U + DAMPING * (1 - C) ** 2 * w)
        w = w + H * (a + (a - 2 * before + earlier) / 12)
        return abs(np.linalg.eigvals(np.stack([U, w, a, before]))).max()

    below, above = (max(growth(H, theta) for theta in np.linspace(0.01, np.pi, 300))
                    for H in (MOST_WAVE_CFL, MOST_WAVE_CFL + 0.002))
    assert below < 1 + 1e-9 and above > 1.001


def test_what_no_rule_refuses():
    """Next to where one begins. What is not said of a quantity is warned of."""
    for scene in (replace(RING, cells=15, ppc=2, **RECOVERED), replace(RING, amplitude=0.23, periods=0.6, **RECOVERED),
                  replace(VORTEX, cells=50, amplitude=1.05, cfl=0.05, **RECOVERED),
                  replace(BAR, remedies=("null-space-filter",), amplitude=1e-3, **TWO_GRID),
                  replace(RING, method="cpgimp", ppc=3, cells=24, **TWO_GRID)):
        assert not scene.not_valid, scene
    slow = replace(VORTEX, cells=23, amplitude=0.1, frequency=0.7, **RECOVERED)
    assert not slow.not_valid and "not estimate a here" in slow.warnings()[0]
    assert not replace(VORTEX, cells=24, amplitude=0.1, **RECOVERED).warnings()
    noisy = replace(RING, cells=36, ppc=1, cfl=0.2, periods=2.0, **RECOVERED)
    assert not noisy.not_valid and "sigma" in noisy.warnings()[0]
    crossing = replace(SMALL_BAR, modulus=1000.0, amplitude=2.5e-2, dt=2.5e-5, t_end=0.25, periods=None)
    assert all("does not estimate a" in scene.warnings()[0] for scene in (crossing, FINE_RING))
    assert not SMALL_BAR.warnings()


def test_two_grid_is_refused_to_the_vortex_in_words():
    """In one sentence that says why, and what there is; the ring is not refused it."""
    with pytest.raises(SceneError, match=r"two-grid: is not available for the vortex.*; give one of") as refused:
        replace(VORTEX, estimators=("two-grid",))
    assert "companion" in refused.value.sentence and refused.value.field == "estimators"
    estimator_registry.require_offered(("two-grid",), "ring", RingScene.choices("estimators"))


@pytest.mark.parametrize("chosen", ["nobody", ("nobody",), (3,), None])
def test_what_is_no_estimator_is_left_to_others(chosen):
    """A list of names that has none of them, and what is no list, is not this rule's business but the scene's."""
    estimator_registry.require_offered(chosen, "vortex", VortexScene.choices("estimators"))
    with pytest.raises(SceneError):
        replace(VORTEX, estimators=chosen)


def test_a_swing_from_node_to_node_is_told():
    """The fourth difference of +1, -1, +1, ... is 16 everywhere, and of a wave of a few cells it is less."""
    from solvers.estimators.recovered_common import ROUGH, SIZE, why_not_trusted

    memory = {"recovered_nodes": np.zeros(4), "recovered_numbers": np.zeros(8)}
    memory["recovered_numbers"][[ROUGH, SIZE]] = 15.9**2, 1.0
    assert why_not_trusted(memory, 1.0) is None
    memory["recovered_numbers"][ROUGH] = 16.1**2
    assert "from node to node by 1 times the error" in why_not_trusted(memory, 1.0)
