"""The companion of a body (see ``solvers.estimators.companion_solution``), on any number of patches, solved alone.

Elements and steps are those of the planar companion (``solvers.problems.planar.estimators.companion``); the forces of
points at one place are added up afterwards. Mesh, material and force are numbers and arrays: all share one compilation.
"""

import math
from dataclasses import dataclass

import numpy as np
import taichi as ti

from solvers.bodies.body import Body
from solvers.bodies.force_series import body_force_at, compute_force_weights, force_terms, set_force
from solvers.bodies.spectral_mesh import Cuts, SpectralMesh
from solvers.estimators import companion_solution as shared
from solvers.estimators.spectral_elements import STABLE, highest_frequency
from solvers.kernels import runtime
from solvers.kernels.dtypes import Integer, Integers, Octets, Pairs, Quads, Real, Reals
from solvers.kernels.launch import Launch
from solvers.motion.laws.elastic_material import NEO_HOOKEAN
from solvers.problems.planar.estimators.companion import element_forces, element_stresses
from solvers.scene.kernel_options import KernelOptions
from solvers.solver.state_arrays import Members, aligned_copy

OPTIONS = KernelOptions("", False, "", "", (), (), (), "", NEO_HOOKEAN)
SMALL_STRAIN = 1e-7  # at which frequencies are found
SUBSTEPS = 8  # of an interval of the body at rest: so often is their number chosen anew, by the stiffness then


@dataclass
class CompanionState(Members):
    """State of a companion with N points in SI units, by the names of ``solvers.estimators.companion_solution``."""

    dt: Real
    lame_modulus: Real
    shear_modulus: Real
    companion_counts: Integers
    companion_numbers: Reals
    companion_nodes: Octets
    companion_geometry: Quads
    companion_matrices: Quads
    companion_trial: Pairs
    companion_stresses: Quads
    companion_master: Integers
    force_terms: Integer
    force_series: Pairs
    force_weights: Reals
    force_numbers: Reals


@ti.func
def accelerate(body: ti.template(), t, on: ti.template()):
    """Writes the points' accelerations (m/s^2) at the trial displacement and t s to layer WORK, zero before."""
    N, n = body.companion_counts[shared.NODES], body.companion_counts[shared.ORDER] + 1
    stiffest = 1.0
    for element in range(body.companion_counts[shared.ACROSS]):
        stiffest = ti.max(stiffest, element_stresses(body, element * n * n, on))
        element_forces(body, element * n * n)
    body.companion_numbers[shared.STIFFEST] = stiffest
    compute_force_weights(body, t)
    first = shared.WORK * N
    for node in range(N):
        master = body.companion_master[node]
        if master != node:
            for c in ti.static((2, 3)):
                body.companion_nodes[first + master][c] = \
                    body.companion_nodes[first + master][c] + body.companion_nodes[first + node][c]
    for node in range(N):
        master = body.companion_master[node]
        if master == node:
            force = body_force_at(body, node)
            for c in ti.static(range(2)):
                per_mass = body.companion_nodes[first + node][6 + c]
                a = body.companion_nodes[first + node][2 + c] * per_mass + force[c]
                body.companion_nodes[first + node][2 + c] = a if per_mass > 0 else 0.0
        else:  # masters come first
            for c in ti.static((2, 3)):
                body.companion_nodes[first + node][c] = body.companion_nodes[first + master][c]


@ti.func
def has_finite_motion(body: ti.template()):
    """Returns whether all points' u and v are finite numbers."""
    N, size = body.companion_counts[shared.NODES], 0.0
    for node in range(N):
        end = body.companion_nodes[shared.END * N + node]
        size += ti.abs(end[0]) + ti.abs(end[1]) + ti.abs(end[2]) + ti.abs(end[3])
    return size < ti.math.inf


State = ti.types.argpack(**CompanionState.types())


@ti.kernel
def take_steps(first: ti.i32, count: ti.i32, state: State, on: ti.template()):
    """Takes up to ``count`` steps of the companion after the first ``first``; none any more once it is not finite."""
    ti.loop_config(serialize=True)
    for k in range(count):
        if has_finite_motion(state):
            shared.advance_companion_if_due(state, first + k + 1, accelerate, on)


class BodyCompanion:
    """Companion of a body of order p on elements with these ``cuts``, advanced from sample to sample, ``interval`` s
    apart; ``u`` (m) and ``v`` (m/s) are those of the mesh's points (N, 2), ``time`` is in s."""

    def __init__(self, body: Body, cuts: Cuts, order: int, interval: float):
        runtime.start()
        self.mesh = mesh = SpectralMesh(body, cuts, order)
        self._body, self._interval, self._samples, N, n = body, interval, 0, len(mesh.points), order + 1
        matrices = np.zeros((n * n, 4))
        matrices[:, 0] = matrices[:, 1] = mesh.derivative.ravel()
        matrices[:, 2] = mesh.weights.ravel()
        start = shared.initial_companion_arrays((order, mesh.elements, 1, n, N, 1), 1.0, 1.0,
                                                body.initial_velocity(mesh.points), mesh.inverse_mass)
        start["companion_counts"][shared.INTERVAL] = 1
        K = force_terms(body)
        arrays = {**start, "companion_geometry": mesh.geometry, "companion_matrices": matrices,
                  "companion_trial": np.zeros((n * n, 2)), "companion_stresses": np.zeros((n * n, 4)),
                  "companion_master": mesh.master.astype(np.int32), "force_series": np.zeros((N * K, 2)),
                  "force_weights": np.zeros(K), "force_numbers": np.zeros(2)}
        self._state = CompanionState(dt=interval, lame_modulus=body.material.bulk, shear_modulus=body.material.mu,
                                     force_terms=K, **{name: aligned_copy(one) for name, one in arrays.items()})
        self._layers = self._state.companion_nodes.reshape(shared.LAYERS, N, 8)
        frequency = self._frequency()
        self.steps = max(1, math.ceil(interval * frequency / (SUBSTEPS * STABLE)))  # from sample to sample
        self._state.dt, self._state.companion_numbers[shared.FREQUENCY] = interval / self.steps, frequency
        self._advance = Launch(take_steps, State(**self._state.members()), OPTIONS)

    def _frequency(self) -> float:
        """Returns the highest angular frequency at rest in 1/s."""
        gap = float(np.sqrt(np.abs(self.mesh.geometry[:, 0] * self.mesh.geometry[:, 3]
                                   - self.mesh.geometry[:, 1] * self.mesh.geometry[:, 2])).min())
        scale, end = SMALL_STRAIN * gap / (self.mesh.order + 1)**2, self._layers[shared.END]
        step = Launch(take_steps, State(**{**self._state.members(), "dt": 0.0}), OPTIONS)

        def accelerations(u: np.ndarray) -> np.ndarray:
            end[:, :2] = scale * u
            step(1, 1)  # of no length
            return end[:, 4:6] / scale

        frequency = highest_frequency(accelerations, self.mesh.inverse_mass)
        end[:, :2] = end[:, 4:6] = self._layers[shared.WORK, :, :6] = 0.0
        return frequency

    @property
    def time(self) -> float:
        return self._samples * self._interval

    @property
    def motion(self) -> np.ndarray:
        """Displacement in m and velocity in m/s (N, 4)."""
        return self._layers[shared.END, :, :4]

    @property
    def u(self) -> np.ndarray:
        return self.motion[:, :2]

    @property
    def v(self) -> np.ndarray:
        return self.motion[:, 2:]

    def advance(self) -> None:
        """Advances to the next sample; stops within it, with NaN or infinity, where the motion cannot be followed."""
        set_force(self._state, self._body, self.mesh.points, self.time, self.time + self._interval)
        self._advance(self._samples * self.steps, self.steps)
        self._samples += 1
