"""One session in an engine: a solver, a clock that sets its target time, and its frames."""

import contextlib
from dataclasses import replace
from multiprocessing.shared_memory import SharedMemory
from time import perf_counter, thread_time
from typing import Any

import numpy as np

from solvers.engine import shared_frames
from solvers.engine.engine_messages import FrameReport, SessionRequest
from solvers.engine.soundness_monitor import SoundnessMonitor
from solvers.running.quantities_of_interest import ENERGY, STRESS, QuantityOfInterest, evaluate_goal, mask_refused
from solvers.running.run import build
from solvers.scene.scene import MOST_STEPS
from solvers.solver.base import Solver
from solvers.solver.particle_step_breakdown import ParticleStepBreakdown

SLICE_SECONDS = 0.008  # one turn of one session: short, because a launch cannot be interrupted
ROUND_SECONDS = 0.05  # in which every session of a full engine should have had its turn and frame: shorter ones then
SHORTEST_SLICE = 0.0004  # some ten launches' worth
FRAME_WEIGHT = 0.1  # of the last frame in what frames cost, and in how late they go out
LATE_SHARE = 0.25  # of the time between two frames, by which they are then late
MOST_APART = 1 / 40  # of a period: partners, at speeds that are too high for one of them
SILENT_SECONDS = 0.15  # for which a new run is stepped to its first moment before frames show it on its way there
LAG_SECONDS = 0.1  # with more work than this in arrears the clock gives them up: the session is capped
SPEED_WINDOW = 1.0  # seconds over which the real speed is measured
GOAL_SECONDS = 0.5  # between two looks at numbers of the whole body, while it moves
LOOK_SECONDS = 0.002  # between two looks whether the page has taken a frame that the next one waits for
EXPECTED_RATE = 3e7  # particle-steps per second, before the first measurement
LAST_STEP = MOST_STEPS - 1_000_000_000  # a page left open for days stops here


class BlockFreed(Exception):
    """Raised if the page has freed the memory block of a request: its visitor has left, and no answer is needed."""


class SessionStepper:
    """Stepper of one session in an engine: builds the solver for the request ``wish`` and steps it towards the time of
    a clock, one time slice after another, in the engine's one thread. Raises :class:`BlockFreed` if the request's
    memory block is gone."""

    def __init__(self, wish: SessionRequest):
        self.wish = wish
        self.sessions = 1  # that share the engine and move
        self._seconds_a_frame = self._lateness = 0.0
        self.partner: SessionStepper | None = None  # synchronised with this one (``SessionRequest.partner``), or None
        self._block = _attach(wish.memory)
        shared_frames.mark_as_read(self._block)  # left by an engine that died
        try:
            self.solver = build(wish.scene)
            self._begin_run()
        except BaseException:
            self.close()
            raise

    def rebuild(self, begin_at: float | None = None) -> None:
        """Restarts the scene, and lets it begin at a time in periods (None: as requested)."""
        if begin_at is not None:
            self.wish = replace(self.wish, pace=replace(self.wish.pace, begin_at=begin_at))
        if not self.solver.restart(self.wish.scene):
            self.solver = build(self.wish.scene)
        self._begin_run()

    def _begin_run(self) -> None:
        self.solver.compile()
        self._watch = SoundnessMonitor(self.solver.scene)
        self._rows = [self.solver.measure()]  # samples since the last frame
        self._measured = 0  # the last step measured although no sample was due
        self._fresh, self._due = True, 0.0  # no frame since the build; when the next one goes out, by perf_counter
        self._goals: dict[str, dict] = {}
        self._goals_due = 0.0  # when these numbers are worked out anew, by perf_counter
        self._real_speed: float | None = None
        self._breakdown: ParticleStepBreakdown | None = None  # of the last step
        self._before_step: tuple[int, dict[str, np.ndarray]] | None = None  # where that step began
        self._kernel_seconds, self._kernel_steps = 0.0, 0
        self._seconds_a_step = self.wish.scene.particles / EXPECTED_RATE
        self._first_step = min(self.wish.pace.first_step(self.wish.scene), self._last_step)
        self._silent_until = perf_counter() + SILENT_SECONDS
        self._start_clock()

    def _start_clock(self) -> None:
        self._anchor = self._window = (perf_counter(), self.solver.time)
        self._frame_wanted = True

    def accept(self, wish: SessionRequest) -> bool:
        """Accepts a newer request of the session; rebuilds the solver for another scene or a restart, and takes single
        steps that are requested. Returns whether the solver was rebuilt. The stepper is unusable after an exception."""
        old, self.wish = self.wish, wish
        if self._block.name != wish.memory:
            self.close()
            self._block = _attach(wish.memory)
        steps, particle = wish.pace.single_steps - old.pace.single_steps, wish.frame.broken_down
        anew = old.scene != wish.scene or old.pace.restarts != wish.pace.restarts
        if anew:
            self.rebuild()
        elif steps > 0 and self.solver.sound and not wish.pace.playing:
            self._advance(min(steps, self.solver.longest_advance), particle)
            self._sample()  # who takes single steps looks at each
        elif old.pace.playing and not wish.pace.playing:
            self._sample()  # and so does who looks at one moment
        elif particle is not None and particle != old.frame.broken_down and self._before_step:
            self.solver.restore(*self._before_step)
            self._breakdown = self.solver.break_down(particle)[1]
        self._start_clock()
        return anew

    def state(self) -> dict[str, Any]:
        """Returns the state with which a stepper in another process of this machine continues (:meth:`from_state`)."""
        return {**{name: value for name, value in vars(self).items() if name not in ("solver", "partner", "_block")},
                "solver": self.solver.state()}

    @classmethod
    def from_state(cls, state: dict[str, Any], prepared: Solver | None) -> "SessionStepper":
        """Returns a stepper that continues from the ``state`` of another, to the bit; it uses the ``prepared`` solver
        if that has the same scene."""
        stepper, scene = cls.__new__(cls), state["wish"].scene
        solver = prepared if prepared and prepared.scene == scene else build(scene)
        vars(stepper).update(state, solver=solver, partner=None, _block=_attach(state["wish"].memory))
        stepper.solver.restore(*state["solver"])
        return stepper

    def close(self) -> None:
        with contextlib.suppress(BufferError):  # an exception still holds a view: it goes with that
            self._block.close()

    @property
    def is_behind(self) -> bool:
        """Whether it is time to step: a frame is due, or the run lags behind its clock by a whole time slice."""
        if self._is_silent:
            return True
        if not self.moving or (self._frame_due() and self._frame_is_unread):
            return False
        if self._is_catching_up:
            return True
        if self._frame_due():
            return self._steps_wanted() >= 1
        enough = self._slice_steps
        if self.partner is not None:  # half of what a partner that waits is ahead
            enough = max(1, min(enough, int(0.5 * self._max_lead_over_partner / self.solver.scene.time_step)))
        return self._steps_wanted() >= enough

    @property
    def frame_is_ready(self) -> bool:
        """Whether a frame can be sent: the page has read the last one, and the next is due."""
        due = self._frame_wanted or (self.moving and self._frame_due())
        return due and not self._is_silent and not self._frame_is_unread

    @property
    def next_due(self) -> float:
        """Time of the session's next action in s of ``perf_counter``: soon if the last frame is unread, inf if none."""
        if not (self.moving or self._frame_wanted):
            return float("inf")
        return max(self._due, perf_counter() + LOOK_SECONDS) if self._frame_is_unread else self._due

    def advance_slice(self) -> None:
        """Takes at least one step, and at most those of one time slice, towards the clock's time, or first to the time
        at which the run is to begin."""
        catches_up = self._is_catching_up
        wanted = self._first_step - self.solver.step if catches_up else self._steps_wanted()
        self._advance(max(1, min(wanted, self._slice_steps, self.solver.longest_advance)))
        if catches_up:
            if self.solver.step == self._first_step:
                self._sample()
                self._start_clock()
        elif wanted * self._seconds_a_step > LAG_SECONDS:
            self._anchor = (perf_counter(), self.solver.time)
        if self.wish.pace.ends and self.solver.step == self._last_step:
            self._sample()  # what a run has come to is read at its end
            self._frame_wanted = True

    def _sample(self) -> None:
        """Measures a sample of the present step, unless it has been measured or is one that the solver samples."""
        if self.solver.step != self._measured and self.solver.step % self.solver.scene.sample_interval:
            self._rows.append(self.solver.measure())
            self._measured = self.solver.step

    def write_frame(self) -> FrameReport:
        """Writes the particles into the session's memory block and returns the report of the frame, with the samples
        since the last one. Call when :attr:`frame_is_ready`."""
        now, solver, wished = perf_counter(), self.solver, self.wish.frame
        shot = solver.snapshot(wished.differences, wished.plotted)
        shared_frames.write_frame(self._block, solver.scene, shot)
        wall, simulated = self._window
        if now - wall > 0.2:
            self._real_speed = (solver.time - simulated) / (now - wall)
        if now - wall > SPEED_WINDOW:
            self._window = (now, solver.time)
        particle_steps, spent = self._kernel_steps * solver.scene.particles, self._kernel_seconds  # since the build
        rows, not_valid = np.concatenate(self._rows), self._watch.doubted_estimators(solver.time, solver.not_valid())
        self._watch.check_samples(rows, len(shot.position), self.running)
        status, reason, since = self._watch.current_status(solver, not_valid)
        report = FrameReport(
            session=self.wish.session, number=self.wish.number, memory=self._block.name, scene=solver.scene,
            fresh=self._fresh, playing=self.running, particles=len(shot.position), step=solver.step, time=solver.time,
            rows=rows, reason=reason, status=status, since=since, not_checked=self._watch.unchecked_note(not_valid),
            rate=1e-6 * particle_steps / spent if spent else 0.0, real_speed=self._real_speed,
            arch=solver.arch, not_valid=not_valid, holds=replace(wished, differences=bool(shot.difference)),
            breakdown=self._breakdown if wished.broken_down is not None else None,
            goals=mask_refused(self._goals_at(now), not_valid))
        if not self._frame_wanted:  # else it may have stood still since it was due
            self._lateness += FRAME_WEIGHT * (now - self._due - self._lateness)
        self._rows = [report.rows[:0]]
        self._fresh, self._frame_wanted = False, False
        # Counted from when this frame was due, not from when a turn had ended and it went out: else every frame is
        # late by what the last one was, and 30 a second become 24. Within limits, so that frames come evenly.
        apart = self.wish.frame_seconds
        self._due = min(max(self._due + apart, now + 0.5 * apart), now + apart)
        self._seconds_a_frame += FRAME_WEIGHT * (perf_counter() - now - self._seconds_a_frame)
        return report

    def _goals_at(self, now: float) -> dict[str, dict]:
        """Returns numbers of the whole body by goal: at the time ``now`` of ``perf_counter`` in s, or, while the run
        moves, up to half a second older."""
        if now >= self._goals_due or not self.running:
            solver, self._goals_due = self.solver, now + GOAL_SECONDS
            fields = solver.fields()
            self._goals = {name: evaluate_goal(QuantityOfInterest(name), fields, solver.scene, solver.step)
                           for name in (ENERGY, STRESS)}
        return self._goals

    @property
    def frames_are_late(self) -> bool:
        """Whether frames have recently been later than the session's request allows."""
        return self._lateness > LATE_SHARE * self.wish.frame_seconds

    @property
    def _frame_is_unread(self) -> bool:
        return shared_frames.is_unread(self._block)

    @property
    def running(self) -> bool:
        return self.wish.pace.playing and self.solver.sound and self.solver.step < self._last_step

    @property
    def moving(self) -> bool:
        """Whether steps are to be taken: it plays, or is on its way to where it begins."""
        return self.running or self._is_catching_up

    @property
    def _is_catching_up(self) -> bool:
        return self.solver.sound and self.solver.step < self._first_step

    @property
    def _is_silent(self) -> bool:
        return self._is_catching_up and perf_counter() < self._silent_until

    @property
    def _speed(self) -> float:
        """Requested speed in simulated s per s."""
        return self.wish.pace.speed * self.wish.scene.period

    @property
    def _last_step(self) -> int:
        return self.solver.scene.steps if self.wish.pace.ends else LAST_STEP

    @property
    def _slice_steps(self) -> int:
        """Number of steps in a time slice; in a full engine frames come first, and runs are slower than requested."""
        seconds = max(SHORTEST_SLICE, min(SLICE_SECONDS, ROUND_SECONDS / self.sessions - self._seconds_a_frame))
        return max(1, int(seconds / self._seconds_a_step))

    @property
    def turn_seconds(self) -> float:
        """Expected duration of one time slice, in s."""
        return self._slice_steps * self._seconds_a_step

    def _frame_due(self) -> bool:
        return perf_counter() >= self._due

    def _steps_wanted(self) -> int:
        """Returns the number of whole steps to the time of the clock. The clock waits for a partner that cannot keep
        up: lost time is not made up later, when the partner stops or leaves."""
        now, (wall, simulated) = perf_counter(), self._anchor
        target, partner = simulated + (now - wall) * self._speed, self.partner
        if partner is not None and partner.running:
            periods = partner.solver.time / partner.solver.scene.period
            bound = periods * self.solver.scene.period + self._max_lead_over_partner
            if bound < target:
                target = bound
                self._anchor = (now, bound)
        return min(int((target - self.solver.time) / self.solver.scene.time_step), self._last_step - self.solver.step)

    @property
    def _max_lead_over_partner(self) -> float:
        """Largest lead over the partner in simulated s: one frame, but invisible at high speeds; and at least two
        steps, so that the one behind can always take one."""
        scene = self.solver.scene
        return max(min(self.wish.frame_seconds * self._speed, MOST_APART * scene.period), 2 * scene.time_step)

    def _advance(self, steps: int, broken_down: int | None = None) -> None:
        """Takes so many steps, the last with a breakdown around the particle of the number ``broken_down``, if any;
        collects their samples and measures the time of a step."""
        begun, worked, self._breakdown, self._before_step = perf_counter(), thread_time(), None, None
        if broken_down is None:
            self._rows.append(self.solver.advance(steps))
        else:
            self._rows.append(self.solver.advance(steps - 1))
            if self.solver.sound:
                self._before_step = self.solver.state()
                rows, self._breakdown = self.solver.break_down(broken_down)
                self._rows.append(rows)
        took = max(perf_counter() - begun, 1e-7)
        self._seconds_a_step = took / steps
        alone = self.solver.scene.arch == "cpu" and self.solver.threads == 1  # other work on the machine does not count
        self._kernel_seconds += thread_time() - worked if alone else took
        self._kernel_steps += steps
        self._frame_wanted |= not self.solver.sound  # the last frame has the reason


def _attach(name: str) -> SharedMemory:
    try:
        return shared_frames.attach_block(name)
    except FileNotFoundError as error:
        raise BlockFreed(name) from error
