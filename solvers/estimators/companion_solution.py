"""The companion: a hidden, higher-order solution of the same problem, with which the particles are compared.

An embedded pair, as in the step control of ordinary differential equations: the difference of two methods of very
different order is the error of the poorer one. The companion is a total-Lagrangian spectral-element solve of order
p = 4 to 6 (``spectral``; in each problem's ``estimators``) on a mesh of its own. It takes nothing from the
particles: body force b(X, t) and initial velocity are the problem's, the rest is Newton's law. It reports

    e_x = x_p - X_p - u(X_p, t), e_v = v_p - v(X_p, t), e_sigma = sigma_p - sigma(X_p, t), e_a = a_p - a(X_p, t - dt),

the last a step earlier, because a_p is the acceleration of the last step. So it sees every error of the particles: of
mappings, time, boundaries, geometry, and of a misplaced body force. It needs an elastic body that stays smooth, and b
and the initial velocity at any material point; it cannot see errors in these or in the material law, which it shares.

In time it takes Nystrom's method of three stages and fourth order (Hairer, Norsett & Wanner 1993, II.14) with steps
of k time steps of the particles, always ahead of them, so that any instant lies inside its last step and is found by
cubic Hermite polynomials: in (u, v) for u, in (v, a) for v, and their derivative for a.

This file is what all problems share: nodes with u, v and a of two components, of which the bar uses the first.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import taichi as ti

from solvers.estimators.spectral_elements import STABLE, unresolved_size
from solvers.kernels.dtypes import integers, reals, rows
from solvers.scene.estimator_hooks import EstimatorHooks
from solvers.translatable_message import Message

CHOSEN = 2.2  # omega H of the interval at rest: strain may stiffen the body by (2.4/2.2)^2 before a step is cut in two
MOST_INTERVAL = 20  # particle steps: beyond, there is nothing left to save
MOST_SUBSTEPS = 64  # a body strained beyond what these allow is no elastic body any more
MAX_ERROR_SHARE = 0.2  # of the estimate that the companion's own error may be

#: Indices in ``companion_counts``: order p, elements (across the body and around it), nodes (per row and in total),
#: radii of nodes, and particle steps per interval.
ORDER, ACROSS, AROUND, ROW, NODES, RADII, INTERVAL = range(7)
#: Indices in ``companion_numbers``: the highest frequency of the body at rest, the stiffest tangent over that at rest,
#: and the mean square of the error of x in the last report.
FREQUENCY, STIFFEST, SQUARE = range(3)
#: Layers of ``companion_nodes``, each with a row of eight for every node. At the start of the interval, at its end and
#: at the time of a report: u, v, a; in WORK: trial u, acceleration, k2, 1/mass (0 where a symmetry plane fixes it).
START, END, WORK, NOW = range(4)
LAYERS = 4


@ti.func
def advance_companion_if_due(body: ti.template(), step, accelerate: ti.template(), on: ti.template()):
    """Advances the companion in the state ``body`` by an interval if ``step``, counted from 1, is the first beyond it.

    The stages of one sub-step of length H from (u, v, a = k1) at t are k2 = f(t + H/2, u + H/2 v + H^2/8 k1) and
    k3 = f(t + H, u + H v + H^2/2 k2); then u += H v + H^2/6 (k1 + 2 k2), v += H/6 (k1 + 4 k2 + k3), and a third
    evaluation finds the new a; before the first interval only the a of the start. ``accelerate(body, t, on)``, with the
    compile-time options ``on``, writes the acceleration f(t, u) in m/s^2 at the trial u to all nodes' row in WORK.
    """
    begun = step - 1
    if begun % body.companion_counts[INTERVAL] == 0:
        copy_end_to_start(body)
        length = body.companion_counts[INTERVAL] * body.dt
        # Strain stiffens: the highest frequency grows with the square root of the stiffest tangent.
        highest = body.companion_numbers[FREQUENCY] * ti.sqrt(body.companion_numbers[STIFFEST])
        substeps = ti.cast(ti.min(ti.max(ti.ceil(length * highest / STABLE), 1.0), MOST_SUBSTEPS), ti.i32)
        H = length / substeps
        for k in range(-1 if begun == 0 else 0, substeps):
            for stage in range(2 if k < 0 else 0, 3):
                set_trial_displacement(body, stage, H)
                accelerate(body, begun * body.dt + (k + (0.5 if stage == 0 else 1.0)) * H, on)
                finish_stage(body, stage, H)
            if k < 0:
                copy_end_to_start(body)


@ti.func
def copy_end_to_start(body: ti.template()):
    """Copies u, v and a of the companion's nodes at the end of an interval to the start of the next, in the state."""
    N = body.companion_counts[NODES]
    for i in range(N):
        body.companion_nodes[START * N + i] = body.companion_nodes[END * N + i]


@ti.func
def set_trial_displacement(body: ti.template(), stage, H):
    """Writes all nodes' trial u (m) for the acceleration of ``stage`` (0 to 2) of a step of H s, and zero for that."""
    N = body.companion_counts[NODES]
    ahead, curve = 0.0, 0.0  # nothing for the acceleration at the end of the step
    if stage == 0:
        ahead, curve = 0.5 * H, 0.125 * H * H
    if stage == 1:
        ahead, curve = H, 0.5 * H * H
    for i in range(N):
        end, work = body.companion_nodes[END * N + i], body.companion_nodes[WORK * N + i]
        body.companion_nodes[WORK * N + i] = ti.Vector([
            end[0] + ahead * end[2] + curve * work[4], end[1] + ahead * end[3] + curve * work[5],
            0.0, 0.0, work[4], work[5], work[6], work[7]])


@ti.func
def finish_stage(body: ti.template(), stage, H):
    """Stores the acceleration of ``stage`` (0 to 2) of a step of H s; after 1 also its end's u and v, after 2 its a."""
    N = body.companion_counts[NODES]
    for i in range(N):
        end, work = body.companion_nodes[END * N + i], body.companion_nodes[WORK * N + i]
        for c in ti.static(range(2)):
            k, k2 = work[2 + c], work[4 + c]
            if stage == 1:
                v, k1 = end[2 + c], end[4 + c]
                end[c] += H * (v + H / 6 * (k1 + 2 * k2))
                end[2 + c] = v + H / 6 * (k1 + 4 * k2 + k)
            if stage == 2:
                end[4 + c] = k
            work[4 + c] = k
        body.companion_nodes[END * N + i], body.companion_nodes[WORK * N + i] = end, work


@ti.func
def interpolate_nodes_in_time(body: ti.template(), step):
    """Writes all nodes' u (m) and v (m/s) after ``step`` steps of the run, and a (m/s^2) one before, to layer NOW."""
    k, N = body.companion_counts[INTERVAL], body.companion_counts[NODES]
    H = k * body.dt
    s = (step - (ti.max(step - 1, 0) // k) * k) / ti.cast(k, ti.f64)
    left = 1 - s
    value = ti.Vector([(1 + 2 * s) * left * left, s * left * left * H, s * s * (3 - 2 * s), -s * s * left * H])
    s = ti.max(s - 1.0 / k, 0.0)
    slope = ti.Vector([6 * s * (s - 1) / H, 3 * s * s - 4 * s + 1, -6 * s * (s - 1) / H, 3 * s * s - 2 * s])
    for i in range(N):
        old, new = body.companion_nodes[START * N + i], body.companion_nodes[END * N + i]
        now = ti.Vector([0.0] * 8)
        for c in ti.static(range(4)):
            now[c] = value[0] * old[c] + value[1] * old[2 + c] + value[2] * new[c] + value[3] * new[2 + c]
        for c in ti.static(range(2, 4)):
            now[2 + c] = slope[0] * old[c] + slope[1] * old[2 + c] + slope[2] * new[c] + slope[3] * new[2 + c]
        body.companion_nodes[NOW * N + i] = now


def hooks(accelerate: Callable, memory: Mapping[str, object], **others: Any) -> EstimatorHooks:
    """Returns the hooks of a problem's companion: ``accelerate`` as in :func:`advance_companion_if_due`, ``memory`` the
    types of the problem's own arrays by name, ``others`` further fields of :class:`EstimatorHooks`."""
    @ti.func
    def after_step(body: ti.template(), base, step, on: ti.template()):
        advance_companion_if_due(body, step, accelerate, on)

    shared = {"companion_counts": integers, "companion_numbers": reals, "companion_nodes": rows}  # by the names above
    return EstimatorHooks(memory={**shared, **memory}, after_step=after_step,
                          interval=lambda scene: 1,  # it checks in every step whether its own, longer one is over
                          **others)


def initial_companion_arrays(sizes: Sequence[int], frequency: float, dt: float, velocity: np.ndarray,
                             inverse_mass: np.ndarray, extra: int = 0) -> dict[str, np.ndarray]:
    """Returns the companion's arrays by name for a body of N nodes, undeformed at t = 0. ``sizes`` are its first six
    ``companion_counts``, ``frequency`` the highest at rest (1/s), ``dt`` the particles' step (s), ``velocity`` (N, 2)
    in m/s; ``inverse_mass`` (N, 2) is 0 for fixed components; ``companion_nodes`` gets ``extra`` rows at its end."""
    layers = np.zeros((LAYERS, len(velocity), 8))
    layers[START, :, 2:4] = layers[END, :, 2:4] = velocity * (inverse_mass > 0)
    layers[WORK, :, 6:] = inverse_mass
    return {"companion_counts": np.array([*sizes, steps_per_companion_step(frequency, dt)], np.int32),
            "companion_numbers": np.array([frequency, 1.0, 0.0]),
            "companion_nodes": np.concatenate([layers.reshape(-1, 8), np.zeros((extra, 8))])}


def steps_per_companion_step(frequency: float, dt: float) -> int:
    """Returns the particle steps per companion interval; ``frequency`` is the highest at rest, in 1/s, ``dt`` in s."""
    return max(1, min(MOST_INTERVAL, int(CHOSEN / (frequency * dt))))


def why_not_trusted(elements: np.ndarray, axes: tuple[int, ...], square: float) -> str | None:
    """Returns a sentence why not to trust the companion's estimate, or None. ``elements`` (..., 2) are displacements in
    m, an element's points along the ``axes``; ``square`` is the mean square of x's estimated error in m^2."""
    if not np.all(np.isfinite(elements)):
        return Message("not valid here: the companion solve itself has failed; choose a smaller amplitude or fewer "
                       "periods")
    missed = max(float(np.sqrt(np.mean(np.sum(unresolved_size(elements, axis) ** 2, axis=-1)))) for axis in axes)
    if missed > MAX_ERROR_SHARE * np.sqrt(square):  # never for an unstable run, whose error is huge
        return Message("not valid here: the companion solve itself may be {missed:.1g} m off, against an estimated "
                       "error of {square:.1g} m", missed, np.sqrt(square))
    return None
