"""ForkedChild: an engine's handle of a child that it has forked, which can be suspended and killed."""

import os
import signal
from contextlib import suppress
from multiprocessing.connection import Connection


class ForkedChild:
    """Handle, in the parent, of a forked child of this process id that speaks to it through ``pipe``."""

    def __init__(self, process_id: int, pipe: Connection):
        self.process_id, self.pipe = process_id, pipe
        self._suspended = False

    def pause(self, suspended: bool) -> None:
        """Suspends the child, or lets it continue if not ``suspended``."""
        if suspended != self._suspended:
            self._suspended = suspended
            with suppress(ProcessLookupError):  # its end will be noticed
                os.kill(self.process_id, signal.SIGSTOP if suspended else signal.SIGCONT)

    def terminate(self) -> None:
        """Kills the child if it still runs, and reaps it."""
        with suppress(ProcessLookupError):
            os.kill(self.process_id, signal.SIGKILL)
        os.waitpid(self.process_id, 0)
        self.pipe.close()
