"""The log of what was refused: a line each, and few lines however much it is."""

import logging
import threading
from collections import Counter

LINES_A_MINUTE, MINUTE = 10, 60.0

_log = logging.getLogger(__name__)


class Refusals:
    """Counts refusals. Any thread may call. What a client has sent never goes into a line."""

    def __init__(self, lines: int = LINES_A_MINUTE, seconds: float = MINUTE):
        self._lines, self._seconds, self._lock = lines, seconds, threading.Lock()
        self._written, self._more = 0, Counter[str]()

    def note(self, sentence: str, who: str = "") -> None:
        """Log that this was refused, now or, after many, as a number when the minute ends."""
        with self._lock:
            if not self._written:
                timer = threading.Timer(self._seconds, self._minute_ends)
                timer.daemon = True
                timer.start()
            self._written += 1
            if self._written > self._lines:
                self._more[sentence] += 1
                return
        _log.warning("refused%s: %s", f" from {who}" * bool(who), sentence)

    def _minute_ends(self) -> None:
        with self._lock:
            more, self._written = self._more, 0
            self._more = Counter()
        if more:
            often, count = more.most_common(1)[0]
            _log.warning("refused %d more in %.0f s, %d of them: %s", more.total(), self._seconds, count, often)
