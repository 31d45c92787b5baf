"""When a run of a plane body has gone bad: a particle inside out, crushed or not a number, or where none can be."""

import taichi as ti

from solvers.problems.planar.method.phases import moving
from solvers.solver.base import CRUSHED, ESCAPED, INVERTED

FLATTEST = 1e-3  # det F below which a particle counts as crushed
NO_NUMBER = -1e300  # stands for a det F that is not a number: flatter than any
SAME = 1e-12  # of itself, by which a det F may differ when it is found twice, in loops that are compiled otherwise


@ti.func
def check(body: ti.template(), step, has_escaped: ti.template()):
    """Stop a run with a particle with det F <= 0, tiny or NaN, the flattest of them, or else the first for which
    ``has_escaped(body, p)`` says that none of a sound run is there."""
    flattest, bad = FLATTEST, -1
    for p in range(body.particles):
        F = body.deformation_gradient[p]
        J = F[0] * F[3] - F[1] * F[2]
        if not J >= flattest:  # true for NaN too
            flattest, bad = NO_NUMBER if ti.math.isnan(J) else J, p
            body.verdict[0] = CRUSHED if J > 0 else INVERTED
        elif bad < 0 and has_escaped(body, p):
            bad = p
            body.verdict[0] = ESCAPED
    if bad >= 0:
        body.verdict[1], body.verdict[2] = step, bad


@ti.func
def check_at_once(body: ti.template(), step, has_escaped: ti.template()):
    """The same where all particles are looked at side by side, and the same particle: of several that are not numbers
    the last. To be called from a kernel itself, whose loops are run in parallel."""
    flattest, rank = FLATTEST, body.particles
    for p in range(moving(body)):
        J = flatness(body, p)
        if J < FLATTEST:
            ti.atomic_min(flattest, J)
    for p in range(moving(body)):
        if flattest < FLATTEST:
            if flatness(body, p) <= flattest + SAME * ti.abs(flattest):
                ti.atomic_min(rank, p if flattest > NO_NUMBER else body.particles - 1 - p)
        elif has_escaped(body, p):
            ti.atomic_min(rank, p)
    if rank < body.particles:
        body.verdict[0] = ESCAPED if flattest == FLATTEST else (CRUSHED if flattest > 0 else INVERTED)
        body.verdict[1] = step
        body.verdict[2] = rank if flattest > NO_NUMBER else body.particles - 1 - rank


@ti.func
def flatness(body: ti.template(), p):
    """det F of a particle, or what stands for one that is not a number."""
    F = body.deformation_gradient[p]
    J = F[0] * F[3] - F[1] * F[2]
    return NO_NUMBER if ti.math.isnan(J) else J
