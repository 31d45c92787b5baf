"""Family of runs that differ only in their number of cells: their errors and costs.

Errors are those of the companion estimator, not the truth, so that the search also works for problems without a known
solution. They are interpolated between the measured numbers of cells, and extrapolated to finer grids by the order of
the two finest; costs by steps, particles and the rate of the finest.
"""

import math
from bisect import bisect_right, insort
from dataclasses import dataclass, field, replace
from functools import lru_cache

from solvers.scene.scene import Scene
from solvers.scene.validation import SceneError
from solvers.solver.soundness import OK

#: By which the advisor goes. It compares methods and steps, so it needs one that sees every error of the particles
#: whatever they are: "transport" misses that of the step, "two-grid" needs second order, "recovered" a polar lattice.
ESTIMATOR = "companion"
HIGHEST_ORDER = 2.0  # for extrapolation; the methods are of second order at best
HOPED_ORDER = 2.5  # of a family of which one member is known: coarse grids may gain more than the order
LEAST_ORDER = 0.3  # below which refining is not worth its price: the error has all but stopped falling
GENTLE_CFL = 0.1
TIMED_SECONDS = 0.002
TIMED_TURNS = 4


@dataclass(frozen=True, order=True)
class RefinementPoint:
    """Measured run of a family: cells, the largest RMS ``error`` over the run (infinite for an unstable one), the CPU
    seconds per particle-step of a bare run, NaN until measured; how the run ended, and why not well."""

    cells: int
    error: float
    seconds_per_particle_step: float
    status: str = field(default=OK, compare=False)
    reason: str | None = field(default=None, compare=False)


@dataclass
class RefinementFamily:
    """Runs of ``scene`` on multiples of ``multiple`` cells and measured ``points``; ``quantity``: x, v, sigma or a.

    With an estimator's name as ``corrected`` its estimate is subtracted from each result; the error is then the true
    one of what is left, and the time that of run and estimator."""

    scene: Scene
    quantity: str
    multiple: int
    points: list[RefinementPoint] = field(default_factory=list)
    corrected: str = ""

    def member(self, cells: int) -> Scene:
        """Returns the scene with so many cells, the estimator that it takes and only the effects that it needs."""
        truth = ("truth",) if self.corrected else ()
        return replace(self.scene, cells=cells, estimators=(self.corrected or ESTIMATOR,),
                       effects=("estimate", "acceleration", *truth))

    def measure(self, cells: int) -> RefinementPoint:
        """Runs the scene with so many cells; returns its error and time, and stores them in ``points``."""
        from solvers.running.run import run  # here: what has been measured before needs no Taichi

        result = run(self.member(cells), prices=False, mid_run=False)
        norms = result.corrected[self.corrected] if self.corrected else result.estimate[ESTIMATOR]
        largest = norms[self.quantity]["max"] if result.status == OK else None
        error = math.inf if largest is None else largest
        return self.add_and_time_point(RefinementPoint(cells, error, math.nan, result.status, result.reason))

    def compile(self, cells: int) -> None:
        """Compiles all kernels of :meth:`measure` for so many cells; stores nothing of the run."""
        from solvers.running.run import build, run

        run(self.member(cells), prices=False, mid_run=False)
        build(self._bare_scene(cells)).compile()

    def _bare_scene(self, cells: int) -> Scene:
        """Returns the timed scene: without estimators and effects, with short steps, each of which takes as long; of a
        corrected result with the estimator, which takes more of a longer step."""
        if self.corrected:
            return replace(self.member(cells), effects=("estimate",))
        return replace(self.member(cells), estimators=(), effects=(), cfl=GENTLE_CFL)

    def add_and_time_point(self, point: RefinementPoint) -> RefinementPoint:
        """Stores a measured run in ``points``, and returns it; its time is measured now if it is unknown."""
        if math.isnan(point.seconds_per_particle_step):
            rate = _seconds_per_particle_step(self._bare_scene(point.cells))
            point = replace(point, seconds_per_particle_step=rate)
        insort(self.points, point)
        return point

    def error(self, cells: float) -> float:
        """Returns the expected largest RMS error with so many cells; infinite where no sound run is known."""
        last = self.points[-1]
        if cells >= last.cells:
            return last.error * (last.cells / cells) ** self.order()
        after = next(k for k, point in enumerate(self.points) if point.cells > cells)
        if after == 0:
            return math.inf
        coarse, fine = self.points[after - 1:after + 1]
        if cells == coarse.cells or not math.isfinite(coarse.error):
            return coarse.error
        part = math.log(cells / coarse.cells) / math.log(fine.cells / coarse.cells)
        return coarse.error * (fine.error / coarse.error) ** part if fine.error > 0 else coarse.error

    def order(self) -> float:
        """Returns the order in h between the two finest runs, within plausible limits; with one run an optimistic
        order, so that no family is given up after one."""
        if not all(0 < point.error < math.inf for point in self.points[-2:]):
            return 0.0
        if len(self.points) < 2:
            return HOPED_ORDER
        coarse, fine = self.points[-2:]
        order = math.log(coarse.error / fine.error) / math.log(fine.cells / coarse.cells)
        return 0.0 if order < LEAST_ORDER else min(order, HIGHEST_ORDER)

    def cells_for(self, tolerance: float, hoped: float = 0.0) -> int | None:
        """Returns the fewest cells whose error should be at most ``tolerance``, or None; ``hoped`` is an order to
        assume where the error decreases, but more slowly."""
        met = [point.cells for point in self.points if point.error <= tolerance]
        if met:
            start = max((point.cells for point in self.points if point.cells < met[0]), default=met[0])
            candidates = range(self._round_up(start), met[0] + 1, self.multiple)
            return next((cells for cells in candidates if self.error(cells) <= tolerance), met[0])
        last, order = self.points[-1], self.order()
        if order == 0 or not math.isfinite(last.error):
            return None
        order = max(order, hoped)
        cells = last.cells * (last.error / tolerance) ** (1 / order)
        return None if cells > 1e6 else max(self._round_up(cells), last.cells + self.multiple)

    def cells_within(self, seconds: float) -> int:
        """Returns the most cells whose bare run is expected to take at most so many seconds."""
        low, high = self.points[0].cells // self.multiple, 1_000_000 // self.multiple
        more = bisect_right(range(low + 1, high + 1), seconds, key=lambda n: self.seconds(n * self.multiple))
        return (low + more) * self.multiple

    def seconds(self, cells: int) -> float:
        """Returns the expected seconds of a bare run with so many cells; infinite beyond a scene's limits."""
        nearest = max((p for p in self.points if p.cells <= cells), default=self.points[0])
        return _particle_steps(self.scene, cells) * nearest.seconds_per_particle_step

    def _round_up(self, cells: float) -> int:
        return self.multiple * math.ceil(cells / self.multiple - 1e-9)


@lru_cache(maxsize=4096)  # used with every run of a search
def _particle_steps(scene: Scene, cells: int) -> float:
    """Returns particles times steps of the scene with so many cells; infinite where that scene is invalid."""
    try:
        scene = replace(scene, cells=cells)
    except SceneError:
        return math.inf
    return scene.steps * scene.particles


@lru_cache(maxsize=4096)
def _seconds_per_particle_step(scene: Scene) -> float:
    """Returns the CPU seconds per particle-step of a scene, warmed up; infinite for an unstable run."""
    from solvers.running.repeated_step_timing import particle_step_rate
    from solvers.running.run import build

    seconds = 1e-6 / particle_step_rate(build(scene), TIMED_TURNS, TIMED_SECONDS)
    return seconds if math.isfinite(seconds) else math.inf


def forget_rates() -> None:
    """Clears the measured seconds per particle-step of all scenes, so that they are measured anew."""
    _seconds_per_particle_step.cache_clear()
