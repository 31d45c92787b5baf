"""Where results go: checked and atomic files, a clean standard output, messages and a progress bar."""

import contextlib
import ctypes
import json
import os
import signal
import sys
import threading
import time
import warnings
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from app.commands.flags import BadInput
from solvers.outside import quoting

BAR_WIDTH = 30  # of the progress bar in characters
BAR_TEXT = 24  # of what is being done; the whole line fits a terminal of 80
LONGEST_LINE = 1000  # letters; refusals have less
PATIENCE = 1.0  # seconds before a bar is worth showing


def say(message: object) -> None:
    """One line on standard error, of which no character does anything to a terminal."""
    print(f"mpm-lab: {quoting.sentence(message, LONGEST_LINE)}", file=sys.stderr, flush=True)


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
    """While solvers work: a clean standard output, Ctrl-C noted, and, unless ``quiet``, a progress bar on a terminal.

    Yields what is to be called now and then with the part done, 0 to 1, and, if one likes, what is being done.
    """
    begun, drawn = time.monotonic(), False

    def show(part: float, what: str = "") -> None:
        nonlocal drawn
        check()
        elapsed = time.monotonic() - begun
        if quiet or elapsed < PATIENCE or not sys.stderr.isatty():
            return
        drawn = True
        left = f"{elapsed * (1 - part) / part:.0f} s left" if part > 0 else ""
        bar = ("#" * round(part * BAR_WIDTH)).ljust(BAR_WIDTH, ".")
        line = f"\r[{bar}] {100 * part:3.0f} %  {left:<14}{what:<{BAR_TEXT}.{BAR_TEXT}}"
        print(line, end="", file=sys.stderr, flush=True)

    with stdout_to_stderr(), noted_interrupts() as check:
        warnings.simplefilter("ignore", SyntaxWarning)  # Taichi's source, on its first import by Python 3.12 on
        try:
            yield show
        finally:
            if drawn:  # wipe the bar off the line
                print("\r" + " " * (BAR_WIDTH + 24 + BAR_TEXT) + "\r", end="", file=sys.stderr, flush=True)


class Target:
    """A file to be written later, tried now. It appears whole or not at all: written beside, then renamed."""

    def __init__(self, flag: str, text: str, may_be_stdout: bool = False, ending: str = ""):
        self.text, self.is_stdout = text, may_be_stdout and text == "-"
        # where it really lies, so that a link stays one; a device has no better name than its own
        self.path = "" if self.is_stdout or "\0" in text else text if _is_device(text) else os.path.realpath(text)
        self._beside = Path(os.path.dirname(self.path), f".mpm-lab-{flag}-{os.getpid()}.part")
        if not text.strip():
            raise BadInput(flag, text, f"give a file{' or - for standard output' if may_be_stdout else ''}")
        if not text.lower().endswith(ending):
            raise BadInput(flag, text, f"give a file that ends in {ending}")
        try:
            self._try()
        except (OSError, ValueError) as error:  # a character that no name can have is the latter
            why = getattr(error, "strerror", None) or str(error)
            raise BadInput(flag, text, f"cannot be written: {why.lower()}; "
                           "give a file in a directory that exists and may be written to") from None

    def write(self, content: bytes) -> None:
        """Write the content, replacing what was there."""
        if self.is_stdout:
            sys.stdout.flush()
            sys.stdout.buffer.write(content)
            sys.stdout.buffer.flush()
        elif _is_device(self.path):
            Path(self.path).write_bytes(content)
        else:
            try:
                self._beside.write_bytes(content)
                os.replace(self._beside, self.path)
            finally:
                with contextlib.suppress(OSError):
                    self._beside.unlink()

    def _try(self) -> None:
        if self.is_stdout or _is_device(self.path):
            return
        with contextlib.suppress(FileNotFoundError):
            os.stat(self.path)  # a name that no file can have fails here and not after the run
        if os.path.isdir(self.path) or self.text.endswith(os.sep):
            raise IsADirectoryError("is a directory")
        self._beside.write_bytes(b"")
        self._beside.unlink()


def json_target(text: str | None) -> Target | None:
    """Where ``--json`` goes, tried now; None if it was not given."""
    return None if text is None else Target("json", text, may_be_stdout=True)


def put_result(values: dict, target: Target | None, text: Callable[[dict], str]) -> None:
    """A result as JSON where a file was asked for, else as ``text`` makes it, on standard output."""
    put_text(json_text(values, lines=not target.is_stdout) if target else text(values) + "\n", target)


def put_text(text: str, target: Target | None, encoding: str = "utf-8") -> None:
    """A text to a file where one was asked for, else to standard output."""
    if target:
        target.write(text.encode(encoding))
    else:
        print(text, end="", flush=True)


def _is_device(path: str) -> bool:
    """A pipe, a terminal or the like, which must be written to and not replaced."""
    return os.path.exists(path) and not os.path.isfile(path) and not os.path.isdir(path)


def made_directory(path: str, typed: str) -> list[str]:
    """Make a directory, and those above it, of what was ``typed`` after ``--out``; what is in it already."""
    try:
        os.makedirs(path, exist_ok=True)
        return os.listdir(path)
    except (OSError, ValueError) as error:  # a character that no name can have is the latter
        why = (getattr(error, "strerror", None) or str(error)).lower()
        raise BadInput("out", typed, f"cannot be a directory: {why}; give one that exists or can be made and may be "
                                     "written to") from None


class Folder:
    """The directory after ``--out``, made and tried now: new or empty, so that nothing of anybody's is overwritten."""

    def __init__(self, text: str | None):
        self.text = (text or "").strip()
        if not self.text:
            raise BadInput("out", "", "give a directory for the files")
        self.path = Path(self.text)
        if made_directory(self.text, self.text):
            raise BadInput("out", self.text, "is not empty; give an empty or a new directory")
        Target("out", str(self.path / "try"))  # says now what would fail later

    def put(self, name: str, content: bytes) -> None:
        """Write a file into the directory, whole or not at all."""
        Target("out", str(self.path / name)).write(content)


def draw(figures: Mapping[str, Callable[[Any], Any]], values: Any, put: Callable[[str, bytes], None], out: str,
         rest: str) -> tuple[list[str], int]:
    """Draw ``values`` in every way and put the pictures into ``out``, but where a figure is None; one that fails costs
    nothing else, ``rest``. The files' names, and the exit status."""
    from app.pictures.run import png_bytes

    drawn, status = [], 0
    for name, figure in figures.items():
        try:
            if (picture := figure(values)) is not None:
                put(f"{name}.png", png_bytes(picture))
                drawn.append(f"{name}.png")
        except Exception as error:
            say(f"--out {out}: the picture {name} failed ({type(error).__name__}: {error}); {rest}")
            status = 1
    return drawn, status
