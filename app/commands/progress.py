"""Console during long computations: a clean standard output, Ctrl-C, and a progress bar with the time left."""

import contextlib
import ctypes
import os
import signal
import sys
import threading
import time
import warnings
from collections.abc import Callable, Iterator, Mapping

BAR_WIDTH = 30  # of the progress bar in characters
BAR_TEXT = 24  # of the text beside it; the line fits a terminal of 80
PATIENCE = 1.0  # seconds before a bar is shown
MEASURED = 2.0  # seconds of work after which the rest is estimated from it


class RemainingTime:
    """Estimate of the time left, from the pace since the first part was done, so that compilation does not count."""

    def __init__(self) -> None:
        self._first: tuple[float, float] | None = None  # part done, and when

    def text(self, part: float, now: float) -> str:
        """Returns "9 s left", from the part done (0 to 1) at the time ``now``, in s; "" until enough was measured."""
        if self._first is None:
            self._first = part, now
        done, took = part - self._first[0], now - self._first[1]
        return f"{took * (1 - part) / done:.0f} s left" if done > 0 and took >= MEASURED else ""


@contextlib.contextmanager
def stdout_to_stderr() -> Iterator[None]:
    """Context manager: redirects all standard output, native code's and Taichi's too, to standard error."""
    sys.stdout.flush()
    saved = os.dup(1)
    os.dup2(2, 1)
    try:
        yield
    finally:
        sys.stdout.flush()
        with contextlib.suppress(OSError, AttributeError, TypeError):
            ctypes.CDLL(None).fflush(None)  # text in C's buffer would be printed later
        os.dup2(saved, 1)
        os.close(saved)


@contextlib.contextmanager
def record_interrupts() -> Iterator[Callable[[], None]]:
    """Context manager: records Ctrl-C and yields a function that raises a KeyboardInterrupt that was swallowed.

    An exception raised while Taichi compiles can get lost in its callbacks, or be replaced; during Taichi's import it
    would be reported as a broken installation, so it waits."""
    noted = False

    def on_interrupt(number: int, frame: object) -> None:
        nonlocal noted
        noted = True
        if not getattr(getattr(sys.modules.get("taichi"), "__spec__", None), "_initializing", False):
            raise KeyboardInterrupt

    def check() -> None:
        if noted:
            raise KeyboardInterrupt

    if threading.current_thread() is not threading.main_thread():  # other threads get no signals
        yield check
        return
    before = signal.signal(signal.SIGINT, on_interrupt)
    try:
        yield check
    except Exception:
        check()  # native code may have replaced the exception
        raise
    finally:
        signal.signal(signal.SIGINT, before)


@contextlib.contextmanager
def show_progress(quiet: bool) -> Iterator[Callable[..., None]]:
    """Context manager: keeps standard output clean, records Ctrl-C, and shows a progress bar unless ``quiet``.

    Yields a function to call now and then with the part done, 0 to 1, and perhaps a text to show beside the bar."""
    begun, drawn, remaining = time.monotonic(), False, RemainingTime()
    shown = not quiet and sys.stderr.isatty() and not is_dumb_terminal(os.environ)

    def show(part: float, what: str = "") -> None:
        nonlocal drawn
        check()
        now = time.monotonic()
        left = remaining.text(part, now)
        if not shown or now < begun + PATIENCE:
            return
        drawn = True
        bar = ("#" * round(part * BAR_WIDTH)).ljust(BAR_WIDTH, ".")
        line = f"\r[{bar}] {100 * part:3.0f} %  {left:<14}{what:<{BAR_TEXT}.{BAR_TEXT}}"
        print(line, end="", file=sys.stderr, flush=True)

    with stdout_to_stderr(), record_interrupts() as check:
        warnings.simplefilter("ignore", SyntaxWarning)  # Taichi's source, on its first import by Python 3.12 on
        try:
            yield show
        finally:
            if drawn:  # wipe the bar off the line
                print("\r" + " " * (BAR_WIDTH + 24 + BAR_TEXT) + "\r", end="", file=sys.stderr, flush=True)


def wants_colour(environment: Mapping[str, str], is_terminal: bool) -> bool:
    """Whether to print colours: on a terminal, or if the environment has FORCE_COLOR; never with NO_COLOR."""
    if environment.get("NO_COLOR") or is_dumb_terminal(environment):
        return False
    return is_terminal or bool(environment.get("FORCE_COLOR"))


def is_dumb_terminal(environment: Mapping[str, str]) -> bool:
    """Whether the environment's TERM supports neither colours nor overwriting of lines."""
    return environment.get("TERM") in (None, "", "dumb")
