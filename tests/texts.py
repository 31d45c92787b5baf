"""What the project's texts tell a reader to type: command lines, lines of Python, and names of files."""

from __future__ import annotations

import functools
import re
import shlex
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from pathlib import Path

from markdown_it import MarkdownIt
from markdown_it.token import Token

from tests.support.paths import ASSETS, LESSONS, ROOT

#: What stands for something of the reader's, and an example of it.
PLACES = {"FILE": "file", "FILES": "file", "DIR": "folder", "NN": "04", "NAME": "04", "LESSON": "04", "N": "3",
          "TEXT": "bar;cells=40", "SCENE": "bar cells=40", "EPS": "1e-3", "PROBLEM": "bar", "COMMAND": "bench"}
PLACE = re.compile(r"\b[A-Z]{1,7}\b")
ALTERNATIVES = re.compile(r"\{([^{}]+\|[^{}]+)\}")
SHELL = ("", "sh", "shell", "bash", "console")
PYTHON = ("from ", "import ")
OURS = ("app", "solvers", "tests", "lessons", "assets")
COMMAND = re.compile(r"(\w+=\S+\s+)*(mpm-lab|uv|python3?|pytest)(\s|$)")
PATH = re.compile(rf"(?:{'|'.join(OURS)})/[\w./-]*\w/?")


@dataclass(frozen=True)
class Piece:
    """Something to type, and where it stands."""

    page: str
    line: int
    text: str

    def __str__(self) -> str:
        return f"{self.page}:{self.line}: {self.text}"


def pages() -> list[Path]:
    """Every text but the history, which tells of what has been, and those that a command writes."""
    return [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / ".github").rglob("*.md")),
            *sorted(ASSETS.glob("*.md")), *sorted((ASSETS / "site").glob("*.md")), *sorted(LESSONS.rglob("*.md"))]


@functools.cache
def _tokens(path: Path) -> list[Token]:
    found = []
    for token in MarkdownIt("commonmark").enable("table").parse(path.read_text(encoding="utf-8")):
        for child in token.children or ():
            child.map = token.map
        found += [token, *(token.children or ())]
    return found


def blocks() -> Iterator[tuple[str, Piece]]:
    """Blocks of code, each with the language that stands above it."""
    for path in pages():
        for token in _tokens(path):
            if token.type in ("fence", "code_block"):
                yield token.info.strip(), Piece(str(path.relative_to(ROOT)), token.map[0] + 1, token.content)


def command_lines() -> Iterator[Piece]:
    """A line for each command in a block, without the prompt, that begins with one of ours."""
    for language, block in blocks():
        if language in SHELL and not block.text.startswith(PYTHON):
            for number, line in enumerate(block.text.replace("\\\n", "  ").splitlines(), block.line):
                for command in re.split(r"\s&&\s", line.strip().removeprefix("$ ")):
                    if COMMAND.match(command):
                        yield Piece(block.page, number, command)


def spans() -> Iterator[Piece]:
    """What stands as code within a line."""
    for path in pages():
        for token in _tokens(path):
            if token.type == "code_inline":
                yield Piece(str(path.relative_to(ROOT)), token.map[0] + 1, token.content)


def links() -> Iterator[Piece]:
    """Where links and pictures lead."""
    for path in pages():
        for token in _tokens(path):
            if target := token.attrGet({"link_open": "href", "image": "src"}.get(token.type, "")):
                yield Piece(str(path.relative_to(ROOT)), (token.map or [0])[0] + 1, str(target))


def python_blocks() -> Iterator[Piece]:
    """Blocks of Python: by their language, or by an import at their beginning."""
    yield from (block for language, block in blocks()
                if language == "python" or (not language and block.text.startswith(PYTHON)))


def words(text: str) -> list[str]:
    """A command line as its words, as a shell has them, up to where it sends what is printed."""
    found = shlex.split(text, comments=True)
    return found[:next((k for k, word in enumerate(found) if word in (">", ">>", "|")), None)]


def examples(text: str) -> Iterator[str]:
    """What a line that leaves something open may become: ``{bar|ring} --out DIR``, ``FILES...``, ``[--teacher]``."""
    text = re.sub(r"\[([^][]*)\]", r"\1", text).replace("...", "")
    parts = ALTERNATIVES.split(text)
    choices = [part.split("|") if k % 2 else [part] for k, part in enumerate(parts)]
    for chosen in product(*choices):
        yield PLACE.sub(lambda place: shlex.quote(PLACES.get(place[0], place[0])), "".join(chosen))


def paths() -> Iterator[Piece]:
    """Names of files and folders of the repository, in spans and in blocks that are no Python."""
    for piece in (*spans(), *(block for language, block in blocks() if language in SHELL)):
        for name in PATH.findall(piece.text.replace("NN-name", "NAME")):
            yield Piece(piece.page, piece.line, name)
