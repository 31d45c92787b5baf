"""The engine process: one thread that does everything with Taichi, and one pipe to the page.

Sessions are scheduled round-robin: each that is behind its clock gets one short time slice, then the next. Requests are
read before every round, and only a session's last one counts; of many that arrive at once some wait for the next round,
so that no run stands still for the others' new scenes. Missing kernels are compiled by a fork, which then replaces the
engine; usual ones are compiled before visitors request them.
"""

import gc
import logging
import os
import signal
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from multiprocessing import connection
from multiprocessing.connection import Connection
from time import perf_counter

from solvers.engine import compiling_fork, engine_messages
from solvers.engine.compiling_fork import CompilingFork
from solvers.engine.engine_messages import FrameReport, SessionRequest, Survey, SurveyResults
from solvers.engine.session_stepper import BlockFreed, SessionStepper
from solvers.engine.surveyor import Surveyor, SurveyQueue
from solvers.kernels import runtime
from solvers.running.run import build
from solvers.scene.kernel_options import kernel_key
from solvers.scene.scene import Scene
from solvers.solver.base import Solver
from solvers.translatable_message import Message

IDLE_SECONDS = 0.5
WISHES_SECONDS = 0.03  # of a round for new wishes, after which the next has to wait; a new scene takes some 10 ms
TOGETHER_SECONDS = 0.006  # that a frame waits to be sent with others, in a round of many sessions
BACKGROUND_SHARE = 0.2  # share of the time, while frames are late, for landscapes and kernels no visitor waits for
NO_MEMORY = Message("this scene needs more memory than there is: choose fewer particles")
FAILED = Message("the simulation of this scene failed; change a setting")


def serve_engine(pipe: Connection, warm_up: Scene, usual: Sequence[Scene]) -> None:
    """Serves sessions, with messages through ``pipe``, until the page exits, or a fork takes over. The scene
    ``warm_up`` is compiled before the first visitor, ``usual`` scenes when there is time."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the page's to handle; the pipe then closes
    if compiling_fork.CAN_FORK:
        runtime.allow_forks()
    runtime.start()
    build(warm_up).compile()
    first = os.getpid()
    # Until the page is gone, and so is the reason to be here.
    with suppress(EOFError, BrokenPipeError, ConnectionResetError):
        pipe.send(engine_messages.EngineReady())
        EngineServer(pipe, {kernel_key(warm_up)}, usual).serve()
    if os.getpid() != first:
        runtime.store_kernels_and_exit()


class EngineServer:
    """Server of one engine's sessions, with messages through ``pipe``. ``compiled`` are the keys (``kernel_key``) of
    scenes whose kernels are compiled, ``usual`` scenes to compile when there is time. A session that fails is dropped
    and informed; its next request restarts it."""

    def __init__(self, pipe: Connection, compiled: Iterable[tuple] = (), usual: Sequence[Scene] = ()):
        self._pipe, self._compiled = pipe, set(compiled)
        self._usual = list(usual)
        self._steppers: dict[int, SessionStepper] = {}
        self._wishes: dict[int, SessionRequest] = {}  # that were read and are pending, by session
        self._waiting: dict[int, SessionRequest] = {}  # for the compiler, by session
        self._prepared: dict[int, Solver] = {}  # in a fork, for sessions that it will get
        self._successor: CompilingFork | None = None
        self._surveys: dict[int, Survey] = {}  # that wait for the compiler, or to be passed on, by session
        self._surveyor = Surveyor()
        self._queue = SurveyQueue()  # of the surveys, where no surveyor can be forked
        self._frames: list[FrameReport] = []  # that go together, soon
        self._first = 0.0  # when the first of them was made, by perf_counter
        self._late = False  # whether most sessions that move get their frames late

    def serve(self) -> None:
        """Serves sessions until a fork has taken over from this process. Raises EOFError when the page has exited."""
        try:
            self._serve()
        finally:
            self._surveyor.terminate()

    def _serve(self) -> None:
        while True:
            self._read_messages()
            self._act_on_requests()
            self._update_partners()
            busy = [self._run_session_turn(stepper) for stepper in list(self._steppers.values())]
            self._send_frames()
            if self._successor and self._try_hand_over(self._successor):
                return
            inherited = compiling_fork.CAN_FORK and self._compile_in_fork()
            surveys = self._survey(any(busy))
            # Sleep until a message comes or a frame or step is due.
            if not (any(busy) or inherited or surveys or self._wishes):
                due = min((s.next_due for s in self._steppers.values()), default=float("inf"))
                pipes = [self._pipe, *(child.pipe for child in (self._successor, self._surveyor.child) if child)]
                connection.wait(pipes, min(IDLE_SECONDS, max(0.001, due - perf_counter())))

    def _survey(self, busy: bool) -> bool:
        """Passes on surveys whose scenes are compiled, and results; without forks computes a point, unless ``busy``.
        Returns whether there is more to do."""
        for survey in list(self._surveys.values()):
            if not compiling_fork.CAN_FORK:
                self._queue.accept(self._surveys.pop(survey.session))
            elif survey.scene is None or kernel_key(survey.scene) in self._compiled:
                inherited = [self._pipe, *([self._successor.pipe] if self._successor else [])]
                if forked := self._surveyor.request(self._surveys.pop(survey.session), inherited):
                    self._pipe.send(engine_messages.EngineForked(forked.process_id))
        for message in self._surveyor.read_results():
            self._pipe.send_bytes(message)
        if self._surveyor.child:
            self._surveyor.child.pause(self._frames_go_first)
        if self._queue and not busy and (result := self._queue.compute_next()):
            self._pipe.send(SurveyResults((result,)))
        return bool(self._queue)

    def _run_session_turn(self, stepper: SessionStepper) -> bool:
        """Runs one turn of one session; returns whether there was anything to do."""
        busy = False

        def work() -> FrameReport | None:
            nonlocal busy
            busy = stepper.is_behind
            takes = stepper.turn_seconds if busy else 0.0
            if self._frames and perf_counter() + takes > self._first + TOGETHER_SECONDS:
                self._send_frames()
            if busy:
                stepper.advance_slice()
            return stepper.write_frame() if stepper.frame_is_ready else None

        report = self._run_guarded(stepper.wish, work)
        if report is not None:
            self._first = self._first if self._frames else perf_counter()
            self._frames.append(report)
        return busy or report is not None

    def _send_frames(self) -> None:
        if self._frames:
            self._pipe.send(engine_messages.FrameBatch(tuple(self._frames)))
            self._frames.clear()

    def _read_messages(self) -> None:
        """Reads all messages from the page; only a session's last request counts, in the position of its first."""
        while self._pipe.poll(0):
            message = self._pipe.recv()
            match message:
                case SessionRequest():
                    self._wishes[message.session] = message
                case None:
                    raise EOFError  # the pool closes
                case engine_messages.Prewarm():
                    self._usual = list(message.scenes)
                case Survey():
                    self._surveys[message.session] = message
                case engine_messages.SessionClosed():
                    self._wishes.pop(message.session, None)
                    self._surveys[message.session] = Survey(message.session)
                    self._drop_session(message.session)

    def _act_on_requests(self) -> None:
        """Acts on the requests that were read, the oldest first, for a short time; the rest wait for the next round."""
        begun = perf_counter()
        while self._wishes and perf_counter() - begun < WISHES_SECONDS:
            wish = self._wishes.pop(next(iter(self._wishes)))
            self._run_guarded(wish, partial(self._accept_request, wish))

    def _accept_request(self, wish: SessionRequest) -> None:
        """Acts on a session's request. If its scene must be compiled first the request waits; only its pace and frame
        contents apply at once, to the previous scene."""
        self._waiting.pop(wish.session, None)
        stepper = self._steppers.get(wish.session)
        anew = False
        if compiling_fork.CAN_FORK and kernel_key(wish.scene) not in self._compiled:
            self._waiting[wish.session] = wish
            self._pipe.send(engine_messages.CompilePending(wish.session, wish.number))
            if stepper:
                now = stepper.wish
                stepper.accept(replace(now, pace=replace(now.pace, playing=wish.pace.playing, speed=wish.pace.speed),
                                       frame=replace(wish.frame, broken_down=now.frame.broken_down)))
        elif stepper:
            anew = stepper.accept(wish)
        else:
            self._steppers[wish.session] = SessionStepper(wish)
            anew = True
        partner = next((stepper for session, stepper in self._steppers.items()
                        if session == wish.partner or stepper.wish.partner == wish.session), None)
        if anew and partner:
            self._run_guarded(partner.wish, partial(partner.rebuild, wish.pace.begin_at))

    def _update_partners(self) -> None:
        """Sets, in every stepper, the number of moving sessions and its partner, and stores whether most sessions get
        their frames late."""
        running = [stepper.frames_are_late for stepper in self._steppers.values() if stepper.moving]
        moving, self._late = len(running), 2 * sum(running) > len(running)
        for stepper in self._steppers.values():
            stepper.partner, stepper.sessions = None, max(1, moving)
        for stepper in self._steppers.values():
            if partner := self._steppers.get(stepper.wish.partner or 0):
                stepper.partner, partner.partner = partner, stepper

    @property
    def _frames_go_first(self) -> bool:
        """Whether what is done beside the frames rests now: for most of each second while they are late."""
        return self._late and perf_counter() % 1.0 > BACKGROUND_SHARE

    def _compile_in_fork(self) -> bool:
        """Lets a fork compile the scene a visitor waits for, or else usual scenes: these are abandoned for a visitor,
        and slowed down while frames are late. Returns whether this process is the fork and has just taken over."""
        wanted = [wish.scene for wish in self._waiting.values()]
        if self._successor:
            soon = bool(self._successor.compiled)  # it prepares to take over: new requests come next
            if soon or not wanted or kernel_key(self._successor.scenes[0]) in map(kernel_key, wanted):
                urgent = soon or bool(wanted)
                self._successor.pause(not urgent and self._frames_go_first)
                return False
            self._successor.terminate()
            self._successor = None
        elif not wanted and self._usual:
            self._usual = [scene for scene in self._usual if kernel_key(scene) not in self._compiled]
        if scenes := wanted[:1] or self._usual:
            answer = compiling_fork.fork_to_compile(scenes, bool(wanted), self._prepare_solvers)
            if not isinstance(answer, CompilingFork):
                self._take_over_sessions(*answer)
                return True
            self._successor = answer
            self._pipe.send(engine_messages.EngineForked(answer.process_id))
        return False

    def _try_hand_over(self, replacement: CompilingFork) -> bool:
        """Hands everything over to a fork that is ready; returns whether it was and has taken over, so that this
        process can exit. A fork that has failed is given up."""
        try:
            if not replacement.can_take_over(lambda: {session: stepper.solver.scene
                                                      for session, stepper in self._steppers.items()}):
                return False
            states = {session: (stepper.wish, stepper.state()) for session, stepper in self._steppers.items()}
            self._surveyor.terminate()  # one of the fork's own knows the new kernels
            replacement.hand_over((states, {**self._waiting, **self._wishes}, self._surveys,
                                   self._compiled | set(map(kernel_key, replacement.compiled)), self._usual))
            return True
        except MemoryError:
            self._give_up_fork(replacement, NO_MEMORY)
        except (EOFError, OSError):
            self._give_up_fork(replacement, FAILED)
        return False

    def _give_up_fork(self, replacement: CompilingFork, sentence: str) -> None:
        """Ends a fork that could not compile, tells the visitors who wait for it why in a ``sentence``, and removes the
        scene from the usual ones."""
        replacement.terminate()
        self._successor, failed = None, kernel_key(replacement.scenes[0])
        self._usual = [scene for scene in self._usual if kernel_key(scene) != failed]
        for wish in [wish for wish in self._waiting.values() if kernel_key(wish.scene) == failed]:
            del self._waiting[wish.session]
            self._pipe.send(engine_messages.EngineError(wish.session, wish.number, sentence))

    def _prepare_solvers(self, announced: dict[int, Scene]) -> None:
        """Builds, in a fork, solvers for the sessions (number: scene) that it will get, while they continue elsewhere;
        reuses those that it had when it forked. Also collects garbage, and exempts survivors from later collections."""
        for session, scene in announced.items():
            stepper = self._steppers.get(session)
            with suppress(Exception):  # it is tried again later, with an error message to the visitor
                self._prepared[session] = stepper.solver if stepper and stepper.solver.scene == scene else build(scene)
        for stepper in self._steppers.values():  # as they were when it forked
            stepper.close()
        self._steppers.clear()
        gc.unfreeze()
        gc.collect()
        gc.freeze()

    def _take_over_sessions(self, states: dict[int, tuple[SessionRequest, dict]], wishes: dict[int, SessionRequest],
                            surveys: dict[int, Survey], compiled: set[tuple], usual: list[Scene]) -> None:
        """Takes over, in a fork, the engine's sessions: the request and the state of each stepper, the pending requests
        ``wishes`` and ``surveys`` by session, the keys of scenes that are ``compiled``, and the ``usual`` scenes."""
        self._wishes, self._waiting, self._successor = wishes, {}, None
        self._surveys, self._surveyor = surveys, Surveyor()
        self._compiled, self._usual = compiled, usual
        self._pipe.send(engine_messages.EngineReplacedByFork(os.getpid()))
        for wish, state in states.values():
            self._run_guarded(wish, partial(self._resume_session, state))
        self._prepared.clear()

    def _resume_session(self, state: dict) -> None:
        session = state["wish"].session
        self._steppers[session] = SessionStepper.from_state(state, self._prepared.get(session))

    def _run_guarded(self, wish: SessionRequest, work: Callable[[], FrameReport | None]) -> FrameReport | None:
        """Returns the result of ``work()``, a part of the work for a session's request; after an error, which drops
        only that session, None."""
        sentence = None
        try:
            return work()
        except BlockFreed:
            pass
        except MemoryError:
            sentence = NO_MEMORY
        except Exception:
            logging.getLogger(__name__).exception("session %d failed and is dropped: %s", wish.session, wish.scene)
            sentence = FAILED
        self._drop_session(wish.session)  # only now: the exception's frames may have held views of the block
        if sentence:
            self._pipe.send(engine_messages.EngineError(wish.session, wish.number, sentence))
        return None

    def _drop_session(self, session: int) -> None:
        self._waiting.pop(session, None)
        if stepper := self._steppers.pop(session, None):
            stepper.close()
