"""The text of ``--help``: all commands, or the flags of one with an example, as wide as the terminal."""

import inspect
import io
import os
import re
import shutil
import sys
import textwrap

from app.commands import DEFAULT_COMMAND, commands
from app.commands.progress import wants_colour

PROGRAM = "mpm-lab"
WIDEST = 100  # characters of a line
VERBOSE = "--verbose"
EVERYWHERE = f"With any command {VERBOSE} shows where in the code something failed."


class PrintCapture(io.StringIO):
    """Text stream that captures what is printed, with colours if standard output would have them."""

    encoding = sys.stdout.encoding

    def __init__(self) -> None:
        super().__init__()
        self._coloured = wants_colour(os.environ, sys.stdout.isatty())

    def isatty(self) -> bool:
        return self._coloured


def help_paragraphs(kind: type) -> list[str]:
    """Returns the paragraphs of a command class's help, each on one line: summary, details, exit statuses."""
    first, _, rest = (inspect.getdoc(kind) or "").partition("\n\n")
    more, found, statuses = rest.partition("Exit status:")
    return [" ".join(part.split()) for part in (first, *more.split("\n\n"), found + statuses) if part.strip()]


def wrap_help(text: str, kind: type) -> str:
    """Returns tyro's help for a command class with wrapped paragraphs, the example, and what every command has."""
    usage, _, rest = text.partition("\n")
    if len(usage) > _width():  # wrapped without separating flags from their values
        together = re.sub(r"\[[^]]*\]", lambda flag: flag[0].replace(" ", "\0"), usage)
        usage = textwrap.fill(together, _width(), subsequent_indent=" " * 4, break_long_words=False,
                              break_on_hyphens=False).replace("\0", " ")
    text = f"{usage}\n{rest}"
    for part in help_paragraphs(kind):
        text = text.replace(part, textwrap.fill(part, _width()))
    return f"{text}\nExample:  {kind.EXAMPLE}\n\n{EVERYWHERE}\n"  # type: ignore[attr-defined]


def commands_overview(name: tuple[str, ...]) -> str:
    """Returns the help for all commands whose names begin with these words: their names and summaries."""
    program = " ".join((PROGRAM, *name))
    rows = {" ".join((PROGRAM, *known)): (inspect.getdoc(kind) or "").partition("\n")[0]
            for known, kind in commands().items() if known[:len(name)] == name}
    margin = max(map(len, rows)) + 4
    lines = [textwrap.fill(what, max(_width(), margin + 30), initial_indent=f"  {command}".ljust(margin),
                           subsequent_indent=" " * margin) for command, what in rows.items()]
    about = [] if name else ["A numerical laboratory for error estimates of the material point method.", ""]
    more = [] if name else [f"Without a command: {' '.join((PROGRAM, *DEFAULT_COMMAND))}.",
                            f"{PROGRAM} --version prints the version; {PROGRAM} --completion SHELL a script that "
                            "completes", "commands and flags in bash, zsh or fish."]
    return "\n".join([f"usage: {program} COMMAND [flags]", "", *about, *lines, "",
                      f"{program} COMMAND --help explains the flags of a command.", *more, EVERYWHERE])


def _width() -> int:
    return min(WIDEST, shutil.get_terminal_size().columns)
