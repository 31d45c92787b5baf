"""Where results go: checked and atomic files, a clean standard output, messages and a progress bar."""

import contextlib
import ctypes
import json
import os
import signal
import stat
import sys
import threading
import time
import warnings
from collections.abc import Callable, Iterator
from typing import TextIO

from app.commands.flags import BadInput


def say(message: object) -> None:
    """One line on standard error."""
    print("mpm-lab: " + " ".join(str(message).split()), file=sys.stderr, flush=True)


def json_text(values: dict, lines: bool = False) -> str:
    """One JSON object, on one line or on many; NaN and infinity, which JSON has not, are an error."""
    return json.dumps(values, allow_nan=False, indent=2 if lines else None) + "\n"


@contextlib.contextmanager
def stdout_to_stderr() -> Iterator[None]:
    """Meanwhile, what native code or Taichi prints to standard output goes to standard error."""
    sys.stdout.flush()
    saved = os.dup(1)
    os.dup2(2, 1)
    try:
        yield
    finally:
        sys.stdout.flush()
        with contextlib.suppress(OSError, AttributeError, TypeError):
            ctypes.CDLL(None).fflush(None)  # native text still in C's own buffer would come out later
        os.dup2(saved, 1)
        os.close(saved)


@contextlib.contextmanager
def noted_interrupts() -> Iterator[Callable[[], None]]:
    """Ctrl-C as usual, and noted: call what this yields now and then to raise one that native code swallowed.

    An exception raised while Taichi compiles can get lost in its callbacks, or come out as another; one that is raised
    while it imports makes it complain of a broken installation, so that waits.
    """
    noted = False

    def note(number: int, frame: object) -> None:
        nonlocal noted
        noted = True
        if not getattr(getattr(sys.modules.get("taichi"), "__spec__", None), "_initializing", False):
            raise KeyboardInterrupt

    def check() -> None:
        if noted:
            raise KeyboardInterrupt

    if threading.current_thread() is not threading.main_thread():  # others get no signals
        yield check
        return
    before = signal.signal(signal.SIGINT, note)
    try:
        yield check
    except Exception:
        check()  # native code may make another error of it
        raise
    finally:
        signal.signal(signal.SIGINT, before)


@contextlib.contextmanager
def working(quiet: bool) -> Iterator[Callable[..., None]]:
    """While solvers work: a clean standard output, Ctrl-C noted, and a progress bar unless ``quiet``.

    Yields what is to be called now and then with the part done, 0 to 1, and, if one likes, what is being done.
    """
    with stdout_to_stderr(), noted_interrupts() as check, contextlib.closing(ProgressBar(sys.stderr, quiet)) as bar:
        warnings.simplefilter("ignore", SyntaxWarning)  # Taichi's source, on its first import by Python 3.12 on

        def show(part: float, what: str = "") -> None:
            check()
            bar.show(part, what)

        yield show


class Target:
    """A file to be written later, tried now. It appears whole or not at all: written beside, then renamed."""

    def __init__(self, flag: str, text: str, may_be_stdout: bool = False, ending: str = ""):
        self.flag, self.text = flag, text
        self.is_stdout = may_be_stdout and text == "-"
        self.path = "" if self.is_stdout else _real_path(text)
        if not text.strip():
            raise BadInput(flag, text, f"give a file{' or - for standard output' if may_be_stdout else ''}")
        if not text.lower().endswith(ending):
            raise BadInput(flag, text, f"give a file that ends in {ending}")
        if not self.is_stdout:
            try:
                self._try()
            except OSError as error:
                raise BadInput(flag, text, f"cannot be written: {_why(error)}; "
                               "give a file in a directory that exists and may be written to") from None

    def write(self, content: bytes) -> None:
        """Write the content, replacing what was there."""
        if self.is_stdout:
            sys.stdout.flush()
            sys.stdout.buffer.write(content)
            sys.stdout.buffer.flush()
        elif _is_device(self.path):
            with open(self.path, "wb") as file:
                file.write(content)
        else:
            self._replace(content)

    def _try(self) -> None:
        if _is_device(self.path):
            return
        with contextlib.suppress(FileNotFoundError):
            os.stat(self.path)  # a name that no file can have fails here and not after the run
        if os.path.isdir(self.path) or self.text.endswith(os.sep):
            raise IsADirectoryError("is a directory")
        with open(self._beside(), "wb"):
            pass
        os.remove(self._beside())

    def _replace(self, content: bytes) -> None:
        try:
            with open(self._beside(), "wb") as file:
                file.write(content)
            os.replace(self._beside(), self.path)
        finally:
            with contextlib.suppress(OSError):
                os.remove(self._beside())

    def _beside(self) -> str:
        return os.path.join(os.path.dirname(self.path), f".mpm-lab-{self.flag}-{os.getpid()}.part")


def json_target(text: str | None) -> Target | None:
    """Where ``--json`` goes, tried now; None if it was not given."""
    return None if text is None else Target("json", text, may_be_stdout=True)


def report(values: dict, target: Target | None, text: Callable[[dict], str]) -> None:
    """A result as JSON where a file was asked for, else as ``text`` makes it, on standard output."""
    if target:
        target.write(json_text(values, lines=not target.is_stdout).encode())
    else:
        print(text(values), flush=True)


def _real_path(text: str) -> str:
    """Where a file really lies, so that a link stays one; a device has no better name than its own."""
    return text if _is_device(text) else os.path.realpath(text)


def _is_device(path: str) -> bool:
    """A pipe, a terminal or the like, which must be written to and not replaced."""
    try:
        mode = os.stat(path).st_mode
    except OSError:
        return False
    return not stat.S_ISREG(mode) and not stat.S_ISDIR(mode)


def _why(error: OSError) -> str:
    return (error.strerror or str(error)).lower()


class ProgressBar:
    """A bar on a terminal for runs that take longer than a second; nothing elsewhere."""

    WIDTH = 30
    WHAT = 24  # characters of what is being done; the whole line fits a terminal of 80
    PATIENCE = 1.0  # seconds

    def __init__(self, stream: TextIO, quiet: bool):
        self._stream, self._begun, self._drawn = stream, time.monotonic(), False
        self._on = not quiet and stream.isatty()

    def show(self, part: float, what: str = "") -> None:
        """Draw the bar at ``part``, 0 to 1, and what is being done."""
        elapsed = time.monotonic() - self._begun
        if not self._on or elapsed < self.PATIENCE:
            return
        self._drawn = True
        left = f"{elapsed * (1 - part) / part:.0f} s left" if part > 0 else ""
        full = round(part * self.WIDTH)
        bar = "#" * full + "." * (self.WIDTH - full)
        self._stream.write(f"\r[{bar}] {100 * part:3.0f} %  {left:<14}{what:<{self.WHAT}.{self.WHAT}}")
        self._stream.flush()

    def close(self) -> None:
        """Wipe the bar off the line."""
        if self._drawn:
            self._stream.write("\r" + " " * (self.WIDTH + 24 + self.WHAT) + "\r")
            self._stream.flush()
