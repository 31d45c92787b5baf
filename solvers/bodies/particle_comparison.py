"""A body's run beside two companions at its particles: fields of all three, estimated errors, and sums of squares."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import taichi as ti

from solvers.bodies.companion import BodyCompanion
from solvers.bodies.estimate import Differences
from solvers.bodies.goal import Goal
from solvers.bodies.goal_values import GoalSeries, goal_weights
from solvers.bodies.material_points import MaterialPoints
from solvers.bodies.spectral_mesh import lattice_basis
from solvers.kernels.dtypes import Integers, Octets, Pairs, Quads, Real, Reals
from solvers.kernels.launch import Launch
from solvers.motion.laws.elastic_material import NEO_HOOKEAN
from solvers.problems.planar.method.material_laws import LAWS, determinant, kirchhoff
from solvers.problems.planar.method.neo_hookean_logarithms import compute_volumetric_stress
from solvers.solver.state_arrays import Members, aligned_copy

TABLE = 4  # columns of ``batches``


@dataclass
class ComparisonState(Members):
    """State of a comparison at P particles in SI units, in batches of up to M; see ``LatticeBasis``. The coarser
    companion's part of an array comes first, in arrays of a batch the run's before."""

    lame_modulus: Real
    shear_modulus: Real
    factor: Real
    velocity_lead: Real
    position_velocity: Quads
    run_deformation_gradient: Quads
    acceleration: Pairs
    rest: Pairs  # the particles' positions at rest, from the same point on as ``position_velocity`` (P, 2)
    order: Integers
    nodes: Quads  # u and v at the companions' points
    basis: Pairs
    batches: Integers  # rows of four
    coordinate_gradients: Quads  # (2 P, 4)
    line: Octets  # u, v and derivative of u by xi at the points along eta of an element, at the xi of a batch
    motion: Quads  # u and v of a batch (3 M, 4)
    deformation_gradient: Quads  # of a batch (3 M, 4)
    volumetric: Reals  # lambda ln J in Pa of a batch (3 M,)
    error_sizes: Quads  # of the estimated errors of u, v and Cauchy stress at the particles, and 0 (P, 4)
    chosen: Integers  # C particles, ascending, and one number more that is none
    fields: Octets  # u, v and Cauchy stress xx, xy, yx, yy there (3 C + 1, 8)
    squares: Octets  # sums over the particles: of fine - coarse, run - fine, and the estimated errors (3, 8)


@ti.func
def evaluate_companion(state: ti.template(), which, table, start, end):
    """Writes u, v and F of the coarser (0) or the finer companion (1) at the particles from ``start`` up to ``end``, a
    batch whose row in ``batches`` begins at ``table``."""
    n, first, at_xi = state.order[which] + 1, state.batches[table], state.batches[table + 1]
    for j in range(n):
        total, slope = ti.Vector([0.0] * 4), ti.Vector([0.0] * 2)
        for i in range(n):
            node, basis = state.nodes[first + i * n + j], state.basis[at_xi + i]
            total += basis[0] * node
            slope += basis[1] * ti.Vector([node[0], node[1]])
        state.line[j] = ti.Vector([total[0], total[1], total[2], total[3], slope[0], slope[1], 0.0, 0.0])
    row, at_eta = (1 + which) * (state.volumetric.shape[0] // 3), state.batches[table + 2]
    for p in range(start, end):
        f, u_eta = ti.Vector([0.0] * 8), ti.Vector([0.0] * 2)
        for j in range(n):
            value, basis = state.line[j], state.basis[at_eta + j]
            f += basis[0] * value
            u_eta += basis[1] * ti.Vector([value[0], value[1]])
        g = state.coordinate_gradients[which * state.rest.shape[0] + p]
        state.motion[row] = ti.Vector([f[0], f[1], f[2], f[3]])
        state.deformation_gradient[row] = ti.Vector([
            1 + f[4] * g[0] + u_eta[0] * g[2], f[4] * g[1] + u_eta[0] * g[3],
            f[5] * g[0] + u_eta[1] * g[2], 1 + f[5] * g[1] + u_eta[1] * g[3]])
        row, at_eta = row + 1, at_eta + n


@ti.func
def read_run(state: ti.template(), start, end):
    """Writes u, v and F of the run at the particles from ``start`` up to ``end``."""
    for p in range(start, end):
        q, X, a = state.position_velocity[p], state.rest[p], state.velocity_lead * state.acceleration[p]
        state.motion[p - start] = ti.Vector([q[0] - X[0], q[1] - X[1], q[2] + a[0], q[3] + a[1]])
        state.deformation_gradient[p - start] = state.run_deformation_gradient[p]


@ti.func
def fields_of(state: ti.template(), row):
    """Returns u, v and the Cauchy stress (xx, xy, yx, yy) in a row of the batch; NaN where it is turned inside out."""
    u, F = state.motion[row], state.deformation_gradient[row]
    J = determinant(F)
    q, r, _, _ = LAWS[NEO_HOOKEAN].coefficients(F, J, state.volumetric[row], state.lame_modulus, state.shear_modulus)
    per_J = 1 / J if J > 0 else ti.math.nan
    xx, xy, yy = kirchhoff(F, q * per_J, r * per_J)
    return ti.Vector([u[0], u[1], u[2], u[3], xx, xy, xy, yy])


State = ti.types.argpack(**ComparisonState.types())


@ti.kernel
def compare_at_particles(unused: ti.i32, state: State):
    """Writes error sizes, sums of squares, and the fields at the chosen particles."""
    ti.loop_config(serialize=True)
    for _ in range(1):
        M, C, rows = state.volumetric.shape[0] // 3, state.chosen.shape[0] - 1, state.batches.shape[0] // (2 * TABLE)
        apart, found, estimated = ti.Vector([0.0] * 8), ti.Vector([0.0] * 8), ti.Vector([0.0] * 8)
        K, row = state.factor, 0
        extrapolated = ti.Vector([K, K, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
        for batch in range(rows - 1):
            table = TABLE * batch
            start, end = state.batches[table + 3], state.batches[table + TABLE + 3]
            read_run(state, start, end)
            for which in range(2):
                evaluate_companion(state, which, table + which * TABLE * rows, start, end)
            compute_volumetric_stress(state, 0, 3 * M)
            for p in range(start, end):
                run, coarse = fields_of(state, p - start), fields_of(state, M + p - start)
                fine = fields_of(state, 2 * M + p - start)
                error = run - fine - extrapolated * (fine - coarse)
                square = error * error
                state.error_sizes[p] = ti.sqrt(ti.Vector([square[0] + square[1], square[2] + square[3],
                                                          square[4] + square[5] + square[6] + square[7], 0.0]))
                apart += (fine - coarse) * (fine - coarse)
                found += (run - fine) * (run - fine)
                estimated += square
                if p == state.chosen[row]:
                    state.fields[row], state.fields[C + row], state.fields[2 * C + row] = run, coarse, fine
                    row += 1
        state.squares[0], state.squares[1], state.squares[2] = apart, found, estimated


class ParticleComparison:
    """Comparison of a ``run`` with a coarser and a finer companion of its body; ``factor`` K extrapolates the error of
    x to that against u_fine + K (u_fine - u_coarse). ``error_sizes`` (P, 3) are those of the estimated errors in the
    last comparison, in the order of ``QUANTITIES``, ``goals`` by name their values in all."""

    def __init__(self, run: MaterialPoints, companions: Sequence[BodyCompanion], factor: float,
                 goals: Mapping[str, Goal]):
        self._companions, own, X = companions, run.state, run.lattice.position
        weights = {name: goal_weights(goal, X) for name, goal in goals.items()}
        chosen = np.flatnonzero(sum(map(np.abs, weights.values()), np.zeros(len(X))))
        self.goals = {name: GoalSeries(goal, weights[name][chosen]) for name, goal in goals.items()}
        coarse, fine = (lattice_basis(one.mesh, run.lattice.lattices) for one in companions)
        fine.batches[:-1] += len(companions[0].motion), len(coarse.values), len(coarse.values), 0
        M = int(np.diff(coarse.batches[:, 3]).max())
        arrays = {"rest": X - run.corner, "order": np.array([one.mesh.order for one in companions], np.int32),
                  "nodes": np.concatenate([one.motion for one in companions]),
                  "basis": np.concatenate([coarse.values, fine.values]),
                  "batches": np.concatenate([coarse.batches, fine.batches]).astype(np.int32).ravel(),
                  "coordinate_gradients": np.concatenate([coarse.coordinate_gradients, fine.coordinate_gradients]),
                  "line": np.zeros((companions[1].mesh.order + 1, 8)), "motion": np.zeros((3 * M, 4)),
                  "deformation_gradient": np.tile([1.0, 0.0, 0.0, 1.0], (3 * M, 1)), "volumetric": np.zeros(3 * M),
                  "error_sizes": np.zeros((len(X), 4)), "chosen": np.append(chosen, -1).astype(np.int32),
                  "fields": np.zeros((3 * len(chosen) + 1, 8)), "squares": np.zeros((3, 8))}
        self._state = ComparisonState(
            lame_modulus=own.lame_modulus, shear_modulus=own.shear_modulus, factor=factor,
            velocity_lead=run.velocity_lead, position_velocity=own.position_velocity,
            run_deformation_gradient=own.deformation_gradient, acceleration=own.acceleration,
            **{name: aligned_copy(one) for name, one in arrays.items()})
        self._compare = Launch(compare_at_particles, State(**self._state.members()))
        self.error_sizes = self._state.error_sizes[:, :3]

    def compare(self) -> Differences:
        """Compares all three where they are now."""
        state = self._state
        np.concatenate([one.motion for one in self._companions], out=state.nodes)
        self._compare(0)
        for series in self.goals.values():
            series.add(state.fields[:-1].reshape(3, -1, 8))
        return Differences(*np.sqrt(np.add.reduceat(state.squares, (0, 2, 4), axis=1) / len(state.rest)))
