"""The log of failures and refusals: one line each, with a rate limit."""

import logging
import threading
import traceback
from collections import Counter
from pathlib import Path
from time import monotonic

LINES_A_MINUTE, REFUSALS_A_MINUTE, MINUTE = 40, 10, 60.0

_log = logging.getLogger(__name__)


def error_location(error: BaseException) -> str:
    """Returns type and place of an error, "ValueError in page.py, line 3", without any text that clients may send."""
    steps = traceback.extract_tb(error.__traceback__)
    ours = [step for step in steps if "site-packages" not in step.filename] or steps
    where = f" in {Path(ours[-1].filename).name}, line {ours[-1].lineno}" if ours else ""
    return f"{type(error).__name__}{where}"


def log_failure(what: str, error: BaseException) -> None:
    """Logs ``what``, such as "a page could not close", with the error's place; the traceback at debug level."""
    _log.error("%s: %s", what, error_location(error))
    _log.debug("%s", what, exc_info=error)


class RateLimitFilter(logging.Filter):
    """Log filter that passes so many records (``lines``) in ``seconds``, and tells how many it dropped."""

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


class RefusalLog:
    """Thread-safe log of so many refusals (``lines``) in ``seconds``. Data sent by clients is never logged."""

    def __init__(self, lines: int = REFUSALS_A_MINUTE, seconds: float = MINUTE):
        self._lines, self._seconds, self._lock = lines, seconds, threading.Lock()
        self._written, self._more = 0, Counter[str]()

    def record(self, sentence: str, address: str = "") -> None:
        """Logs a refusal, of an IP address if given, at once; after many only their count, when the time is over."""
        with self._lock:
            if not self._written:
                timer = threading.Timer(self._seconds, self._log_suppressed_count)
                timer.daemon = True
                timer.start()
            self._written += 1
            if self._written > self._lines:
                self._more[sentence] += 1
                return
        _log.warning("refused%s: %s", f" from {address}" * bool(address), sentence)

    def _log_suppressed_count(self) -> None:
        with self._lock:
            more, self._written = self._more, 0
            self._more = Counter()
        if more:
            often, count = more.most_common(1)[0]
            _log.warning("refused %d more in %.0f s, %d of them: %s", more.total(), self._seconds, count, often)
