"""Fork of an engine that compiles missing kernels while the engine continues, and then replaces it.

Taichi compiles in the one thread that also runs, and no process sees what another has compiled since it started; but a
forked child has everything that its parent had. So no run has to wait for the compiler: the engine forks, continues all
sessions, transfers them to the child when that is ready, and exits. The child is informed of its sessions beforehand,
and builds solvers for them while the engine still runs: those of thirty visitors take up to half a second, in which no
run would move. Linux only: elsewhere an engine compiles in its own process.
"""

import logging
import multiprocessing
import os
from collections.abc import Callable, Sequence
from multiprocessing.connection import Connection
from time import monotonic
from typing import Any

from solvers.engine.forked_child import ForkedChild
from solvers.running.run import build
from solvers.scene.scene import Scene
from solvers.workers import worker_process

CAN_FORK = worker_process.LINUX
PREPARED, TAKEN_OVER = "prepared", "taken over"
COMPILE_SECONDS = 3.0  # seconds of compiling after which what is there is handed over


class CompilingFork(ForkedChild):
    """Handle, in the parent, of a child that compiles ``scenes``, possibly not all; ``asked_for`` is whether a visitor
    waits for it."""

    def __init__(self, process_id: int, pipe: Connection, scenes: Sequence[Scene], asked_for: bool):
        super().__init__(process_id, pipe)
        self.scenes, self.asked_for = scenes, asked_for
        self.compiled: Sequence[Scene] = ()  # those that are compiled

    def can_take_over(self, announcement: Callable[[], Any]) -> bool:
        """Returns, at once, whether the child is ready to replace the engine. Once it has compiled it receives the
        result of ``announcement()``, the sessions to prepare for. Raises EOFError if it has died, MemoryError if it is
        out of memory."""
        if not self.pipe.poll(0):
            return False
        answer = self.pipe.recv()
        if isinstance(answer, MemoryError):
            raise answer
        if answer == PREPARED:
            return True
        self.compiled = self.scenes[:answer]
        self.pipe.send(announcement())
        return False

    def hand_over(self, state: Any) -> None:
        """Transfers the engine's ``state`` to the child, and waits until it has it: then the parent must touch nothing
        more and exit. Raises EOFError or OSError if the child died: then all still belongs to the parent."""
        self.pause(False)
        self.pipe.send(state)
        self.pipe.recv()


def fork_to_compile(scenes: Sequence[Scene], asked_for: bool, prepare: Callable[[Any], None]) -> CompilingFork | Any:
    """Forks a child that compiles the scenes' kernels, or the first that fit into a short time, and then calls
    ``prepare`` with the announcement of the parent (:meth:`CompilingFork.can_take_over`).

    Returns twice: at once, in the parent, with the :class:`CompilingFork`; and, when the parent exits, in the child,
    with the state from :meth:`CompilingFork.hand_over`. A child that cannot compile logs why and exits. One that no
    visitor waits for (not ``asked_for``) yields to other work."""
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
        theirs.send(_compile_scenes(scenes))
        prepare(theirs.recv())
        theirs.send(PREPARED)
        state = theirs.recv()
        os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
        worker_process.die_with_parent(False)
        theirs.send(TAKEN_OVER)
        theirs.close()
        return state
    except (ConnectionError, EOFError):  # the parent has ended: the result is useless
        os._exit(1)
    except BaseException as error:
        if isinstance(error, MemoryError):
            theirs.send(MemoryError())
        logging.getLogger(__name__).exception("could not be compiled: %s", scenes[0])
        os._exit(1)  # the parent's sessions are not this process's to end


def _compile_scenes(scenes: Sequence[Scene]) -> int:
    """Compiles the scenes' kernels, one after another until time is up; returns the number of compiled scenes."""
    begun = monotonic()
    for done, scene in enumerate(scenes, 1):
        build(scene).compile()
        if monotonic() - begun > COMPILE_SECONDS:
            return done
    return len(scenes)
