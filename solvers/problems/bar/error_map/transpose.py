"""A step of the bar's budget on the way back, in numpy, with the kept run (``recorded``).

The errors of all causes go on by e^{n+1} = M' e^n + tau^n (see ``push``). What a number of the end, <z^{n+1}, e^{n+1}>,
owes to this step is <z^{n+1}, tau^n>; what it owes to those before, <z^n, e^n> with z^n = M'^T z^{n+1}.
"""

from __future__ import annotations

import numpy as np

from solvers.problems.bar import exact
from solvers.problems.bar.error_map.recorded import Recorded, RecordedStep
from solvers.problems.bar.method.nodes import DEGENERATE, EMPTY, MOST_HALF_WIDTH
from solvers.problems.bar.scene import BarScene
from solvers.problems.bar.step_bound import corner_functions
from solvers.scene.causes import CAUSES
from solvers.scene.remedies import PIECES

CROSSINGS, COARSE_GRID, BODY_FORCE, TIME_STEP = range(len(CAUSES))


class Back:
    """One step of a run on the way back: its linear map, transposed, and what its causes have added."""

    def __init__(self, run: Recorded, step: RecordedStep):
        self.scene, self.step, self.body = run.scene, step, run.numbers
        self.cells = run.scene.cells
        self.pieces, self.frozen = PIECES in run.scene.remedies, run.scene.frozen
        self.per_weight = np.where(step.weight > EMPTY, 1 / np.maximum(step.weight, EMPTY), 0.0)
        self.per_mass = self.per_weight / (run.numbers.density * run.numbers.volume)
        seen = run.numbers.X if self.frozen else step.position
        self.corners, first, self.functions = corner_functions(run.scene.method, self.cells, seen)
        self.corner_nodes = (first[:, None] + np.arange(3)) % self.cells
        self.lengths = np.diff(self.corners)
        self._reference()

    def _reference(self) -> None:
        """The exact solution in this step, of F since the start, at particles and on the nodes."""
        scene, b, t = self.scene, self.body, self.step.t
        X, dt = b.X, b.dt
        u, v, a = (f(scene, X, t) for f in (exact.displacement, exact.velocity, exact.acceleration))
        rate, bend = _slopes(scene, X, t)
        self.F0 = exact.deformation_gradient(scene, X, t) * b.unstretched
        self.a0, self.fast, self.slope0 = a, v + dt * a, rate + dt * bend
        self.missed = np.stack([dt * self.fast - (exact.displacement(scene, X, t + dt) - u),
                                dt * a - (exact.velocity(scene, X, t + dt) - v),
                                dt * self.slope0 - (exact.deformation_gradient(scene, X, t + dt) * b.unstretched
                                                    - self.F0)])
        self.fast_nodes, self.a_nodes = self.down(self.fast), self.down(a)
        seen = self.at_corners(self.fast_nodes)
        self.piece_slope = np.diff(seen) / self.lengths
        self.slope = self.piece_slope if self.pieces else self.gradient(self.fast_nodes)

    def gather(self, nodes: np.ndarray, values: np.ndarray) -> np.ndarray:
        """Sums (N,) of values (P, k) at nodes."""
        return np.bincount(nodes.ravel(), values.ravel(), self.cells)

    def down(self, values: np.ndarray) -> np.ndarray:
        """The nodes' mass-weighted mean of what particles have."""
        return self.gather(self.step.nodes, self.step.S * values[:, None]) * self.per_weight

    def up(self, values: np.ndarray) -> np.ndarray:
        """What particles see of the nodes' values."""
        return (self.step.S * values[self.step.nodes]).sum(axis=1)

    def gradient(self, values: np.ndarray) -> np.ndarray:
        """Its slope, by their own weights."""
        return (self.step.dS * values[self.step.nodes]).sum(axis=1)

    def at_corners(self, values: np.ndarray) -> np.ndarray:
        """The nodes' values at all corners (P + 1,)."""
        return (self.functions * values[self.corner_nodes]).sum(axis=1)

    def carried(self) -> tuple[np.ndarray, np.ndarray] | None:
        """The mapping by which nodes move the particles; None where they move by their own velocity."""
        if self.scene.velocity == "particle":
            return None
        if self.scene.velocity == "grid":
            return self.step.nodes, self.step.S
        reach = np.clip(self.body.half_width * self.step.F, 1e-6, MOST_HALF_WIDTH)  # the corners' hats, in cells
        ends = (self.step.position * self.cells)[:, None] + reach[:, None] * np.array([-1, 1])
        left = np.floor(ends).astype(int)
        return np.hstack([left, left + 1]) % self.cells, 0.5 * np.hstack([1 - (ends - left), ends - left])

    def pull(self, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(z^n, made): the adjoint of (e_x, e_v, e_F) before the step, from that after it (3, P), and what each cause
        has made of J here (4, P)."""
        zx, zv, zF = z
        dt, step = self.body.dt, self.step
        F = np.ones_like(zF) if self.frozen else step.F
        carried = self.carried()
        z_moved = zv + dt * zx if carried is None else zv  # of what a particle gets by dt a
        z_velocity = self._parting(dt * F * zF)
        if carried:
            z_velocity = z_velocity + self.gather(carried[0], carried[1] * (dt * zx)[:, None])
        z_nodes = self.gather(step.nodes, step.S * (dt * z_moved)[:, None]) + dt * z_velocity  # of the nodes' a
        before = np.stack([zx, zv + self.up(z_velocity * self.per_weight) + (dt * zx if carried is None else 0.0),
                           zF + (0.0 if self.frozen else dt * self.slope * zF) + self._stress(z_nodes * self.per_mass)])
        return before, self._at_nodes(z_nodes) + self._at_particles(zx, zv, zF, carried)

    def _parting(self, z: np.ndarray) -> np.ndarray:
        """The transpose of the velocity gradient."""
        if not self.pieces:
            return self.gather(self.step.nodes, self.step.dS * z[:, None])
        parted = z / self.lengths
        return self.gather(self.corner_nodes[:-1], self.functions[:-1] * (np.roll(parted, 1) - parted)[:, None])

    def _stress(self, z: np.ndarray) -> np.ndarray:
        """The transpose of a force by the error of F: F P - F0 P0 = E (F + F0 - F_rest) e_F."""
        step, b = self.step, self.body
        scaled = z * step.scale
        if self.pieces:
            return -b.modulus * np.diff(self.at_corners(scaled))
        secant = step.F + self.F0 - b.unstretched
        if self.scene.linearity_preserving:
            secant = step.F
        if self.frozen:
            secant = np.ones_like(step.F)
        return -b.modulus * (b.volume * secant * self.gradient(scaled) + self.up(scaled * step.mean))

    def _at_nodes(self, z: np.ndarray) -> np.ndarray:
        """What each cause has made by accelerations of nodes (4, P); crossings booked on whose stress it is."""
        step, b, made = self.step, self.body, np.zeros((len(CAUSES), len(self.F0)))
        force, P0 = z * self.per_mass, b.modulus * (self.F0 - b.unstretched)
        whole = -P0 * np.diff(self.at_corners(force * self._piece_scale()))
        method = whole
        if not self.pieces:
            geometry = np.ones_like(P0) if self.frozen else step.F if self.scene.linearity_preserving else self.F0
            scaled = force * step.scale
            method = -P0 * (b.volume * geometry * self.gradient(scaled) + self.up(scaled * step.mean))
        given = self.up(z * self.per_weight)
        body = exact.body_force(self.scene, b.X, step.t)
        made[CROSSINGS] = method - whole
        made[COARSE_GRID] = self.up(z * self.per_weight * self._truncation(P0, body))
        if self.scene.body_force == "node":
            nodes = self._force_at_nodes()
            made[BODY_FORCE] = self.up(z * self.per_weight * nodes) - given * body
        return made

    def _truncation(self, P0: np.ndarray, body: np.ndarray) -> np.ndarray:
        """What pieces of constant stress miss of the nodes' acceleration (N,): a small difference of large forces,
        booked where it is felt, for apart they would cancel hundredfold."""
        pieces = self.gather(self.corner_nodes[:-1], self.functions[:-1] * (P0 - np.roll(P0, 1))[:, None])
        return pieces * self._piece_scale() * self.per_mass - self.down(self.a0 - body)

    def _piece_scale(self) -> np.ndarray:
        """By what linearity preservation multiplies a force of pieces (N,)."""
        if not self.scene.linearity_preserving:
            return np.ones(self.cells)
        x, volume = self.step.position, self.step.volume
        length = self.gather(self.corner_nodes[:-1],
                             self.functions[:-1] * (x - np.concatenate([x[-1:] - 1, x[:-1]]))[:, None])
        whole = (length > DEGENERATE * volume) & (volume > DEGENERATE * self.scene.spacing)
        return np.where(whole, volume / np.where(whole, length, 1.0), 1.0)

    def _force_at_nodes(self) -> np.ndarray:
        """The body force that the method has at nodes (N,)."""
        scene = self.scene
        places = np.arange(self.cells) * scene.spacing
        return 3 * scene.angular_frequency**2 * scene.amplitude * np.sin(exact.WAVENUMBER * places) \
            * np.sin(scene.angular_frequency * self.step.t)

    def _at_particles(self, zx: np.ndarray, zv: np.ndarray, zF: np.ndarray,
                      carried: tuple[np.ndarray, np.ndarray] | None) -> np.ndarray:
        """What each cause has given to the particles themselves (4, P)."""
        dt, made = self.body.dt, np.zeros((len(CAUSES), len(zx)))
        F0 = np.ones_like(zF) if self.frozen else self.F0
        back = dt * (self.up(self.a_nodes) - self.a0)
        moved = dt * back if carried is None else dt * (
            (carried[1] * self.fast_nodes[carried[0]]).sum(axis=1) - self.fast)
        made[CROSSINGS] = zF * dt * F0 * (self.slope - self.piece_slope)
        made[COARSE_GRID] = zx * moved + zv * back + zF * dt * (F0 * self.piece_slope - self.slope0)
        made[TIME_STEP] = zx * self.missed[0] + zv * self.missed[1] + zF * self.missed[2]
        return made


def _slopes(scene: BarScene, X: np.ndarray, t: float) -> tuple[np.ndarray, np.ndarray]:
    """dv/dX and da/dX of the exact solution."""
    if scene.is_patch:
        return np.zeros_like(X), np.zeros_like(X)
    w = scene.angular_frequency
    slope = exact.WAVENUMBER * scene.motion_amplitude * np.cos(exact.WAVENUMBER * X)
    return w * slope * np.cos(w * t), -w * w * slope * np.sin(w * t)
