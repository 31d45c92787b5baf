"""Successor: a fork of the engine that compiles what is missing while the engine goes on, and then takes its place.

Taichi compiles in the one thread that also runs, and no process sees what another has compiled since it started; but a
forked child has all that its parent had. So nobody's stage waits for a compiler: the engine forks, goes on stepping
everybody, hands all sessions over to the child when that is ready, and leaves. The child is told beforehand what it
will get, and puts solvers in place for that while the engine still goes on: those of thirty visitors take up to half a
second, in which no stage would move. Linux only: elsewhere an engine compiles where it stands.
"""

import logging
import multiprocessing
import os
import signal
from collections.abc import Callable, Sequence
from contextlib import suppress
from multiprocessing.connection import Connection
from time import monotonic
from typing import Any

from solvers.running.run import build
from solvers.scene.scene import Scene
from solvers.workers import worker_process

CAN_FORK = worker_process.LINUX
PREPARED, TAKEN_OVER = "prepared", "taken over"
COMPILE_SECONDS = 3.0  # seconds of compiling after which what is there is handed over


class CompilingFork:
    """The child as its parent sees it, at work on ``scenes``, of which it may leave the last ones out. ``asked_for``
    says whether a visitor waits for it, or nobody yet."""

    def __init__(self, process_id: int, pipe: Connection, scenes: Sequence[Scene], asked_for: bool):
        self.scenes, self.asked_for, self.pipe = scenes, asked_for, pipe
        self.compiled: Sequence[Scene] = ()  # those that it has done with
        self.process_id, self._rests = process_id, False

    def can_take_over(self, announced: Callable[[], Any]) -> bool:
        """Whether it can take over. Once it has compiled it is told what is ``announced``, and prepares for that.
        Raises EOFError when it has died of its work, and MemoryError when that is why it could not do it."""
        if not self.pipe.poll(0):
            return False
        answer = self.pipe.recv()
        if isinstance(answer, MemoryError):
            raise answer
        if answer == PREPARED:
            return True
        self.compiled = self.scenes[:answer]
        self.pipe.send(announced())
        return False

    def pause(self, wanted: bool) -> None:
        """Have it do nothing for now, or go on."""
        if wanted != self._rests:
            self._rests = wanted
            with suppress(ProcessLookupError):  # its end will be noticed
                os.kill(self.process_id, signal.SIGSTOP if wanted else signal.SIGCONT)

    def take_over(self, estate: Any) -> None:
        """Hand everything over. When this returns the parent must touch nothing more and leave; raises EOFError or
        OSError if the child died: then all is still the parent's."""
        self.pause(False)
        self.pipe.send(estate)
        self.pipe.recv()

    def terminate(self) -> None:
        """End it if it has not ended, and bury it."""
        with suppress(ProcessLookupError):
            os.kill(self.process_id, signal.SIGKILL)
        os.waitpid(self.process_id, 0)
        self.pipe.close()


def fork(scenes: Sequence[Scene], asked_for: bool, prepare: Callable[[Any], None]) -> CompilingFork | Any:
    """Fork a successor that compiles what the scenes need, or the first of them that fit into a short time, and then
    calls ``prepare`` with what is announced to it.

    Returns twice: at once, in the parent, with the :class:`CompilingFork`; and, when the parent leaves, in the child,
    with the estate that it was given. A child that cannot compile logs why and ends. One that nobody waits for yields
    to other work.
    """
    ours, theirs = multiprocessing.Pipe()
    parent = os.getpid()
    process_id = os.fork()
    if process_id:
        theirs.close()
        return CompilingFork(process_id, ours, scenes, asked_for)
    try:
        ours.close()
        worker_process.die_with_parent(True)
        if os.getppid() != parent:
            os._exit(1)
        if not asked_for:
            os.sched_setscheduler(0, os.SCHED_BATCH, os.sched_param(0))
        theirs.send(_compile(scenes))
        prepare(theirs.recv())
        theirs.send(PREPARED)
        estate = theirs.recv()
        os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
        worker_process.die_with_parent(False)
        theirs.send(TAKEN_OVER)
        theirs.close()
        return estate
    except (ConnectionError, EOFError):  # the parent has ended: nobody waits for what has been compiled
        os._exit(1)
    except BaseException as error:
        if isinstance(error, MemoryError):
            theirs.send(MemoryError())
        logging.getLogger(__name__).exception("could not be compiled: %s", scenes[0])
        os._exit(1)  # the parent's sessions are not this process's to end


def _compile(scenes: Sequence[Scene]) -> int:
    """Compile what the scenes need, one after another until time is up; returns how many."""
    begun = monotonic()
    for done, scene in enumerate(scenes, 1):
        build(scene).compile()
        if monotonic() - begun > COMPILE_SECONDS:
            return done
    return len(scenes)
