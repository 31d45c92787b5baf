"""The parts of a lesson's file, or of a page for a class: a head in TOML between two lines ``+++``, and what stands
under each heading ``## ...``, with its fenced blocks apart."""

from collections.abc import Sequence
from dataclasses import dataclass

from app.lessons.lesson import LessonError
from solvers.outside import quoting

FENCE = "```"
HEAD = "+++"
BLOCKS = ("run", "question", "claims", "teacher", "bets")


@dataclass
class Part:
    """What stands under a heading, or before the first: lines of Markdown, and blocks (kind, text, line)."""

    heading: str
    line: int
    text: list[str]
    blocks: list[tuple[str, str, int]]


def split_head(text: str) -> tuple[str, list[str], int]:
    """The head, the lines after it, and the number of the first of those."""
    lines = text.splitlines()
    if not lines or lines[0].strip() != HEAD:
        raise LessonError(1, f"the file must begin with a head: a line {HEAD}, TOML such as title = \"...\", and a "
                             f"line {HEAD}")
    end = next((k for k, line in enumerate(lines[1:], 1) if line.strip() == HEAD), None)
    if end is None:
        raise LessonError(1, f"the head does not end; close it with a line {HEAD}")
    return "\n".join(lines[1:end]), lines[end + 1:], end + 2


def parts_of(lines: list[str], first: int) -> list[Part]:
    """What stands before the first heading, and under each."""
    parts, block, opened = [Part("", first, [], [])], None, 0
    for number, line in enumerate(lines, first):
        fence = line.strip()
        if block is not None:
            if fence == FENCE:
                parts[-1].blocks.append((block, "\n".join(lines[opened - first + 1:number - first]), opened + 1))
                block = None
        elif fence.startswith(FENCE):
            block, opened = fence[len(FENCE):].strip(), number
            if block not in BLOCKS:
                raise LessonError(number, f"a block '{quoting.quoted(block)}' is not known; give "
                                          f"{', '.join(BLOCKS)} after {FENCE}")
        elif line.startswith("## "):
            parts.append(Part(line, number, [], []))
        else:
            parts[-1].text.append(line)
    if block is not None:
        raise LessonError(opened, f"the block {block} does not end; close it with a line {FENCE}")
    return parts


def notes_of(part: Part) -> str:
    """The teacher's notes in it, as Markdown."""
    return "\n\n".join(text for kind, text, _ in part.blocks if kind == "teacher")


def numbered(part: Part) -> Sequence[tuple[int, str]]:
    """Lines of Markdown with their numbers in the file. Blocks between them are left out of the count on purpose."""
    inside = [k for _, text, line in part.blocks for k in range(line - 1, line + len(text.splitlines()) + 1)]
    numbers = (k for k in range(part.line + bool(part.heading), 10**9) if k not in inside)
    return list(zip(numbers, part.text, strict=False))
