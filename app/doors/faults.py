"""What fails while something that a visitor said is acted on: one line of log each, and few however often."""

import logging
import threading
import traceback
from pathlib import Path
from time import monotonic

LINES_A_MINUTE, MINUTE = 40, 60.0

_log = logging.getLogger(__name__)


def place_of(error: BaseException) -> str:
    """What kind of error this is and where it came up: nothing of what has led to it, which a stranger may have
    written."""
    steps = traceback.extract_tb(error.__traceback__)
    ours = [step for step in steps if "site-packages" not in step.filename] or steps
    where = f" in {Path(ours[-1].filename).name}, line {ours[-1].lineno}" if ours else ""
    return f"{type(error).__name__}{where}"


def noted(what: str, error: BaseException) -> None:
    """Log that ``what`` failed; all of it is there for who asks for debugging."""
    _log.error("%s: %s", what, place_of(error))
    _log.debug("%s", what, exc_info=error)


class Brief(logging.Filter):
    """Lets so many records a minute through, and says of how many there were more."""

    def __init__(self, lines: int = LINES_A_MINUTE, seconds: float = MINUTE):
        super().__init__()
        self._lines, self._seconds, self._lock = lines, seconds, threading.Lock()
        self._begun, self._count = monotonic(), 0

    def filter(self, record: logging.LogRecord) -> bool:
        with self._lock:
            if monotonic() >= self._begun + self._seconds:
                more, self._begun, self._count = self._count - self._lines, monotonic(), 0
                if more > 0:
                    record.msg, record.args = f"({more} more lines were left out) {record.getMessage()}", ()
            self._count += 1
            return self._count <= self._lines
