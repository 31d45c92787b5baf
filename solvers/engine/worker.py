"""The engine process: one thread that does everything with Taichi, and one pipe to the page.

Sessions are served in fair turns: each that is behind its clock gets one short slice, then the next. Wishes are
read before every turn, so a dragged slider never leaves stale work in a queue.
"""

import logging
import signal
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from multiprocessing.connection import Connection
from time import perf_counter

from solvers import runtime
from solvers.engine.messages import FrameReport, Goodbye, Ready, Seen, Trouble, Wish
from solvers.engine.stepper import BlockGone, Stepper
from solvers.run import build
from solvers.scene import Scene

IDLE_SECONDS = 0.5
NO_MEMORY = "this scene needs more memory than there is: choose fewer particles"
FAILED = "the simulation of this scene failed; change a setting"


def main(pipe: Connection, warm_up: Scene) -> None:
    """Serve sessions until the page goes away. ``warm_up`` is compiled before the first visitor comes."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the page's to handle; the pipe then closes
    runtime.start()
    build(warm_up).compile()
    # Until the page is gone, and so is the reason to be here.
    with suppress(EOFError, BrokenPipeError, ConnectionResetError):
        pipe.send(Ready())
        Worker(pipe).serve()


class Worker:
    """The sessions of one engine. One that fails is dropped and told; its next wish begins it anew."""

    def __init__(self, pipe: Connection):
        self._pipe = pipe
        self._steppers: dict[int, Stepper] = {}

    def serve(self) -> None:
        while True:
            self._read_messages()
            busy = [self._serve_one(stepper) for stepper in list(self._steppers.values())]
            if not any(busy):
                self._wait()

    def _serve_one(self, stepper: Stepper) -> bool:
        """One turn of one session; says whether there was anything to do."""
        busy = False

        def work() -> FrameReport | None:
            nonlocal busy
            busy = stepper.behind
            if busy:
                stepper.turn()
            return stepper.frame() if stepper.ready else None

        report = self._contain(stepper.wish, work)
        if report is not None:  # sent out here: a pipe that fails ends the engine, not the session
            self._pipe.send(report)
        return busy or report is not None

    def _wait(self) -> None:
        """Sleep until a message comes or the next frame or step is due."""
        due = min((s.next_due for s in self._steppers.values()), default=float("inf"))
        self._pipe.poll(min(IDLE_SECONDS, max(0.001, due - perf_counter())))

    def _read_messages(self) -> None:
        """Take all messages; of a session's wishes only the last counts."""
        wishes: dict[int, Wish] = {}
        while self._pipe.poll(0):
            message = self._pipe.recv()
            match message:
                case Wish():
                    wishes[message.session] = message
                case Seen():
                    if message.session in self._steppers:
                        self._steppers[message.session].seen()
                case None:
                    raise EOFError  # the pool closes
                case Goodbye():
                    wishes.pop(message.session, None)
                    self._drop(message.session)
        for wish in wishes.values():
            self._contain(wish, partial(self._accept, wish))

    def _accept(self, wish: Wish) -> None:
        if wish.session in self._steppers:
            self._steppers[wish.session].accept(wish)
        else:
            self._steppers[wish.session] = Stepper(wish)

    def _contain(self, wish: Wish, work: Callable[[], FrameReport | None]) -> FrameReport | None:
        """Do a piece of one session's work; what goes wrong in it costs that session alone."""
        sentence = None
        try:
            return work()
        except BlockGone:
            pass
        except MemoryError:
            sentence = NO_MEMORY
        except Exception:
            logging.getLogger(__name__).exception("session %d failed and is dropped: %s", wish.session, wish.scene)
            sentence = FAILED
        self._drop(wish.session)  # only now: the exception's frames may have held views of the block
        if sentence:
            self._pipe.send(Trouble(wish.session, wish.number, sentence))
        return None

    def _drop(self, session: int) -> None:
        if stepper := self._steppers.pop(session, None):
            stepper.close()
