"""Output of results and messages: checked and atomic files, standard output, one line on standard error."""

import contextlib
import json
import logging
import os
import sys
import traceback
from collections.abc import Callable, Iterator, Mapping
from html import escape
from pathlib import Path
from typing import Any

from app.commands.lenient_flag_types import BadInput
from app.lessons.markdown_html import to_html
from app.templates import render_template
from solvers.untrusted import quoting

LONGEST_LINE = 1000  # letters; refusals have less
STDOUT = "standard output"
REPORT = Path(__file__).parent / "report.html"
_places = False  # whether reported failures have tracebacks


class NotWritten(Exception):
    """Raised if a result could not be written; ``where`` is a flag with its value, or "standard output"."""

    def __init__(self, where: str, error: OSError):
        super().__init__(f"{where} could not be written: {(error.strerror or str(error)).lower()}")


@contextlib.contextmanager
def show_tracebacks(wanted: bool) -> Iterator[None]:
    """Context manager: adds tracebacks to failures printed or logged within the block, if ``wanted``."""
    global _places
    _places, before = wanted, _places
    log = logging.getLogger("app")
    level = log.level
    if wanted:
        log.setLevel(logging.DEBUG)
    try:
        yield
    finally:
        _places = before
        log.setLevel(level)


def print_message(message: object) -> None:
    """Prints a message as one printable line on standard error, with ``--verbose`` after the traceback."""
    places = traceback.format_exc().splitlines() if _places and sys.exc_info()[1] else []
    with contextlib.suppress(OSError):  # if standard error fails, the exit status remains
        for line in places:
            print("".join(letter if letter.isprintable() else "?" for letter in line), file=sys.stderr)
        print(f"mpm-lab: {quoting.one_line(message, LONGEST_LINE)}", file=sys.stderr, flush=True)


def json_text(values: dict, lines: bool = False) -> str:
    """Returns values as JSON, on one line, or on many if ``lines``; raises ValueError for NaN and infinity."""
    return json.dumps(values, allow_nan=False, indent=2 if lines else None) + "\n"


class OutputTarget:
    """File that a flag names (``text``; "-" is standard output if ``may_be_stdout``), to be written later, checked now.

    Raises BadInput, also without the ``ending``. It appears complete or not at all: written beside, then renamed."""

    def __init__(self, flag: str, text: str, may_be_stdout: bool = False, ending: str = ""):
        self.flag, self.text, self.is_stdout = flag, text, may_be_stdout and text == "-"
        # resolved, so that a link stays one; devices keep their names
        self.path = "" if self.is_stdout or "\0" in text else text if _is_device(text) else os.path.realpath(text)
        self._beside = Path(os.path.dirname(self.path), f".mpm-lab-{flag}-{os.getpid()}.part")
        if not text.strip():
            raise BadInput(flag, text, f"give a file{' or - for standard output' if may_be_stdout else ''}")
        if not text.lower().endswith(ending):
            raise BadInput(flag, text, f"give a file that ends in {ending}")
        try:
            self._check_writable()
        except (OSError, ValueError) as error:  # ValueError: a character invalid in names
            why = getattr(error, "strerror", None) or str(error)
            raise BadInput(flag, text, f"cannot be written: {why.lower()}; "
                           "give a file in a directory that exists and may be written to") from None

    def write(self, content: bytes) -> None:
        """Writes the content, replacing what was there; raises :class:`NotWritten`."""
        with report_write_errors(STDOUT if self.is_stdout else f"--{self.flag} {quoting.quote(self.text)}"):
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

    def _check_writable(self) -> None:
        if self.is_stdout or _is_device(self.path):
            return
        with contextlib.suppress(FileNotFoundError):
            os.stat(self.path)  # an invalid name fails here and not after the run
        if os.path.isdir(self.path) or self.text.endswith(os.sep):
            raise IsADirectoryError("is a directory")
        self._beside.write_bytes(b"")
        self._beside.unlink()


def json_target(text: str | None) -> OutputTarget | None:
    """Returns the target for the value of ``--json``, which may be -, checked now; None if it was not given."""
    return None if text is None else OutputTarget("json", text, may_be_stdout=True)


def json_and_plot_targets(json: str | None, plot: str | None) -> tuple[OutputTarget | None, OutputTarget | None]:
    """Returns the targets for the values of ``--json`` and of ``--plot``, a .png; None for what was not given."""
    target = json_target(json)
    picture = None if plot is None else OutputTarget("plot", plot, ending=".png")
    if target and picture and target.path == picture.path:
        raise BadInput("plot", picture.text, "is the file of --json too; give each its own")
    return target, picture


def put_result(values: dict, target: OutputTarget | None, text: Callable[[dict], str]) -> None:
    """Writes a result as JSON to the target if there is one, else what ``text`` makes of it to standard output."""
    put_text(json_text(values, lines=not target.is_stdout) if target else text(values) + "\n", target)


def put_text(text: str, target: OutputTarget | None = None, encoding: str = "utf-8") -> None:
    """Writes a text to the target if there is one, else to standard output; raises :class:`NotWritten`."""
    if target:
        target.write(text.encode(encoding))
    else:
        with report_write_errors(STDOUT):
            print(text, end="", flush=True)


@contextlib.contextmanager
def report_write_errors(where: str) -> Iterator[None]:
    """Context manager: raises :class:`NotWritten` for write errors in the block, except a broken pipe."""
    try:
        yield
    except BrokenPipeError:
        raise
    except OSError as error:
        raise NotWritten(where, error) from error


def _is_device(path: str) -> bool:
    """Whether a path is a pipe, a terminal or the like, which must be written to and not replaced."""
    return os.path.exists(path) and not os.path.isfile(path) and not os.path.isdir(path)


class OutputFolder:
    """Directory ``text`` of --out, checked now (raises BadInput): it must be new or empty. One that is not there is
    created with its first file, so that a command which ends before leaves none."""

    def __init__(self, text: str | None):
        self.text = (text or "").strip()
        if not self.text:
            raise BadInput("out", "", "give a directory for the files")
        self.path = Path(self.text)
        try:
            missing = [folder for folder in (self.path, *self.path.parents) if not folder.exists()]
            os.makedirs(self.text, exist_ok=True)
            there = os.listdir(self.text)
        except (OSError, ValueError) as error:  # ValueError: a character invalid in names
            why = (getattr(error, "strerror", None) or str(error)).lower()
            raise BadInput("out", self.text, f"cannot be a directory: {why}; give one that exists or can be made and "
                                             "may be written to") from None
        if there:
            raise BadInput("out", self.text, "is not empty; give an empty or a new directory")
        OutputTarget("out", str(self.path / "try"))  # fails now instead of later
        for folder in missing:
            with contextlib.suppress(OSError):  # somebody else's by now
                folder.rmdir()

    def write_file(self, name: str, content: bytes) -> None:
        """Writes a file into the directory, completely or not at all; raises :class:`NotWritten`."""
        with report_write_errors(f"--out {quoting.quote(self.text)}"):
            os.makedirs(self.text, exist_ok=True)
        OutputTarget("out", str(self.path / name)).write(content)


def draw_pictures(figures: Mapping[str, Callable[[Any], Any]], values: Any, put: Callable[[str, bytes], None], out: str,
                  rest: str) -> tuple[list[str], int]:
    """Draws ``values`` by every function of ``figures`` and writes NAME.png by ``put(name, bytes)``; returns the names
    of the files and the exit status, 1 if one failed, for which a message names ``out`` and ends in ``rest``."""
    from app.pictures.run_errors import png_bytes
    drawn, status = [], 0
    for name, figure in figures.items():
        try:
            if (picture := figure(values)) is not None:
                put(f"{name}.png", png_bytes(picture))
                drawn.append(f"{name}.png")
        except Exception as error:
            print_message(f"--out {out}: the picture {name} failed ({type(error).__name__}: {error}); {rest}")
            status = 1
    return drawn, status


def as_html(text: str, folder: Path) -> str:
    """Returns a Markdown report as one HTML page with its pictures, which are in the folder, embedded."""
    title = escape(text.partition("\n")[0].lstrip("# "))
    body = to_html(text, folder)  # tables wider than the screen scroll
    body = body.replace("<table>", '<div class="wide" tabindex="0"><table>').replace("</table>", "</table></div>")
    return render_template(REPORT, title=title, body=body)


def put_report(folder: OutputFolder, values: dict, pictured: Any, figures: Mapping[str, Callable[[Any], Any]],
               markdown: Callable[[list[str]], str]) -> int:
    """Writes pictures of ``pictured`` by ``figures`` (:func:`draw_pictures`), and the report: ``values`` as JSON, the
    text that ``markdown`` makes for these pictures' names as Markdown and HTML. Returns the exit status."""
    drawn, status = draw_pictures(figures, pictured, folder.write_file, folder.text, "the rest is fine")
    text = markdown(drawn)
    folder.write_file("report.json", json_text(values, lines=True).encode())
    folder.write_file("report.md", text.encode())
    folder.write_file("report.html", as_html(text, folder.path).encode())
    return status
