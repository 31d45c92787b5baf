"""PlanarSolver: solver of one plane body, which steps and samples it."""

import functools
from typing import Any, ClassVar

import numpy as np

from solvers.kernels import runtime
from solvers.motion.separable_field import SeparableField
from solvers.problems.planar import particle_step_breakdown
from solvers.problems.planar.estimators import circular_companion, companion, recovered, transport, two_grid
from solvers.problems.planar.estimators.recovered_operators import BOX, LatticeKernelOptions
from solvers.problems.planar.method.body import InstrumentedBody, initial_body, initial_instruments
from solvers.problems.planar.method.diagnostic_kernels import make_diagnostic_functions
from solvers.problems.planar.method.problem_step_functions import make_problem_step_functions
from solvers.problems.planar.plans.cpu_plan import CpuKernels, CpuStepper, make_cpu_kernels
from solvers.problems.planar.plans.gpu_plan import CompanionOnCpu, GpuStepper
from solvers.problems.planar.problem_kernel_functions import PlanarKernelFunctions
from solvers.problems.planar.scene import PlanarScene, motion_table
from solvers.problems.planar.snapshot_errors import Errors, cauchy_stress_of, true_errors
from solvers.scene import estimator_registry
from solvers.scene.scene import MOST_PARTICLES
from solvers.scene.validation import SceneError
from solvers.solver import gpu_detection
from solvers.solver.base import REPORT, Solver
from solvers.solver.particle_snapshot import TRUTH, ParticleFields, ParticleValues, Snapshot
from solvers.solver.samples import column_index
from solvers.translatable_message import Message

PARALLEL_FROM = 300_000  # particles from which on two threads beat one: a parallel step has a launch to pay for


class PlanarSolver(Solver):
    """Solver of a plane scene, with the arrays of its body. It has three plans: one serial kernel for many steps,
    parallel slabs, or, on a GPU, all particles at once. :func:`make_solver_class` makes the class of a problem."""

    PARTS: ClassVar[PlanarKernelFunctions]
    KERNELS: ClassVar[CpuKernels]
    STEP_BREAKDOWN = particle_step_breakdown
    scene: Any
    _arrays: InstrumentedBody

    def __init__(self, scene: Any):
        super().__init__(scene)
        self.plan = self._plan_of(scene)
        self.threads = scene.threads if self.plan == "parallel" else 1
        self._start(scene)

    def _plan_of(self, scene: Any) -> str:
        if gpu_detection.resolve_arch(scene.arch) != gpu_detection.CPU:
            return "gpu"
        if scene.particles > MOST_PARTICLES:
            raise SceneError("arch", scene.arch, "no GPU was found for these {particles:,} particles; at most {most:,} "
                             "are allowed on a processor", scene.particles, MOST_PARTICLES)
        large = scene.threads > 1 and scene.particles >= PARALLEL_FROM
        return ("parallel" if large else "serial") if scene.plan == "auto" else scene.plan

    def _start(self, scene: Any) -> None:
        self.arch = runtime.start(gpu_detection.resolve_arch(scene.arch), self.threads)
        vars(self).pop("_motion_table", None)  # of the previous scene
        super()._start(scene)

    def _initial_state(self, scene: Any) -> dict[str, Any]:
        on, hooks = self._switches, self.PARTS.hooks
        own = initial_body(scene, on, self.threads)  # with a slab of particles for each thread
        return {**own, **initial_instruments(scene, on, own["particles"], scene.farthest, hooks)}

    def _make_stepper(self) -> CpuStepper | GpuStepper:
        its, scene, on = self.KERNELS, self.scene, self._switches
        if self.plan != "gpu":
            return CpuStepper(its, scene, self._arrays, self._buffers.arrays, on, self.plan == "parallel", self.threads)
        makers = [make for name in on.estimators if (make := self.HOOKS[name].standalone)]
        beside = CompanionOnCpu(makers[0](scene), self._estimator_arrays, scene.time_step) if makers else None
        return GpuStepper(its.gpu_kernels, its.state, scene, self._arrays, on, beside)

    def snapshot(self, differences: bool = False, plotted: str | None = None) -> Snapshot:
        a, on = self._arrays, self._switches
        self._stepping.inspect_state(self.step, REPORT)
        self._stepping.fetch()
        F = a.deformation_gradient.reshape(-1, 2, 2)
        true = true_errors(self.scene, a, self.step) if on.truth else None
        estimates = {name: estimated_errors(a, k) for k, name in enumerate(on.estimators)}
        missed = {name: distances(fields, true) for name, fields in estimates.items()} if true and differences else {}
        return Snapshot(step=self.step, time=self.time, material_position=a.material_position.copy(),
                        position=a.position_velocity[:, :2].copy(), velocity=a.position_velocity[:, 2:].copy(),
                        deformation_gradient=F.copy(), error=error_sizes(true) if true else None,
                        estimate={name: error_sizes(fields) for name, fields in estimates.items()},
                        last_crossing=a.last_crossing.copy() if on.crossings else None, difference=missed)

    def fields(self) -> ParticleFields:
        a, on = self._arrays, self._switches
        self._stepping.inspect_state(self.step, REPORT)
        self._stepping.fetch()
        said = {TRUTH: true_errors(self.scene, a, self.step)} if on.truth else {}
        said |= {name: estimated_errors(a, k) for k, name in enumerate(on.estimators)}
        motion, X = a.position_velocity, a.material_position
        with np.errstate(all="ignore"):  # for unstable runs
            stress = cauchy_stress_of(self.scene, a)
        return ParticleFields(X.copy(), a.mass.copy(), a.mass / self.scene.density,
                              error_columns([(motion[:, 0] - X[:, 0], motion[:, 1] - X[:, 1]), tuple(motion.T[2:]),
                                             stress]),
                              {name: error_columns(parts[:3]) for name, parts in said.items()})

    def advance(self, steps: int, margins: bool = True) -> np.ndarray:
        return self._with_exact_angular_momentum(super().advance(steps, margins))

    def measure(self) -> np.ndarray:
        return self._with_exact_angular_momentum(super().measure())

    @functools.cached_property
    def _motion_table(self) -> SeparableField:
        """Function of time of the exact u and Grad u at the orbits' points: in each solver, as a cache may lose it."""
        return motion_table(self.scene)

    def _with_exact_angular_momentum(self, rows: np.ndarray) -> np.ndarray:
        """Writes the particles' exact angular momentum into samples ``rows``, if requested, and returns these: that of
        half a step before, to which velocities belong."""
        scene, a = self.scene, self._arrays
        if scene.has("spin") and self._switches.truth:
            mass = np.bincount(a.orbit, a.mass)
            for row in rows:
                t = (row[column_index("step")] - 0.5) * scene.time_step
                (x, y), (v_x, v_y) = (a.orbit_point + self._motion_table(t)[:, :2]).T, self._motion_table(t, 1)[:, :2].T
                row[column_index("spin/exact_momentum", self._switches)] = mass @ (x * v_y - y * v_x)
        return rows

    def _escape_sentence(self) -> str:
        return Message(self.scene.ESCAPE_SENTENCE, farthest=self.scene.farthest)


def estimated_errors(a: InstrumentedBody, estimator: int) -> Errors:
    """Returns the errors of x, v, sigma and a, in SI units, that estimator number ``estimator`` left in ``a``."""
    part = slice(estimator * len(a.position_velocity), (estimator + 1) * len(a.position_velocity))
    motion = a.estimate[part].T
    return [(motion[0], motion[1]), (motion[2], motion[3]), tuple(a.estimate_stress[part].T[:3]),
            tuple(a.estimate_acceleration[part].T)]


def error_columns(parts: Errors) -> ParticleValues:
    """Returns the known ones of the errors of x, v and sigma as arrays with a column per component."""
    return ParticleValues(*(np.stack(one, axis=1) for one in parts if one is not None))


def error_sizes(errors: Errors) -> np.ndarray:
    """Returns sizes (P, 4) of the errors of x, v, sigma and a: lengths or Frobenius norms; 0 where an error is None."""
    out = np.zeros((next(len(parts[0]) for parts in errors if parts), len(errors)))
    with np.errstate(over="ignore", invalid="ignore"):
        for column, parts in enumerate(errors):
            if parts is not None:  # numpy's norm along so short an axis takes four times as long
                first, last = parts[0], parts[-1]
                square = first * first + last * last
                out[:, column] = np.sqrt(square if len(parts) == 2 else square + 2 * parts[1] * parts[1])
    return out


def distances(one: Errors, other: Errors) -> np.ndarray:
    """Returns sizes (P, 4) of ``one`` minus ``other``, errors of x, v, sigma and a; 0 where either is None."""
    with np.errstate(over="ignore", invalid="ignore"):
        return error_sizes([mine if mine is None or theirs is None else
                            tuple(a - b for a, b in zip(mine, theirs, strict=True))
                            for mine, theirs in zip(one, other, strict=True)])


@functools.cache
def make_solver_class(kind: type[PlanarScene]) -> type[PlanarSolver]:
    """Returns the solver class of the problem with the scene class ``kind``, made once."""
    traits = make_problem_step_functions(kind)
    box = kind.layout == "box"
    made = {"companion": lambda: circular_companion.HOOKS if kind.CIRCULAR else companion.HOOKS,
            "recovered": lambda: recovered.hooks(BOX if box else LatticeKernelOptions(closed=not kind.PLANES[0])),
            "transport": lambda: transport.hooks(traits),
            "two-grid": lambda: two_grid.hooks(traits, two_grid.BOX if box else two_grid.POLAR)}
    hooks = estimator_registry.hooks_of(kind.problem, {name: made[name]() for name in kind.ESTIMATORS})
    parts = PlanarKernelFunctions(hooks, traits, make_diagnostic_functions(kind, traits.first))
    its = make_cpu_kernels(parts)
    return type("PlanarSolver", (PlanarSolver,), {
        "HOOKS": hooks, "PARTS": parts, "KERNELS": its, "PHASES": its.phases, "STATE": InstrumentedBody})
