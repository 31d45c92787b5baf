"""A problem's own part of the phases of a step: its body force, and where its particles may be."""

import taichi as ti

from solvers.problems.planar.method.material_laws import LAWS, determinant, kirchhoff, piola
from solvers.problems.planar.method.neo_hookean_logarithms import compute_volumetric_stress
from solvers.problems.planar.method.symmetry_planes import make_symmetry_plane_kernels
from solvers.problems.planar.method.tensor_rotation import rotate_vector
from solvers.problems.planar.problem_kernel_functions import ProblemStepFunctions
from solvers.problems.planar.scene import PlanarScene
from solvers.solver.separable_field_tables import body_force_at, compute_force_time_functions


def make_problem_step_functions(kind: type[PlanarScene]) -> ProblemStepFunctions:
    """Returns the functions for kernels of the problem with the scene class ``kind``."""
    circular, volumetric, low = kind.CIRCULAR, kind.VOLUMETRIC, kind.PLANES[0]

    @ti.func
    def forces(body: ti.template(), t, on: ti.template()):
        """Writes the body force per mass (m/s^2) at t s: its functions of time to the tables, on circles itself."""
        compute_force_time_functions(body.tables, body.table_sizes, body.angular_frequency * t, on)
        if ti.static(circular and on.body_force != "none"):
            for k in range(body.orbits):
                body.orbit_force[k] = body_force_at(body.tables, body.table_sizes, k, on)

    @ti.func
    def prepare(body: ti.template(), start, end, on: ti.template()):
        """Writes lambda ln J of the particles from ``start`` up to ``end``, and their force where each is an orbit."""
        if ti.static(volumetric and LAWS[on.law].logarithmic):
            compute_volumetric_stress(body, start, end)
        if ti.static(not circular and on.body_force != "none"):
            for p in range(start, end):
                body.orbit_force[p] = body_force_at(body.tables, body.table_sizes, p, on)

    @ti.func
    def body_force_on(body: ti.template(), p):
        """Returns the body force (x, y) on particle p, in N per metre of thickness."""
        f = body.orbit_force[body.orbit[p]]
        if ti.static(circular):
            f = rotate_vector(body.direction[p], f[0], f[1])
        return body.mass[p] * f

    @ti.func
    def stress(body: ti.template(), p, on: ti.template()):
        """Returns J sigma of particle p as (xx, xy, yx, yy) in Pa, or P with frozen weights."""
        F, bulk, full = body.deformation_gradient[p], 0.0, ti.Vector([0.0] * 4)
        if ti.static(volumetric and LAWS[on.law].logarithmic):
            bulk = body.volumetric[p]
        J = determinant(F)
        q, r, _, _ = LAWS[on.law].coefficients(F, J, bulk, body.lame_modulus, body.shear_modulus)
        if ti.static(on.frozen):
            full[0], full[1], full[2], full[3] = piola(F, q, (r - q) / J)
        else:
            full[0], full[1], full[3] = kirchhoff(F, q, r)
            full[2] = full[1]
        return full

    @ti.func
    def has_escaped(body: ti.template(), p, step):
        """Returns whether particle p is at a place that none reaches in a sound run, at any ``step``."""
        q, X = body.position_velocity[p], body.material_position[p]
        least = -body.spacing if ti.static(low) else -body.farthest
        inside = q[0] > least and q[1] > least and q[0] < body.farthest and q[1] < body.farthest
        return not (inside and (q[0] - X[0]) ** 2 + (q[1] - X[1]) ** 2 < body.farthest_move ** 2)

    return ProblemStepFunctions(forces=forces, prepare=prepare, body_force_on=body_force_on, stress=stress,
                                has_escaped=has_escaped, **make_symmetry_plane_kernels(*kind.PLANES))
