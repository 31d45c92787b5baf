"""What a run makes of its inputs: each reaches the kernels, some only scale, and what goes bad ends with a reason."""

from dataclasses import replace

import numpy as np
import pytest

from solvers.problems.bar.scene import BarScene
from solvers.problems.ring import RingScene
from solvers.problems.vortex import VortexScene

BARE = {"estimators": (), "effects": ("truth", "energy")}
SCENES = {"bar": BarScene(cells=20, amplitude=0.025, cfl=0.05, periods=0.5, **BARE),
          "ring": RingScene(cells=16, periods=0.25, cfl=0.1, **BARE),
          "vortex": VortexScene(cells=16, cfl=0.1, t_end=0.1, **BARE)}
OF_ALL = ({"cells": 17}, {"ppc": 5}, {"cfl": 0.06}, {"cfl": None, "dt": 1e-4})
OF_RINGS = ({"layout": "cartesian"}, {"body_force": "none"}, {"velocity": "particle"}, {"method": "ugimp"})
CHANGES = {
    "bar": ({"amplitude": 0.026}, {"modulus": 5.0}, {"density": 1.1}, {"periods": 0.6},
            {"periods": None, "t_end": 0.4}),
    "ring": ({"amplitude": 0.11}, {"modulus": 1.1e7}, {"density": 1100.0}, {"periods": 0.3},
             {"periods": None, "t_end": 0.006}, *OF_RINGS),
    "vortex": ({"amplitude": 0.9}, {"modulus": 1100.0}, {"density": 1100.0}, {"poisson_ratio": 0.2}, {"frequency": 1.1},
               {"body_force": "two-tone"}, *OF_RINGS)}


@pytest.mark.parametrize(("problem", "change"), [
    (problem, change) for problem in SCENES for change in (*OF_ALL, *CHANGES[problem])], ids=str)
def test_every_input_reaches_the_kernel(problem, change, simulate):
    """An input baked into compiled code would leave the result as it was."""
    one, other = (simulate(scene).final for scene in (SCENES[problem], replace(SCENES[problem], **change)))
    assert one.velocity.shape != other.velocity.shape or not np.array_equal(one.velocity, other.velocity)
    assert np.isfinite(other.velocity).all()


@pytest.mark.parametrize(("problem", "modulus", "density"), [
    ("bar", 4.0, 1.0), ("bar", 1.0, 250.0), ("bar", 2.75, 3.7), ("ring", 4.0, 1.0), ("ring", 1.0, 0.01),
    ("ring", 0.033, 0.27)])
def test_modulus_and_density_only_scale_time(problem, modulus, density, simulate):
    """So many times the usual ones, at one cfl and number of periods: same x, v scaled by c, sigma by E; rounding over
    66 and 800 steps."""
    scene = SCENES[problem]
    one, other = simulate(scene), simulate(replace(scene, modulus=modulus * scene.modulus,
                                                   density=density * scene.density))
    c = other.scene.wave_speed / scene.wave_speed
    assert one.steps == other.steps
    near = 1e-9 if problem == "bar" else 1e-8
    for name, scale in {"error_x": 1, "error_v": c, "error_sigma": modulus, "kinetic": density * c**2}.items():
        np.testing.assert_allclose(other.series[name], scale * one.series[name], rtol=near,
                                   atol=1e-3 * near * scale * np.abs(one.series[name]).max())
    assert np.abs(one.final.position - other.final.position).max() < 1e-13


@pytest.mark.parametrize("method", ["ugimp", "cpgimp", "cpdi"])
def test_unstable_runs_end_with_a_reason(method, simulate):
    """Beyond its limit every method of the ring breaks: a result, and a sentence that says what to do."""
    result = simulate(RingScene(method=method, cells=16, cfl=1.2, periods=5, **BARE))
    assert result.status == "unstable" and result.steps < result.scene.steps
    assert "went unstable" in result.reason and "the automatic step" in result.reason
