"""The body force of the bar, per unit mass, at a material point.

"material" is eq 34: 3 w^2 A sin(2 pi X) sin(wt). That of a motion by formula lies in a table
(``solvers.solver.separable_field_tables``), with functions of time by :func:`force_amplitude`.
"""

import taichi as ti

from solvers.scene.typed_motion_scene import TYPED
from solvers.solver.separable_field_tables import FORCE, compute_paired_time_functions, paired_field_at


@ti.func
def force_amplitude(bar: ti.template(), t, on: ti.template()):
    """Returns the amplitude in m/s^2 of the body force at time t in s; for a motion by formula 0, and prepares
    ``bar.tables`` for :func:`body_force_on_particle` at t. ``on``: compile-time options."""
    return tabulated_force_amplitude(bar, bar.tables, bar.table_sizes, t, on)


@ti.func
def tabulated_force_amplitude(bar: ti.template(), tables: ti.template(), sizes: ti.template(), t, on: ti.template()):
    """Returns the amplitude in m/s^2 of the body force at t in s; for a motion by formula 0, and stores its time
    functions in ``tables`` with ``sizes`` (``separable_field_tables.pack_tables``). ``on``: kernel options."""
    size = 0.0
    if ti.static(on.motion == TYPED):
        compute_paired_time_functions(tables, sizes, FORCE, bar.angular_frequency * t, 1.0)
    elif ti.static(on.body_force != "none"):
        size = bar.force_scale * ti.sin(bar.angular_frequency * t)
    return size


@ti.func
def body_force_at(tables: ti.template(), sizes: ti.template(), place, sine, size, on: ti.template()):
    """Returns body force per mass in m/s^2, ``size`` times sin 2 pi X, given as ``sine``; for a motion by formula that
    of entry ``place`` of the ``tables``. ``on``: kernel options."""
    force = size * sine
    if ti.static(on.motion == TYPED):
        force = paired_field_at(tables, sizes, FORCE, place)[0]
    return force


@ti.func
def body_force_on_particle(bar: ti.template(), p, size, on: ti.template()):
    """Returns the body force per mass on particle p in m/s^2, of an amplitude ``size`` (:func:`force_amplitude`).
    ``on``: compile-time options."""
    return body_force_at(bar.tables, bar.table_sizes, p, bar.sine[p], size, on)
