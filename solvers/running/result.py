"""Result of a run, and its JSON object, which the command line prints."""

import functools
import math
import os
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass, field
from importlib.metadata import entry_points
from typing import Any

import numpy as np

from solvers.running import result_file
from solvers.running.cures import Cure, advice_sentence
from solvers.scene.effects import ALL
from solvers.scene.estimator_registry import ESTIMATORS
from solvers.scene.scene import Scene
from solvers.scene.validation import SceneError
from solvers.solver import budget_shares, error_series, verdict_basis
from solvers.solver.error_series import IGNORE_OVERFLOW, finite_or_none, largest_finite_or_none, summary
from solvers.solver.particle_snapshot import Snapshot, WallTimes
from solvers.solver.rounding import largest_rounding_error
from solvers.solver.rounding import rounding_sentence as nothing_but
from solvers.solver.samples import QUANTITIES
from solvers.solver.soundness import evidence
from solvers.solver.verdict_basis import is_balance_motion_known, large_errors, missing_checks_sentence
from solvers.translatable_message import Message

SCHEMA = "mpm-lab/run/1"
VIEW_ENTRY_POINTS = "mpm_lab.result"  # where the installed package registers ``app``'s picture and table of a run
ACCURATE = 0.1  # of the motion's amplitude: up to such an error of x a run counts as accurate


class ByQuantity(dict[str, Any]):
    """Values by the key of a quantity, "x", "v", "sigma" or "a"; raises :class:`SceneError` for any other."""

    def __missing__(self, name: object) -> Any:
        raise SceneError("quantity", name, f"is none of this run's; give one of {', '.join(self)}")


class ByEstimator(dict[str, Any]):
    """Values by quantity for a run's only estimator; for several, a mapping from estimator to that.

    The estimator's name is always valid: ``index["companion"]["x"]`` is ``index["x"]`` where the companion is alone.
    Raises :class:`SceneError` for other names. ``nothing`` are the values, by quantity, without an estimator."""

    def __init__(self, values: Mapping[str, dict], nothing: dict):
        self.estimators = tuple(values)
        super().__init__(values if len(values) > 1 else next(iter(values.values()), nothing))

    def __missing__(self, name: object) -> dict:
        if (name,) == self.estimators:
            return dict(self)
        run = ", ".join(self.estimators) or "none"
        if len(self.estimators) > 1:
            raise SceneError("estimator", name, f"is none of this run's; give one of {run}, and then the quantity")
        raise SceneError("estimator", name, f"is not this run's, which has {run}; give that or one of "
                                            f"{', '.join(self)}")


@dataclass(frozen=True)
class Result:
    """A finished run. ``series`` holds the sampled norms over time (see ``solvers.solver.samples``); derived numbers
    have the same names and values here as in the JSON object (:meth:`to_dict`)."""

    scene: Scene
    status: str  # "ok", "unstable" or "lost" (``solvers.solver.soundness``)
    #: Why it is not ok, or which quantities are as wrong as they are large though positions hold; without advice.
    explanation: str | None
    broken_at: float | None  # time in s at which the run was found lost or unstable
    time: float  # reached, s
    steps: int
    series: dict[str, np.ndarray]
    final: Snapshot
    mid_run: Snapshot | None  # on the way, where the end has little to see (``solvers.running.run.picture_step``)
    bytes: int  # of memory, all arrays of the solver together
    not_valid: dict[str, str]  # estimators that do not hold here, each with the reason in a sentence
    seconds: WallTimes
    arch: str  # Taichi's name of the processor or GPU, "x64", "cuda"
    threads: int
    plan: str  # how the step was spread: "serial" or "parallel"
    #: Quantities of interest at the end, by name (:func:`solvers.running.quantities_of_interest.evaluate_goal`).
    goals: dict[str, dict] = field(default_factory=dict)
    #: What may help a broken run; ``solvers.running.cure_trials.try_cures`` tries it.
    advice: tuple[Cure, ...] = ()

    def __repr__(self) -> str:
        largest = self.error["x"]["max"]
        error = "" if largest is None else f"; largest RMS error of x {largest:.3g} m"
        run = f"{self.scene.problem}, {self.scene.method} with {self.scene.cells} cells"
        return f"<Result of the {run}: {self.status} after {self.steps:,} steps, at t = {self.time:.6g} s{error}>"

    def arrays(self) -> dict[str, np.ndarray]:
        """Returns all of the result as arrays and lines of text by name (``solvers.running.result_file``)."""
        return result_file.result_arrays(vars(self))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the result to a .npz, which ``mpm-lab judge`` can read as particles. Raises :class:`FileError` for a
        name that does not end in .npz, and a run of more than 500 MB."""
        result_file.write(os.fspath(path), vars(self))

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> "Result":
        """Returns the result that :meth:`save`, or ``mpm-lab run --particles FILE.npz``, has written, bit for bit.
        Raises :class:`FileError`, one sentence with the reason, where there is none, or an invalid one."""
        return cls(**result_file.read(os.fspath(path)))

    def plot(self) -> Any:
        """Returns the picture of ``mpm-lab run --plot`` as a matplotlib figure, which a notebook shows: errors over
        time, true and estimated, and the particles by both. ``result.plot().savefig("run.png")`` writes it. Raises
        :class:`RuntimeError` where mpm-lab is not installed, so that no viewer is registered, and
        :class:`ImportError` where another package called ``app`` is imported instead."""
        if (draw := load_view_function("plot")) is None:
            raise RuntimeError("nothing that is installed draws a result; install mpm-lab, with `pip install .`")
        return draw(self)

    def _repr_html_(self) -> str | None:
        """Returns the table that a notebook shows below a cell; None where no installed package makes one."""
        with suppress(ImportError):
            if (table := load_view_function("table")) is not None:
                return table(self)
        return None

    @property
    def reason(self) -> str | None:
        """The explanation, with what helps or may help; None for a run in which nothing is wrong."""
        if self.explanation is None or not self.advice:
            return self.explanation
        return Message("{explanation}; {advice}", self.explanation, advice_sentence(self.advice))

    @property
    def picture_snapshot(self) -> Snapshot:
        """Particles at the time that a picture shows: ``mid_run`` if stored, else ``final``."""
        return self.mid_run or self.final

    @property
    def particles(self) -> int:
        return len(self.final.position)

    @property
    def rate(self) -> float:
        """Speed of the run in million particle-steps per second."""
        return 1e-6 * self.particles * self.steps / self.seconds.run if self.seconds.run > 0 else math.nan

    @property
    def effects(self) -> list[str]:
        """Names of all effects and options that were active beyond the bare method: "truth", "body_force"."""
        scene = self.scene
        extra = {"body_force": scene.body_force != "none", "linearity_preserving": scene.linearity_preserving}
        return [*scene.active_effects] + [name for name, on in extra.items() if on]

    @property
    def error(self) -> ByQuantity:
        """True errors over the run: ``error["x"]["max"]`` and so on, RMS over particles of x (m), v (m/s), sigma (Pa),
        a (m/s^2) and the problem's own norm, as in :func:`solvers.solver.error_series.summary`; None without truth."""
        extra = {self.scene.EXTRA_ERROR: summary(self.series["error_extra"])}
        return ByQuantity({q: summary(self.series[f"error_{q}"]) for q in QUANTITIES} | extra)

    @property
    def estimate(self) -> ByEstimator:
        """Estimated errors, as :attr:`error` but without the problem's own norm: ``estimate["x"]["max"]``, with several
        estimators ``estimate["companion"]["x"]["max"]``; None where one does not hold here."""
        return self._by_estimator(self._estimated, summary(np.array([])))

    @property
    def index(self) -> ByEstimator:
        """Effectivity index (eq 35) of each quantity, estimated over true error, 1 is perfect: ``index["x"]``, with
        several estimators ``index["companion"]["x"]``."""
        return self._by_estimator(functools.partial(self._ratio, "index"), None)

    @property
    def distance(self) -> ByEstimator:
        """RMS distance of the estimate from the true error, over the size of that, by quantity: 0 is perfect."""
        return self._by_estimator(functools.partial(self._ratio, "distance"), None)

    @property
    def refused(self) -> dict[str, dict[str, dict]]:
        """What estimators that found themselves not valid in the run would have said, and how far off that is:
        ``refused["transport"]["index"]["x"]``, likewise "estimate" and "distance"."""
        return {name: {"estimate": self._estimated(name), "index": self._ratio("index", name),
                       "distance": self._ratio("distance", name)}
                for name in self._asked_estimators if name in self.not_valid and name in self.scene.active_estimators}

    @property
    def corrected(self) -> dict[str, dict[str, dict]]:
        """Errors, as :attr:`error`, that are left of the particles' x, v, sigma and a when the estimate is subtracted,
        by estimator whose size is reliable: ``corrected["recovered"]["x"]["max"]``; None where one does not hold here.
        Of "companion" the result is the companion's own: no MPM is left in it."""
        nothing = summary(np.array([]))
        return {name: {q: nothing if name in self.not_valid else summary(self.series[f"{name}/difference_{q}"])
                       for q in QUANTITIES} for name in self._asked_estimators if ESTIMATORS[name].judges}

    def _estimated(self, estimator: str) -> dict[str, dict[str, float | None]]:
        return {q: summary(self.series[f"{estimator}/estimate_{q}"]) for q in QUANTITIES}

    def _ratio(self, ratio: str, estimator: str) -> dict[str, float | None]:
        norm = f"{estimator}/{error_series.RATIOS[ratio]}"
        return {q: error_series.error_index(self.series[f"{norm}_{q}"], self.series[f"error_{q}"],
                                           largest_rounding_error(self.scene, q, self.steps)) for q in QUANTITIES}

    def _by_estimator(self, what: Callable[[str], dict], missing: object) -> ByEstimator:
        """Returns ``what(name)``, values by quantity, for each requested estimator; ``missing`` if it does not hold."""
        nothing = dict.fromkeys(QUANTITIES, missing)
        return ByEstimator({name: nothing if name in self.not_valid else what(name) for name in self._asked_estimators},
                           nothing)

    @property
    def _asked_estimators(self) -> tuple[str, ...]:
        return self.scene.estimators if "estimate" in self.scene.effects else ()

    @property
    def rounding(self) -> dict[str, str]:
        """Sentences, by quantity, why one has no index: its true error is only rounding."""
        limits = {q: float(largest_rounding_error(self.scene, q, self.steps)) for q in QUANTITIES}
        return {q: nothing_but(limit) for q, limit in limits.items()
                if error_series.is_only_rounding(self.series[f"error_{q}"], limit)}

    def effect_numbers(self, effect: str) -> Any:
        """Returns the numbers of an effect of ``solvers.scene.effects``, by name, as in JSON; None where it is off."""
        return ALL[effect].json_value(self.series) if self.scene.has(effect) else None

    def __getattr__(self, name: str) -> Any:
        """Returns the numbers of an effect without a property of its own, by its key in the JSON object."""
        for effect in ALL.values():
            if effect.numbers and effect.json_key == name:
                return self.effect_numbers(effect.name)
        raise AttributeError(f"a result has no {name}")

    @property
    def energy(self) -> dict | None:
        """Kinetic plus strain energy E in J (``initial``, ``final``) and its ``drift`` (E - W - E0)/E0, W the work of
        the body force; None where the effect is off."""
        return self.effect_numbers("energy")

    @property
    def angular_momentum(self) -> dict | None:
        """Angular momentum in N m s ("initial", "final"); its gain beyond the torque of the body force ("drift") and
        beyond the exact solution ("error"), over the initial value. None where the effect is off."""
        return self.effect_numbers("spin")

    @property
    def budget(self) -> dict | None:
        """Share of each cause in the error (:func:`solvers.solver.budget_shares.summary`); None where not computed."""
        reference: str = getattr(self.scene, "budget_reference", "exact")  # where a problem leaves no choice
        return budget_shares.summary(self.series, reference) if "budget/error_x" in self.series else None

    @property
    @IGNORE_OVERFLOW
    def life(self) -> dict[str, float | None]:
        """Periods until the true error of x first exceeded a tenth of the motion's amplitude ("accurate"), by straight
        lines between samples, and until the run was found lost or unstable ("sound"), None where neither happened or
        the truth is unknown; and the largest error of x within the first period, in amplitudes ("first_period").

        The error swings, and a peak between two samples goes unseen: "accurate" is known to a part of a period."""
        excess = self.series["error_x"] - ACCURATE * self.scene.motion_amplitude
        beyond = np.flatnonzero(excess > 0)[:1]
        around = slice(max(0, beyond[0] - 1), beyond[0] + 1) if len(beyond) else slice(0)
        times = {"accurate": np.interp(0.0, excess[around], self.series["time"][around]) if len(beyond) else None,
                 "sound": self.broken_at}
        first = self.series["error_x"][self.series["time"] <= 1.001 * self.scene.period].max()
        return {name: None if time is None else float(time) / self.scene.period for name, time in times.items()} \
            | {"first_period": finite_or_none(first / self.scene.motion_amplitude)}

    @property
    def step(self) -> dict[str, float | None]:
        """Time step ``dt`` in s, its stability ``bound`` for the coming motion in s, and the largest ``margin``, the
        step over the critical step during the run."""
        return {"dt": self.scene.time_step, "bound": self.scene.step_bound,
                "margin": largest_finite_or_none(self.series["margin"])}

    @property
    def verdict(self) -> dict:
        """Basis of status and reason: what each quantity was ``checked`` against, a sentence on what was
        ``not_checked`` or None, and quantities whose error was ``as_large_as_itself`` (``solver.verdict_basis``)."""
        held = verdict_basis.checks_by_quantity(self.scene, self.not_valid,
                                                is_balance_motion_known(self.scene, self.series))
        large = large_errors(self.scene, self.series, self.not_valid)
        return {"checked": held, "not_checked": missing_checks_sentence(self.scene, held),
                "as_large_as_itself": {q: {**asdict(one), "size": finite_or_none(one.size)} for q,
                                       one in large.items()}}

    @property
    def grid_crossings(self) -> int | None:
        """Number of times that a particle entered another cell; None where the effect is off."""
        return self.effect_numbers("crossings")

    @property
    def soundness(self) -> dict:
        """Largest contradictions found, over the amplitude (:func:`solvers.solver.soundness.evidence`)."""
        return evidence(self.scene, self.series)

    def to_dict(self) -> dict:
        """Returns the object of ``mpm-lab run --json``: results of effects that were off are None."""
        return {"schema": SCHEMA, "scene": self.scene.to_dict(), "status": self.status, "reason": self.reason,
                "advice": [asdict(cure) for cure in self.advice], **self.verdict,
                "t": self.time, "steps": self.steps, "particles": self.particles, "error": self.error,
                "estimate": self.estimate, "index": self.index, "rounding": self.rounding, "distance": self.distance,
                "corrected": self.corrected, "refused": self.refused, "goals": self.goals,
                **{effect.json_key: self.effect_numbers(name) for name, effect in ALL.items() if effect.numbers},
                "budget": self.budget, "soundness": self.soundness, "step": self.step, "life": self.life,
                "effects": self.effects, "bytes": self.bytes, "not_valid": self.not_valid,
                "seconds": {"setup": self.seconds.setup, "compile": self.seconds.compile, "run": self.seconds.run,
                            "estimate": self.seconds.estimate, "estimators": self.seconds.estimators},
                "rate": finite_or_none(self.rate), "arch": self.arch, "threads": self.threads, "plan": self.plan}


def load_view_function(name: str) -> Callable[[Any], Any] | None:
    """Returns the function that shows a :class:`Result` as a "plot" (a figure) or "table" (HTML), as solvers draw
    nothing themselves: the entry point ``name`` of an installed package, or None, as in a copied tree."""
    return next((entry.load() for entry in entry_points(group=VIEW_ENTRY_POINTS, name=name)), None)
