"""The bar under two tones: its exact solution against its equation of motion, and estimates against both."""

from dataclasses import replace

import numpy as np
import pytest

from solvers import run
from solvers.problems.bar import exact_solution
from solvers.problems.bar.estimators.companion import mesh
from solvers.problems.bar.scene import TWO_TONE_AMPLITUDE_LIMIT, BarScene

BAR = BarScene(body_force="two-tone", linearity_preserving=True, estimators=("recovered", "companion"))


def modal_motion(scene: BarScene, X: np.ndarray, t: float) -> tuple[np.ndarray, ...]:
    """u, v, F - 1 and b of the linear bar: q'' + w_n^2 q = B sin(wt) mode by mode, tones and start as printed."""
    c, w, A = scene.wave_speed, np.pi * scene.wave_speed, scene.amplitude
    u, v, strain, b = np.zeros((4, len(X)))
    for k, B, W, speed in ((2 * np.pi, 3 * w * w * A, w, A * w), (4 * np.pi, 1.5 * w * w * A, 1.7 * w, 0.0)):
        natural = c * k
        forced = B / (natural**2 - W**2)
        free = (speed - forced * W) / natural
        q = forced * np.sin(W * t) + free * np.sin(natural * t)
        u += q * np.sin(k * X)
        v += (forced * W * np.cos(W * t) + free * natural * np.cos(natural * t)) * np.sin(k * X)
        strain += q * k * np.cos(k * X)
        b += B * np.sin(W * t) * np.sin(k * X)
    return u, v, strain, b


@pytest.mark.parametrize("t", [0.0, 0.31, 4.7])
def test_the_built_in_solution_is_that_of_its_two_modes(t):
    """To rounding, with the force as printed; a period is still that of the first tone."""
    X = np.linspace(0, 1, 41)
    for name, known in zip(("displacement", "velocity", "deformation_gradient", "body_force"), modal_motion(BAR, X, t),
                           strict=True):
        found = getattr(exact_solution, name)(BAR, X, t) - (name == "deformation_gradient")
        np.testing.assert_allclose(found, known, rtol=0, atol=1e-12 * max(1e-2, np.abs(known).max()))
    assert (BAR.period, BAR.motion_period) == pytest.approx((1.0, 10.0), rel=1e-12)


def test_beyond_the_largest_amplitude_the_bar_folds():
    """F over ten periods, in which the motion returns, comes to .05 at the limit."""
    scene, X = replace(BAR, amplitude=0.999 * TWO_TONE_AMPLITUDE_LIMIT), np.linspace(0, 1, 201)
    least = min((1 + modal_motion(scene, X, t)[2]).min() for t in np.linspace(0, 10, 2001))
    assert least == pytest.approx(0.0525, abs=0.002)


def test_the_companion_has_elements_enough_for_the_second_wave():
    """On a bar of few cells, too: polynomials of degree 4 on so many elements have it to a ten-thousandth."""
    elements, X = mesh(replace(BAR, cells=11)), np.linspace(0, 1, 301)[:-1]
    element, basis, _ = elements.evaluate_basis(X)
    nodes = np.sin(4 * np.pi * elements.node_coordinates)[elements.node_of_point]
    found = np.sum(basis * nodes[element], axis=1)
    assert np.abs(found - np.sin(4 * np.pi * X)).max() < 1e-4


@pytest.mark.parametrize(("changes", "band"), [
    ({"amplitude": 2.5e-4, "cfl": 0.1, "periods": 0.5}, 0.05),
    ({"amplitude": 0.025, "modulus": 1000.0, "dt": 2.5e-5, "t_end": 0.25}, 0.05),
    ({"amplitude": 0.01, "cells": 11, "periods": 1.5}, 0.1)], ids=["small", "large", "coarse"])
def test_estimates_are_judged_by_the_truth(changes, band):
    """Companion to .2 %; recovered to the ``band``, wider where the grid is coarse, which its index says."""
    result = run(replace(BAR, effects=("truth", "estimate", "soundness"), **changes), prices=False)
    assert result.status == "ok" and result.not_valid == {}
    for quantity in ("x", "v", "sigma"):
        assert result.index["companion"][quantity] == pytest.approx(1, abs=0.002)
        assert result.index["recovered"][quantity] == pytest.approx(1, abs=band)
