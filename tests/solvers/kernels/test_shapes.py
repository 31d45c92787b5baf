"""Shape functions: what the theory demands of every one of them, and their definitions term by term."""

import numpy as np
import pytest
import taichi as ti

from solvers.kernels import runtime
from solvers.kernels.shape_functions import complete_stencil, outer_weights
from tests.support.reference_bar import weight

METHODS = ["mpm", "ugimp", "cpgimp", "bspline"]
COUNT = 4000
EPS = np.finfo(float).eps
reals = ti.types.ndarray(dtype=ti.f64, ndim=1)
triples = ti.types.ndarray(dtype=ti.f64, ndim=2)


@ti.kernel
def evaluate(method: ti.template(), x: reals, half: reals, first: reals, S: triples, dS: triples):
    for p in range(x.shape[0]):
        node, left, right, slope_left, slope_right = outer_weights(method, x[p], half[p])
        weights, slopes = complete_stencil(left, right, slope_left, slope_right)
        first[p] = node
        for k in ti.static(range(3)):
            S[p, k] = weights[k]
            dS[p, k] = slopes[k]


def stencils(method: str, x: np.ndarray, half: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """First node, weights and gradients at positions ``x``, all in cells."""
    runtime.start("cpu", 1)
    first, S, dS = np.zeros(len(x)), np.zeros((len(x), 3)), np.zeros((len(x), 3))
    evaluate(method, x, half, first, S, dS)
    return first, S, dS


@pytest.fixture(params=METHODS)
def case(request):
    """Random positions in ten cells; half widths from 1/10 of a cell (5 ppc) to the widest, 1/2 (1 ppc)."""
    rng = np.random.default_rng(1)
    x, half = rng.uniform(0, 10, COUNT), rng.uniform(0.1, 0.5, COUNT)
    x[:21] = np.arange(21) / 2  # nodes and cell centres, where branches meet
    return request.param, x, half, *stencils(request.param, x, half)


def test_weights_sum_to_one_and_gradients_to_zero(case):
    """Partition of unity: mass is neither made nor lost. A few roundings of numbers up to 1/half width."""
    _, _, half, _, S, dS = case
    assert np.abs(S.sum(1) - 1).max() <= 4 * EPS
    assert np.all(np.abs(dS.sum(1)) <= 4 * EPS / half)


def test_linear_functions_are_reproduced(case):
    """sum S x_i = x and sum dS x_i = 1: a uniform motion or strain is seen exactly (rounding of x up to 10)."""
    _, x, half, first, S, dS = case
    nodes = first[:, None] + np.arange(3)
    assert np.abs((S * nodes).sum(1) - x).max() <= 10 * 16 * EPS
    assert np.all(np.abs((dS * nodes).sum(1) - 1) <= 10 * 16 * EPS / half)


def test_weights_follow_their_definitions(case):
    """Hat, three-branch GIMP and B-spline, at every node from 3 left to 3 right of the particle.

    That covers locality too: the definition is zero at every node that the stencil leaves out. The GIMP
    weights divide by the domain's length, so rounding grows as 1/half; positions carry 10 eps."""
    method, x, half, first, S, dS = case
    nodes = np.floor(x)[:, None] + np.arange(-3, 4)
    full, slopes = np.zeros_like(nodes), np.zeros_like(nodes)
    for k in range(3):
        at = (first + k - nodes[:, 0]).astype(int)
        full[np.arange(COUNT), at] += S[:, k]
        slopes[np.arange(COUNT), at] += dS[:, k]
    true, true_slopes = weight(method, x[:, None] - nodes, 1.0, half[:, None])
    # the hat's slope jumps at nodes
    smooth = ~np.isclose(x % 1, 0) if method == "mpm" else np.full(COUNT, True)
    bound = 10 * 16 * EPS / half[:, None]
    assert np.all(np.abs(full - true) <= bound)
    assert np.all((np.abs(slopes - true_slopes) <= bound / half[:, None])[smooth])
