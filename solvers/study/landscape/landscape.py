"""Landscape: the error of a run as a function of one parameter of its scene, as far as it is known."""

from collections.abc import Sequence
from dataclasses import dataclass

from solvers.scene.scene import Scene
from solvers.study.landscape.error_history import REFUSED, TRUTH, ErrorHistory
from solvers.study.landscape.parameter_values import (
    first_crossing_value,
    has_effect,
    particle_steps,
    stability_bound,
)

PENDING, COSTLY = "pending", "costly"
MOST_PERIODS = 3.0  # that the runs of a landscape last


@dataclass(frozen=True)
class LandscapeRequest:
    """Request for the landscape of one parameter ("cells", "ppc", "amplitude", "modulus" or "cfl") of a scene: the
    largest error of a ``quantity`` ("x", "v", "sigma", "a") until the time ``until``, in periods of each run, the true
    one and that of an ``estimator``. ``reach`` are the low and high end and the step of the parameter's slider, step 0
    for a logarithmic one."""

    scene: Scene
    parameter: str
    until: float
    quantity: str
    estimator: str | None
    reach: tuple[float, float, float]


@dataclass(frozen=True)
class Landscape:
    """Answer to a :class:`LandscapeRequest`, so far: for each of the ascending ``values`` of the parameter, one of them
    that of the scene, the largest ``true`` and ``estimated`` error over the size of the quantity, NaN where pending or
    not valid; the expected ``seconds`` of a run on one processor, NaN where no rate has been measured; and the
    ``status``: "pending", "ok", "unstable", "lost", "refused" or, for a run that is too long, "costly".

    ``first_crossing`` is the smallest value with which a particle has changed its cell by then, in the exact motion,
    ``step_bound`` the value from which on linear theory expects an unstable run; each None where there is none or where
    it is not worked out yet. ``flat``: the parameter has no effect. ``complete``: nothing is pending."""

    request: LandscapeRequest
    values: tuple[float, ...]
    true: tuple[float, ...]
    estimated: tuple[float, ...]
    seconds: tuple[float, ...]
    status: tuple[str, ...]
    first_crossing: float | None
    step_bound: float | None
    flat: bool
    complete: bool


def assemble_landscape(request: LandscapeRequest, values: Sequence[float], histories: Sequence[ErrorHistory | None],
                       costly: Sequence[bool], rate: float) -> Landscape:
    """Returns the landscape of the ``values`` from the ``histories`` of their runs, None where unknown; ``costly`` says
    which are not to be computed, ``rate`` how many particle-steps a processor does in a second. A history that ends
    early counts until its longer successor is known. The step bound, which takes long, comes last."""
    scene, until, parameter = request.scene, request.until, request.parameter
    true, estimated, status, pending = [], [], [], False
    for history, refrain in zip(histories, costly, strict=True):
        short = history is None or history.until < until
        pending |= short and not refrain
        if history is None or (short and refrain):
            status.append(COSTLY if refrain else PENDING)
        else:
            status.append(history.status_at(until))
        known = history if history is not None and status[-1] not in (COSTLY, REFUSED) else ErrorHistory(0.0)
        true.append(known.largest_error(TRUTH, request.quantity, until))
        estimated.append(known.largest_error(request.estimator or "", request.quantity, until))
    return Landscape(
        request, tuple(values), tuple(true), tuple(estimated),
        tuple(particle_steps(scene, parameter, value, until) / rate for value in values), tuple(status),
        first_crossing_value(scene, parameter, values, until), None if pending else stability_bound(scene, parameter),
        not has_effect(scene, parameter), not pending)


def choose_costly(prices: Sequence[float], most: float, most_each: float) -> list[bool]:
    """Returns which points, in the order in which they are computed, are too dear: those that no longer fit into
    ``most`` s together, or that take more than ``most_each`` s alone; the first always fits."""
    costly: list[bool] = []
    left = most
    for price in prices:
        costly.append(bool(costly) and price > min(left, most_each))
        left -= price * (not costly[-1])
    return costly
