"""Session: one visitor's requests and the results. Independent of how they are shown."""

import math
import threading
from collections.abc import Callable
from dataclasses import asdict, replace
from time import monotonic
from typing import Any

from app.language.translation import tr, translate_message
from app.names_and_units import reword_for_page
from app.page.visit.engine_links import FASTEST, PageEngineLinks, scene_size_refusal
from app.page.visit.history import NormHistory
from app.page.visit.pinned_run import PinnedRun
from app.page.visit.status_message import Notice, doubt_notice, preparing_notice
from app.problems.views import VIEWS
from solvers.engine.engine_messages import FrameReport, Pace
from solvers.engine.shared_frames import FrameArrays, FrameOptions
from solvers.problems import PROBLEMS
from solvers.scene.scene import Scene
from solvers.scene.validation import SceneError
from solvers.solver.samples import QUANTITIES
from solvers.solver.soundness import OK

TO_BE_READ = 8.0  # seconds that an event is shown
CROWDED_BELOW = 0.8  # of the requested speed, below which a message names other runs as the reason


class RunSession:
    """One visitor's run: the requested ``scene`` (the latest wins), the last frame's ``report``, and the ``history``.
    ``on_frame`` receives each frame; ``speed`` is in periods per second; one that ``ends`` stops at the scene's end."""

    def __init__(self, links: PageEngineLinks, scene: Scene, on_frame: Callable[[FrameReport, FrameArrays], None],
                 speed: float | None = None, ends: bool = False):
        self._lock = threading.RLock()
        self._on_frame = on_frame
        #: The field of the last refused request ("" for none), and the reason without a full stop;
        #: None after another request.
        self.refused: tuple[str, str] | None = None
        self._error, self._engine_lost = "", False
        self._requested: dict[str, Any] = {}
        self._news, self._crowded_at = (-math.inf, ""), -math.inf  # time and text of the last event
        self.watched, self._rests, self._beyond = True, False, False
        self._number = self._compiled_for = self._run_number = 0
        self._pace, self._frame = Pace(), FrameOptions(plotted=QUANTITIES[0])
        self._start(scene, speed, ends)
        self.history = NormHistory(scene, scene.particles)
        self.report: FrameReport | None = None
        self.pinned: PinnedRun | None = None
        self.links, self.link = links, links.open(self)
        self._send_request()

    def set_scene_fields(self, **fields: object) -> None:
        """Requests values of scene fields, by name, at the instant that the stage shows; invalid ones set
        :attr:`refused`, and the present run continues."""
        with self._lock:
            wished = self._requested | fields
            try:
                scene = PROBLEMS[wished["problem"]].scene(**wished)
            except SceneError as refusal:
                self.refuse(reword_for_page(str(refusal)),
                            refusal.field if refusal.field in fields else next(iter(fields)))
                return
            if crowd := scene_size_refusal(scene):
                self.refuse(crowd, next(iter(fields)))
                return
            begin_at, self._requested, self.scene = self._instant, wished, scene
            if self.pinned:
                self.pinned.follow(scene)
            self._beyond = self._beyond and begin_at * scene.period > scene.end_time
            self._send_request(begin_at=begin_at)

    @property
    def first_instant(self) -> float:
        """The time in periods of the first frame of the requested run."""
        return self._pace.first_step(self.scene) * self.scene.time_step / self.scene.period

    @property
    def _instant(self) -> float:
        """The time on the stage in periods; the requested one while a run is on its way to it or stopped before."""
        report, requested = self.report, self._pace.begin_at
        if report is None or report.number < self._run_number or report.step <= self._pace.first_step(report.scene):
            return requested
        return report.time / report.scene.period

    def set_scene(self, scene: Scene, speed: float | None = None, ends: bool = False, rests: bool = False) -> None:
        """Requests a whole scene at a speed in periods per second (None: the problem's); one that ``ends`` stops at its
        end. It plays, or ``rests`` at the phase on the stage. Sets :attr:`refused` if the scene is too large."""
        with self._lock:
            if crowd := scene_size_refusal(scene):
                self.refuse(crowd)
                return
            if self.pinned and scene.problem != self.scene.problem:
                if not self.pinned.follows:
                    self._news = monotonic(), tr("Unpinned: only runs of the same problem can be compared.")
                self.unpin()
            elif self.pinned:
                self.pinned.follow(scene)
            phase = self._instant - max(0, math.ceil(self._instant - 1e-9) - 1)  # 1 of whole periods
            self._start(scene, speed, ends)
            self._send_request(restarts=self._pace.restarts + 1,  # also if it is the present scene
                               begin_at=phase if rests else 0.0, playing=not rests)

    def play(self, playing: bool, single_steps: int = 0) -> None:
        """Plays or pauses, and takes so many single time steps. A run that has reached its end continues beyond it."""
        with self._lock:
            self._rests = False
            self._beyond = self._beyond or (self.is_over and (playing or single_steps > 0))
            self._send_request(playing=playing, single_steps=self._pace.single_steps + single_steps)

    def pause_until_return(self) -> None:
        """Pauses the run of an idle visitor; the notice says so until the next request."""
        with self._lock:
            self._rests = True
            self._send_request(playing=False)

    def set_watched(self, watched: bool) -> None:
        """Pauses the run while no browser shows it; later it continues as if no time had passed."""
        with self._lock:
            if watched != self.watched:
                self.watched = watched
                self._send_request()

    @property
    def idle_seconds(self) -> float:
        return monotonic() - self._asked_at

    def break_down(self, particle: int | None, step: bool = True) -> int:
        """Pauses and requests one more ``step``, or the last one again, with all its parts recorded around a particle
        (None: ends that). Returns the number of the request, which the frame's report has too."""
        with self._lock:
            self._frame = replace(self._frame, broken_down=particle)
            if particle is None:
                self._send_request()
            else:
                self._beyond = self._beyond or self.is_over
                self._send_request(playing=False, single_steps=self._pace.single_steps + step)
            return self._number

    @property
    def playing(self) -> bool:
        return self._pace.playing

    @property
    def speed(self) -> float:
        """The requested speed in periods per second."""
        return self._pace.speed

    @property
    def stops_at_end(self) -> bool:
        return self._pace.ends

    @property
    def playback_request_key(self) -> tuple:
        """Key of the requests that advance the run (scene, restarts, single steps, playing), to notice new ones."""
        return self.scene, self._pace.restarts, self._pace.single_steps, self.playing

    @property
    def is_over(self) -> bool:
        """Whether the run has reached the end of its scene, and stops there."""
        return self.stops_at_end and not self._beyond and self.report is not None \
            and self.report.step >= self.report.scene.steps

    def reset(self, begin_at: float = 0.0, **pace: Any) -> None:
        """Starts the run again, at a time in periods and with other fields of its
        :class:`~solvers.engine.engine_messages.Pace`."""
        with self._lock:
            self._beyond = False
            self._send_request(restarts=self._pace.restarts + 1, begin_at=begin_at, **pace)

    def refuse(self, sentence: str, field: str = "") -> None:
        """Sets :attr:`refused` to a sentence without a full stop and the ``field`` that it is about; "" clears it."""
        with self._lock:
            self.refused, self._asked_at = (field, sentence) if sentence else None, monotonic()

    def announce(self, sentence: str) -> None:
        """Shows a sentence as the notice for 8 s."""
        with self._lock:
            self._news = monotonic(), sentence

    def set_speed(self, speed: float) -> None:
        """Sets the speed in periods per second; refuses more than 1000."""
        with self._lock:
            if speed > FASTEST:
                self.refuse(tr("Speed: {speed:g} periods a second are too many; at most {most:g} can be asked for",
                               speed=speed, most=FASTEST), "speed")
                return
            self._send_request(speed=speed)

    def set_frame_options(self, **options: object) -> None:
        """Sets fields of :class:`~solvers.engine.shared_frames.FrameOptions`, which selects what frames contain."""
        with self._lock:
            self._frame = replace(self._frame, **options)  # type: ignore[arg-type]
            self._send_request()

    def pin(self, on_frame: Callable[[], None], scene: Scene | None = None, method: str | None = None) -> None:
        """Starts a second run for comparison, at the present instant: of ``scene`` or the one on the stage; or, given a
        ``method`` (its key), of the session's scene with that, which it follows. ``on_frame`` is called after each of
        its frames. Sets :attr:`refused` if the scene does not allow the method."""
        with self._lock:
            shown = self.report.scene if self.report else self.scene
            if method:
                try:
                    scene = replace(self.scene, method=method)
                except SceneError as refusal:
                    return self.refuse(reword_for_page(str(refusal)))
            begin_at, scene = self._instant, scene or (shown if shown.problem == self.scene.problem else self.scene)
            self.unpin()
            self.pinned = PinnedRun(lambda run: self.links.open(run, self.link), scene, on_frame, method)
            self._send_request(begin_at=begin_at)

    @property
    def pinned_scene(self) -> Scene | None:
        """The scene of a second run that stays; None for one that follows, or without any."""
        return self.pinned.scene if self.pinned and not self.pinned.follows else None

    def unpin(self) -> None:
        with self._lock:
            pinned, self.pinned = self.pinned, None
        if pinned:
            pinned.close()

    def close(self) -> None:
        self.unpin()
        self.link.close()

    @property
    def others_playing(self) -> int:
        """Number of runs of other visitors that play."""
        return max(0, self.links.playing - self.playing * (1 + bool(self.pinned)))

    @property
    def compiling(self) -> bool:
        """Whether the last request waits for a compiler; meanwhile the scene before it continues."""
        return self._compiled_for == self._number > (self.report.number if self.report else 0) and not self._engine_lost

    @property
    def awaits_problem(self) -> bool:
        """Whether the last frame is of another problem than the requested scene's, whose first is still to come."""
        return self.report is not None and self.report.scene.problem != self.scene.problem and not self._error

    def notice(self) -> Notice | None:
        """Returns the most important message for the visitor; None if there is none."""
        with self._lock:
            waiting = self.report is None or self.report.number < self._number
            urgent, history = self._urgent_notice(waiting), self.history
            valid = self.report.valid_estimators if self.report else ()
        # Outside the lock: the bound of a large ring's step takes seconds, and frames must go on.
        return urgent or (None if waiting else doubt_notice(history, valid) or self._watch_speed())

    def _urgent_notice(self, waiting: bool) -> Notice | None:
        """Returns a message with priority over doubts; ``waiting`` is set while the last request has no frame yet."""
        if self._error:
            return Notice("trouble", translate_message(self._error))
        if self._engine_lost and waiting:
            return Notice("wait", tr("The simulation process ended unexpectedly; it is being restarted and the scene "
                                     "begins again."))
        if self.refused:
            return Notice("refused", tr("{refusal}. The previous scene continues.", refusal=self.refused[1]),
                          bool(self.refused[0]))
        if self._rests and not self.playing:
            return Notice("wait", tr("The run is paused because this page was idle for a while. Press Play to "
                                     "continue."))
        if waiting and not (self.report and self.compiling) and (said := preparing_notice(self.idle_seconds)):
            return said
        if monotonic() < self._news[0] + TO_BE_READ:
            return Notice("wait", self._news[1])
        if self.report and self.report.status != OK and self.report.reason and not waiting:
            return Notice(self.report.status, f"{reword_for_page(self.report.reason)}.")
        return None

    def _watch_speed(self) -> Notice | None:
        """Returns the message that other runs slow this one down, for 8 s after each time, as speeds fluctuate."""
        report, others = self.report, self.others_playing
        if report and report.playing and report.real_speed is not None and others \
                and report.real_speed < CROWDED_BELOW * self.speed * report.scene.period:
            self._crowded_at = monotonic()
        if monotonic() > self._crowded_at + TO_BE_READ:
            return None
        return Notice("wait", tr("{runs} runs share this computer and are slower than requested. Their results do not "
                                 "change.", runs=others + 1))

    def on_frame(self, report: FrameReport, arrays: FrameArrays) -> None:
        """Stores a frame and its samples; called on the engine's reader thread, as the methods below."""
        with self._lock:
            if report.fresh:
                self.history = NormHistory(report.scene, report.particles)
            self.history.add(report.rows)
            self.report, self._engine_lost, self._error = report, False, ""
        self._on_frame(report, arrays)

    def on_compiling(self, number: int) -> None:
        self._compiled_for = number

    def on_error(self, sentence: str) -> None:
        self._error = sentence

    def on_engine_lost(self) -> None:
        with self._lock:
            self._engine_lost = True
            self._news = monotonic(), tr("The simulation process ended unexpectedly; another one has taken its place, "
                                         "and the scene has begun again.")
            self._number += 1  # the link asks again under the next number

    def _start(self, scene: Scene, speed: float | None = None, ends: bool = False) -> None:
        self._requested, self.scene = asdict(scene), scene
        self._beyond = False  # playing beyond the end was requested
        self._pace = replace(self._pace, playing=True, ends=ends,
                             speed=VIEWS[scene.problem].speed if speed is None else speed)

    def _send_request(self, **pace: float) -> None:
        """Sends the scene, frame options and pace to the engine, after changing fields of the pace."""
        self._pace = replace(self._pace, **pace)  # type: ignore[arg-type]
        self._error, self.refused, self._asked_at = "", None, monotonic()
        now = replace(self._pace, playing=self.playing and self.watched, ends=self.stops_at_end and not self._beyond)
        self._number = self.link.ask(self.scene, now, self._frame)
        if "begin_at" in pace:
            self._run_number = self._number
        if self.pinned:
            self.pinned.set_pace(now, self._frame)
