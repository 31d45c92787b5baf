"""Bodies that are one rectangle between free and clamped sides, whose particles are a product of two lines."""

import math
from typing import NamedTuple

import numpy as np

from solvers.bodies.body import Body
from solvers.bodies.patch import CLAMPED, ROLLER, SMALL
from solvers.scene.estimator_registry import COMPANION
from solvers.scene.validation import SceneError, require_choice

RECOVERED = "recovered"
ESTIMATORS = (COMPANION, RECOVERED)  # which estimate a run gets: the companions' alone, or a second one beside it
FEWEST = 4  # particles along a side that a fit can smooth


class Rectangle(NamedTuple):
    """``lengths`` in m along xi and eta, the unit vector ``direction`` (2,) along eta, and whether the sides are
    ``clamped`` at the ends of xi, and of eta."""

    lengths: tuple[float, float]
    direction: np.ndarray
    clamped: tuple[tuple[bool, bool], tuple[bool, bool]]


def check_estimator(body: Body, estimator: str) -> None:
    """Raises SceneError for an ``estimator`` that is none of ``ESTIMATORS`` or cannot estimate the body."""
    require_choice("estimator", estimator, ESTIMATORS)
    if estimator == RECOVERED:
        require_rectangle(body)


def require_rectangle(body: Body) -> Rectangle:
    """Returns the body's rectangle; raises SceneError for a body that recovered cannot estimate."""
    patch = body.patches[0]
    a, b, c, d = (np.array(corner, float) for corner in patch.corners)
    near = SMALL * patch.size
    skewed = abs((b - a) @ (d - a)) > near * patch.size or np.abs(a - b + c - d).max() > near
    if len(body.patches) > 1 or patch.arc or skewed or ROLLER in patch.sides:
        raise SceneError("estimator", RECOVERED, "needs a body of one rectangle with free and clamped sides; leave it "
                         "out, the companions estimate other bodies too")
    south, east, north, west = (kind == CLAMPED for kind in patch.sides)
    if (fewest := int(body.lattice_counts.min())) < FEWEST:
        raise SceneError("estimator", RECOVERED, "needs {least} particles along each side, and there are {fewest}; "
                         "take more cells", FEWEST, fewest)
    return Rectangle((math.dist(a, b), math.dist(a, d)), (d - a) / math.dist(a, d), ((west, east), (south, north)))
