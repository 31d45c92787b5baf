"""The body force of the bar, per unit mass, at a material point.

"material" is eq 34: 3 w^2 A sin(2 pi X) sin(wt), for which the exact solution is known. "two-tone" adds 1.5 w^2 A sin(4
pi X) sin(1.7 wt), for which none is built in: there an estimate has to stand alone. That of a typed motion lies in a
table (``solvers.solver.separable_field_tables``), with functions of time by :func:`tone_amplitudes`.
"""

import taichi as ti

from solvers.motion.exact_solution import SECOND_FREQUENCY
from solvers.problems.bar.exact_solution import SECOND_RATIO
from solvers.scene.typed_motion_scene import TYPED
from solvers.solver.separable_field_tables import FORCE, compute_paired_time_functions, paired_field_at


@ti.func
def tone_amplitudes(bar: ti.template(), t, on: ti.template()):
    """Returns the amplitudes (2,) in m/s^2 of the body force's tones at time t in s; for a typed motion 0, and prepares
    ``bar.tables`` for :func:`body_force_on_particle` at t. ``on``: compile-time options."""
    return tabulated_tone_amplitudes(bar, bar.tables, bar.table_sizes, t, on)


@ti.func
def tabulated_tone_amplitudes(bar: ti.template(), tables: ti.template(), sizes: ti.template(), t, on: ti.template()):
    """Returns amplitudes (2,) in m/s^2 of the body force's tones at t in s; for a typed motion 0, and stores its time
    functions in ``tables`` with ``sizes`` (``separable_field_tables.pack_tables``). ``on``: kernel options."""
    first, second = 0.0, 0.0
    if ti.static(on.motion == TYPED):
        compute_paired_time_functions(tables, sizes, FORCE, bar.angular_frequency * t, 1.0)
    elif ti.static(on.body_force != "none"):
        first = bar.force_scale * ti.sin(bar.angular_frequency * t)
    if ti.static(on.body_force == "two-tone"):
        second = SECOND_RATIO * bar.force_scale * ti.sin(SECOND_FREQUENCY * bar.angular_frequency * t)
    return ti.Vector([first, second])


@ti.func
def body_force_at(tables: ti.template(), sizes: ti.template(), place, sine, cosine, size, on: ti.template()):
    """Returns body force per mass, in the unit of its tones' ``size`` (2,), with sin 2 pi X, cos 2 pi X as ``sine``,
    ``cosine``; for a typed motion of entry ``place`` of the ``tables``, in m/s^2. ``on``: kernel options."""
    force = size[0] * sine
    if ti.static(on.body_force == "two-tone"):
        force += size[1] * 2 * sine * cosine  # sin 4 pi X
    if ti.static(on.motion == TYPED):
        force = paired_field_at(tables, sizes, FORCE, place)[0]
    return force


@ti.func
def body_force_on_particle(bar: ti.template(), p, size, on: ti.template()):
    """Returns the body force per mass on particle p, in the unit of its tones' ``size`` (:func:`tone_amplitudes`).
    ``on``: compile-time options."""
    cosine = 0.0
    if ti.static(on.body_force == "two-tone"):
        cosine = bar.cosine[p]
    return body_force_at(bar.tables, bar.table_sizes, p, bar.sine[p], cosine, size, on)
