"""The MPM run of a body: the planar step (``solvers.problems.planar.method``) on a grid with clamped and roller sides.

One kernel takes the steps between two samples. All of a body but its method are numbers and arrays, so that all bodies
with one method share a compilation. Positions are stored from the grid's corner on.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import taichi as ti

from solvers.bodies.body import Body
from solvers.bodies.force_series import body_force_at, compute_force_weights, force_terms, set_force
from solvers.bodies.grid_constraints import constrained_grid
from solvers.bodies.particle_lattice import particle_lattice
from solvers.kernels import runtime
from solvers.kernels.dtypes import Blocks, Integer, Integers, Octets, Pairs, Quads, Real, Reals
from solvers.kernels.launch import Launch
from solvers.motion.laws.elastic_material import NEO_HOOKEAN
from solvers.problems.planar.method import phases
from solvers.problems.planar.method.material_laws import LAWS, determinant, kirchhoff
from solvers.problems.planar.method.neo_hookean_logarithms import compute_volumetric_stress
from solvers.problems.planar.method.stored_weights import allocate_weights
from solvers.scene.estimator_hooks import NEVER
from solvers.scene.kernel_options import KernelOptions
from solvers.solver.base import SOUND
from solvers.solver.serial_stepping import CHECK_EVERY, check_particles
from solvers.solver.state_arrays import Members, aligned_copy, zeros

HALF_KICK = 0.5  # share of the acceleration that the first step of a run leaves out whose body is loaded from the start


@dataclass
class BodyState(Members):
    """State of a body's run in SI units, by the names of ``solvers.problems.planar.method.body``; and its own."""

    particles: Integer
    row: Integer
    active: Integer
    columns: Integer
    lines: Integer
    mirror_count: Integer
    slabs: Integer
    spacing: Real
    cells_per_length: Real
    origin: Real
    dt: Real
    lame_modulus: Real
    shear_modulus: Real
    density: Real
    half_width: Real
    position_velocity: Quads
    deformation_gradient: Quads
    mass: Reals
    volumetric: Reals
    edges: Quads
    weights: Blocks
    first_node: Integers
    acceleration: Pairs
    node_sums: Octets
    node_motion: Quads
    totals: Reals
    verdict: Integers
    node_hold: Pairs  # 0 for components of nodes that are held (N, 2)
    mirrors: Integers  # see ``ConstrainedGrid`` (3 M,)
    bounds: Reals  # least x and y, largest x and y of a sound run's particles (4,)
    left_out: Reals  # share of the acceleration that this step leaves out (1,)
    particle_force: Pairs  # per mass, in this step (P, 2)
    force_terms: Integer
    force_series: Pairs
    force_weights: Reals
    force_numbers: Reals


class StepFunctions(NamedTuple):
    """A body's own functions for ``phases``, as in ``solvers.problems.planar.problem_kernel_functions``."""

    prepare: object
    body_force_on: object
    stress: object
    pin: object


@ti.func
def prepare(body: ti.template(), start, end, on: ti.template()):
    """Writes lambda ln J and the force per mass of the particles from ``start`` up to ``end``."""
    compute_volumetric_stress(body, start, end)
    for p in range(start, end):
        body.particle_force[p] = body_force_at(body, p)


@ti.func
def body_force_on(body: ti.template(), p):
    """Returns the body force (x, y) on particle p, in N per metre of thickness."""
    return body.mass[p] * body.particle_force[p]


@ti.func
def stress(body: ti.template(), p, on: ti.template()):
    """Returns J sigma of particle p as (xx, xy, yx, yy) in Pa."""
    F = body.deformation_gradient[p]
    q, r, _, _ = LAWS[on.law].coefficients(F, determinant(F), body.volumetric[p], body.lame_modulus, body.shear_modulus)
    xx, xy, yy = kirchhoff(F, q, r)
    return ti.Vector([xx, xy, xy, yy])


@ti.func
def pin(body: ti.template(), i, j, record):
    """Returns node (i, j)'s ``record``, v and a, without held components and without what the first step leaves out."""
    hold, less = body.node_hold[j * body.row + i], body.left_out[0]
    return ti.Vector([hold[0] * (record[0] - less * body.dt * record[2]),
                      hold[1] * (record[1] - less * body.dt * record[3]),
                      hold[0] * (1 - less) * record[2], hold[1] * (1 - less) * record[3]])


@ti.func
def has_escaped(body: ti.template(), p, step):
    """Returns whether particle p has left the domain, at any ``step``."""
    q = body.position_velocity[p]
    return not (q[0] > body.bounds[0] and q[1] > body.bounds[1] and q[0] < body.bounds[2] and q[1] < body.bounds[3])


TRAITS = StepFunctions(prepare, body_force_on, stress, pin)


@ti.func
def one_step(body: ti.template(), step, on: ti.template()):
    """Takes step number ``step`` (from 0)."""
    compute_force_weights(body, step * body.dt)
    for j in range(body.lines):
        for node in range(j * body.row, j * body.row + body.columns):
            body.node_sums[node] = ti.Vector([0.0] * 8)
    phases.map_to_nodes(body, 0, body.particles, 0, TRAITS, on)
    for k in range(body.mirror_count):
        in_x = 1.0 - 2.0 * body.mirrors[3 * k + 2]
        phases.fold_ghost_sums(body, body.mirrors[3 * k], body.mirrors[3 * k + 1], in_x, -in_x)
    least = phases.EMPTY * body.density * body.spacing * body.spacing
    for j in range(body.lines):
        for i in range(body.columns):
            phases.update_node(body, i, j, least, TRAITS, on)
    for k in range(body.mirror_count):
        in_x = 1.0 - 2.0 * body.mirrors[3 * k + 2]
        body.node_motion[body.mirrors[3 * k]] = \
            ti.Vector([in_x, -in_x, in_x, -in_x]) * body.node_motion[body.mirrors[3 * k + 1]]
    phases.nodes_to_particles(body, 0, step, TRAITS, on)
    body.left_out[0] = 0.0


State = ti.types.argpack(**BodyState.types())


@ti.kernel
def take_steps(first: ti.i32, count: ti.i32, state: State, on: ti.template()):
    """Takes up to ``count`` steps after the first ``first``; fewer when a check finds the run unstable."""
    ti.loop_config(serialize=True)
    for k in range(count):
        if state.verdict[0] == SOUND:
            one_step(state, first + k, on)
            if (first + k + 1) % CHECK_EVERY == 0 or k == count - 1:
                check_particles(state, first + k + 1, phases.jacobian, has_escaped)


class MaterialPoints:
    """Run of a body to its end with so many ``samples``, which are evenly spaced; ``counts`` (K, 2) are the particles
    along xi and eta of each patch. With ``half_start`` the first step's kick is halved and velocities are reported at
    the ends of steps: so does a body that is loaded from the start move without an error of first order in time."""

    def __init__(self, body: Body, samples: int, counts: np.ndarray, half_start: bool):
        runtime.start()
        self.lattice = lattice = particle_lattice(body, counts)
        self._body, self._samples = body, 0
        self._interval = body.t_end / samples
        self.steps = max(2, math.ceil(self._interval / body.time_step - 1e-9))  # from sample to sample
        grid, P, K = constrained_grid(body), len(lattice.volume), force_terms(body)
        self.corner = grid.corner
        low, high = np.array(body.domain, float) - grid.corner  # a cell more than this is allowed: sides may wobble
        X = lattice.position
        arrays = {"position_velocity": np.concatenate([X - grid.corner, body.initial_velocity(X)], axis=1),
                  "deformation_gradient": np.tile([1.0, 0.0, 0.0, 1.0], (P, 1)), "mass": body.density * lattice.volume,
                  "volumetric": zeros(P), "edges": lattice.edges, "weights": allocate_weights(body.method, P),
                  "first_node": zeros(P, kind=np.int32), "acceleration": zeros(P, 2),
                  "node_sums": zeros(grid.row**2, 8), "node_motion": zeros(grid.row**2, 4),
                  "totals": zeros(phases.TOTALS), "verdict": zeros(3, kind=np.int32), "node_hold": grid.hold,
                  "mirrors": np.append(grid.mirrors.ravel(), np.int32(0)),  # never empty
                  "bounds": np.append(low - body.spacing, high + body.spacing),
                  "left_out": np.full(1, HALF_KICK if half_start else 0.0), "particle_force": zeros(P, 2),
                  "force_series": zeros(P * K, 2), "force_weights": zeros(K), "force_numbers": zeros(2)}
        self.state = BodyState(
            particles=P, row=grid.row, active=grid.row, columns=grid.columns, lines=grid.lines,
            mirror_count=len(grid.mirrors), slabs=1, spacing=body.spacing, cells_per_length=1 / body.spacing,
            origin=0.0, dt=self._interval / self.steps, lame_modulus=body.material.bulk, shear_modulus=body.material.mu,
            density=body.density, half_width=0.5 / body.ppc, force_terms=K,
            **{name: aligned_copy(one) for name, one in arrays.items()})
        on = KernelOptions(body.method, False, "typed", "grid", ("acceleration",), (), (), "", NEO_HOOKEAN)
        self.velocity_lead = 0.5 * self.state.dt if half_start else 0.0
        self._advance = Launch(take_steps, State(**self.state.members()), on)

    @property
    def time(self) -> float:
        return self._samples * self._interval

    @property
    def verdict(self) -> tuple[int, int, int]:
        """Kind of failure (0 for none), its step and its particle: see ``solvers.solver.base``."""
        kind, step, particle = (int(one) for one in self.state.verdict)
        return kind, step, particle

    @property
    def displacement(self) -> np.ndarray:
        """Displacement (P, 2) in m."""
        return self.state.position_velocity[:, :2] + self.corner - self.lattice.position

    @property
    def velocity(self) -> np.ndarray:
        """Velocity (P, 2) in m/s at the time of the sample."""
        return self.state.position_velocity[:, 2:] + self.velocity_lead * self.state.acceleration

    @property
    def step(self) -> int:
        """Number of steps up to the last sample."""
        return self._samples * self.steps

    def advance(self, interval: int = NEVER, follow: Callable[[int], None] = lambda step: None) -> None:
        """Advances to the next sample, unless a check stops the run (:attr:`verdict`); after every ``interval`` steps
        of the run ``follow`` is called with their number."""
        set_force(self.state, self._body, self.lattice.position, self.time, self.time + self._interval)
        first, end = self.step, self.step + self.steps
        while first < end and self.verdict[0] == SOUND:
            count = min(end - first, interval - first % interval)
            self._advance(first, count)
            first += count
            if first % interval == 0:
                follow(first)
        self._samples += 1
