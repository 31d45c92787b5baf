"""What the reference does in a step at a particle: the exact solution, in numbers that follow from X and the time
alone, or, where that is not looked at, the companion (``companion``)."""

import taichi as ti


@ti.func
def moment(bar: ti.template(), t):
    """The factors of time in a step that begins at t: of u; of v + dt a; of a; and of what a step of symplectic Euler
    misses of u and of v."""
    w, dt = bar.angular_frequency, bar.dt
    s0, c0, s1, c1 = ti.sin(w * t), ti.cos(w * t), ti.sin(w * (t + dt)), ti.cos(w * (t + dt))
    fast, bend = w * c0 - dt * w * w * s0, -w * w * s0
    return ti.Vector([s0, fast, bend, dt * fast - (s1 - s0), dt * bend - w * (c1 - c0)])


@ti.func
def motion(bar: ti.template(), p, now, on: ti.template()):
    """v + dt a, a, and what a step of symplectic Euler misses of u and of v, which the companion says later."""
    known = ti.Vector([bar.drift_velocity, 0.0, 0.0, 0.0])
    if ti.static(not on.truth):
        known = bar.reference_motion[p]
    elif ti.static(on.motion == "vibrate"):
        size = bar.amplitude * bar.sine[p]
        known = ti.Vector([size * now[1], size * now[2], size * now[3], size * now[4]])
    return known


@ti.func
def slopes(bar: ti.template(), p, now, on: ti.template()):
    """F, the slope of v + dt a along X, and what a step misses of F."""
    known = ti.Vector([1.0, 0.0, 0.0])
    if ti.static(not on.truth):
        kept = bar.reference_slopes[p]
        known = ti.Vector([kept[0], kept[1], 0.0])
    elif ti.static(on.motion == "vibrate"):
        size = 2 * ti.math.pi * bar.amplitude * bar.cosine[p]
        known = ti.Vector([1 + size * now[0], size * now[1], size * now[3]])
    return known
