"""Parser of a lesson's Markdown file. Errors give the line and what is expected.

The file begins with a head in TOML between two lines ``+++``. Each heading with ``Predict:``, ``Run:``, ``Observe:`` or
``Explain:`` begins a step; fenced blocks in it, named after their first line, are the scenes of a ``run``, the
``question``, the ``claims`` and the ``teacher``'s notes. ``lessons/README.md`` explains it."""

import functools
import hashlib
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeVar

from app.lessons import claims, duration, fenced_blocks, interval_bets, prediction_rounds_and_core
from app.lessons.lesson import ALLOWED, CONTROLS, KINDS, NEEDED, PLACE, Lesson, LessonError, Numbers, Step, fill_numbers
from app.lessons.markdown_html import RenderError, to_html
from solvers.untrusted import quoting

FENCE = "```"
HEAD = "+++"
BLOCKS = ("run", "question", "claims", "teacher", "bets")


@dataclass
class LessonSection:
    """Section under a heading, or "" before the first: lines of Markdown, and blocks (kind, text, line of the text)."""

    heading: str
    line: int
    text: list[str]
    blocks: list[tuple[str, str, int]]


def split_head(text: str) -> tuple[str, list[str], int]:
    """Splits a file's text into its TOML head, the lines after it, and the number of the first of those lines."""
    lines = text.splitlines()
    if not lines or lines[0].strip() != HEAD:
        raise LessonError(1, f"the file must begin with a head: a line {HEAD}, TOML such as title = \"...\", and a "
                             f"line {HEAD}")
    end = next((k for k, line in enumerate(lines[1:], 1) if line.strip() == HEAD), None)
    if end is None:
        raise LessonError(1, f"the head does not end; close it with a line {HEAD}")
    return "\n".join(lines[1:end]), lines[end + 1:], end + 2


def split_sections(lines: list[str], first: int) -> list[LessonSection]:
    """Splits lines, the first of which has the number ``first``, into the sections before the first ## heading and
    under each. Raises :class:`LessonError` for an unknown or unfinished block."""
    parts, block, opened = [LessonSection("", first, [], [])], None, 0
    for number, line in enumerate(lines, first):
        fence = line.strip()
        if block is not None:
            if fence == FENCE:
                parts[-1].blocks.append((block, "\n".join(lines[opened - first + 1:number - first]), opened + 1))
                block = None
        elif fence.startswith(FENCE):
            block, opened = fence[len(FENCE):].strip(), number
            if block not in BLOCKS:
                raise LessonError(number, f"a block '{quoting.quote(block)}' is not known; give "
                                          f"{', '.join(BLOCKS)} after {FENCE}")
        elif line.startswith("## "):
            parts.append(LessonSection(line, number, [], []))
        else:
            parts[-1].text.append(line)
    if block is not None:
        raise LessonError(opened, f"the block {block} does not end; close it with a line {FENCE}")
    return parts


def teacher_notes(part: LessonSection) -> str:
    """Returns the teacher's notes in a section, as Markdown, or ""."""
    return "\n\n".join(text for kind, text, _ in part.blocks if kind == "teacher")


def number_lines(part: LessonSection) -> Sequence[tuple[int, str]]:
    """Returns a section's lines of Markdown with their numbers in the file, without heading and fenced blocks."""
    inside = [k for _, text, line in part.blocks for k in range(line - 1, line + len(text.splitlines()) + 1)]
    numbers = (k for k in range(part.line + bool(part.heading), 10**9) if k not in inside)
    return list(zip(numbers, part.text, strict=False))


Found = TypeVar("Found")
LARGEST = 1_000_000  # bytes of a lesson
HEAD_KEYS = ("title", "goals", "controls", "prerequisites", "variants")
FORMULA = re.compile(r"\$\$.*?(?:\$\$|$)|\$[^$]*\$|^.*\$\$\s*$")  # or a formula's part on one line
HEADING = re.compile(r"##\s+(?P<kind>[^:(]+?)\s*(?P<core>\(core\))?\s*:\s*(?P<title>\S.*)")


def read_lesson(path: Path) -> Lesson:
    """Reads the lesson of a file; raises :class:`LessonError` if it is invalid."""
    return parse_file(path, lambda text: parse_lesson(text, path.stem, path.parent))


def parse_file(path: Path, parsed: Callable[[str], Found]) -> Found:
    """Returns ``parsed(text)`` of a UTF-8 file. A :class:`LessonError`, also of an unreadable file, names the file."""
    try:
        if path.stat().st_size > LARGEST:
            raise LessonError(1, f"the file has more than {LARGEST:,} bytes; make it shorter")
        return parsed(path.read_text(encoding="utf-8-sig"))  # some editors put a mark in front
    except LessonError as error:
        raise LessonError(error.line, error.sentence, path.name) from None
    except OSError as error:
        why = (error.strerror or str(error)).lower()
        raise LessonError(1, f"the file cannot be read: {why}; give one that may be", path.name) from None
    except UnicodeDecodeError as error:
        line = path.read_bytes()[:error.start].count(b"\n") + 1
        raise LessonError(line, "holds characters that are not UTF-8; save the file as UTF-8", path.name) from None


def parse_lesson(text: str, name: str, folder: Path | None = None) -> Lesson:
    """Parses and checks a lesson's Markdown; pictures are looked up in ``folder``. Raises :class:`LessonError`."""
    head, body, first = split_head(text)
    lesson = _parse_lesson_head(head, name, hashlib.sha256(text.encode()).hexdigest()[:16])
    opening, *parts = split_sections(body, first)
    lesson = replace(lesson, intro="\n".join(opening.text), notes=teacher_notes(opening))
    if forbidden := [block for block in opening.blocks if block[0] != "teacher"]:
        raise LessonError(forbidden[0][2] - 1, f"a {forbidden[0][0]} block before the first step; put it under a "
                                               "heading such as ## Run: A first look")
    if not parts:
        raise LessonError(first, "no step: give headings such as ## Predict: What will happen?")
    lesson = replace(lesson,
                     steps=prediction_rounds_and_core.mark_core_rounds([_parse_step(part, lesson) for part in parts]))
    check_unique_names(lesson)
    check_claims(lesson)
    prediction_rounds_and_core.check_core_self_contained(lesson)
    _check_bets(lesson)
    for part in (opening, *parts):
        _check_text(part, lesson, folder)
    return duration.with_minutes(lesson)


def _parse_lesson_head(head: str, name: str, fingerprint: str) -> Lesson:
    values = fenced_blocks.parse_toml(head, 2)  # after the line that begins it
    at = functools.partial(fenced_blocks.line_of_key, text=head, line=2)
    for key in values:
        if key == "minutes":
            raise LessonError(at(key), "minutes are computed from what the lesson holds; leave the key out")
        if key not in HEAD_KEYS:
            raise LessonError(at(key), f"{key} is not known in a head; give {', '.join(HEAD_KEYS)}")
    title = fenced_blocks.require_value(values, "title", str, "give a text", at("title"))
    goals = fenced_blocks.require_texts(values, "goals", at("goals"))
    if not goals:
        raise LessonError(at("goals"), "goals are missing: give a list of what a student can do afterwards")
    controls = fenced_blocks.require_texts(values, "controls", at("controls"))
    for control in controls:
        if control not in CONTROLS:
            raise LessonError(at("controls"), f"controls: '{quoting.quote(control)}' is not known; give "
                                              f"{', '.join(CONTROLS)}")
    return Lesson(name, title.strip(), goals, controls,
                  fenced_blocks.require_texts(values, "prerequisites", at("prerequisites")),
                  _parse_variants(values, at("variants")), fingerprint=fingerprint)


def _parse_variants(values: Mapping[str, Any], line: int) -> tuple[Numbers, ...]:
    found = values.get("variants", [{}])
    expected = "give tables [[variants]] that set the same names to numbers or words"
    if not isinstance(found, list) or not found or not all(isinstance(one, dict) for one in found):
        raise LessonError(line, f"variants: {expected}")
    for one in found:
        fits = all(isinstance(value, (int, float, str)) and PLACE.fullmatch(f"{{{key}}}") for key, value in one.items())
        if not fits or one.keys() != found[0].keys():
            raise LessonError(line, f"variants: {one} is not like {found[0]}; {expected}")
    return tuple(found)


def _parse_step(part: LessonSection, lesson: Lesson) -> Step:
    kind, title, core = _parse_step_heading(part)
    seen: set[str] = set()
    for name, _, line in part.blocks:
        if name not in ALLOWED[kind]:
            raise LessonError(line - 1, f"a step that begins with {kind.capitalize()} has no {name} block; it may have "
                                        f"{', '.join(ALLOWED[kind])}")
        if name in seen and name != "teacher":
            raise LessonError(line - 1, f"a second {name} block in one step; put both into one, or begin a step")
        seen.add(name)
    if kind in NEEDED and NEEDED[kind] not in seen:
        raise LessonError(part.line, f"a step that begins with {kind.capitalize()} needs a {NEEDED[kind]} block")
    key = re.sub(r"[^a-z0-9]+", "-", title.lower()).strip("-")[:60] or "step"
    step = Step(kind, title, key, part.line, "\n".join(part.text).strip(), teacher_notes(part), core=core)
    for name, text, line in part.blocks:
        if name == "run":
            found, stage, shown = fenced_blocks.parse_runs_and_stage(text, line, lesson.variants)
            step = replace(step, runs=found, stage=stage, shown_phase=shown)
        elif name == "question":
            step = replace(step, question=fenced_blocks.parse_question(text, line))
        elif name == "claims":
            step = replace(step, claims=fenced_blocks.parse_claims(text, line))
        elif name == "bets":
            step = replace(step, bets=fenced_blocks.parse_bettors(text, line))
    return step


def _parse_step_heading(part: LessonSection) -> tuple[str, str, bool]:
    """Returns kind, title, and whether "(core)", of a heading such as "## Predict (core): ..."; raises LessonError."""
    found = HEADING.fullmatch(part.heading.strip())
    kind = found["kind"].strip().lower() if found else ""
    if not found or kind not in KINDS:
        meant = quoting.suggest_word(kind.capitalize(), [known.capitalize() for known in KINDS])
        raise LessonError(part.line, f"'{quoting.quote(part.heading.strip())}' begins no step{meant}; give "
                          "## Predict: ..., ## Run: ..., ## Observe: ... or ## Explain: ..., of a core round "
                          "## Predict (core): ...")
    return kind, found["title"].strip(), bool(found["core"])


def check_unique_names(lesson: Lesson) -> None:
    """Raises :class:`LessonError` if steps share a key, runs a name, or a run's name is a word of claims."""
    keys: dict[str, int] = {}
    names: dict[str, int] = {}
    for step in lesson.steps:
        if step.key in keys:
            raise LessonError(step.line, f"this step is called as the one in line {keys[step.key]}; give each a title "
                                         "of its own")
        keys[step.key] = step.line
        for run in step.runs:
            if run.name in names or run.name in claims.result_paths() or run.name in claims.WORDS:
                also = f"is the run in line {names[run.name]}" if run.name in names else "has a meaning in claims"
                raise LessonError(run.line, f"{run.name} {also}; give the run another name")
            names[run.name] = run.line


def check_claims(lesson: Lesson) -> None:
    """Raises :class:`LessonError` if a claim or expected value of a lesson is not about its runs and their results."""
    for step in lesson.steps:
        main = lesson.main_run(step)
        checked: list[tuple[str, int, Callable[[str, Mapping[str, Any], str], None]]] = [
            (claim.text, claim.line, claims.check_claim) for claim in step.claims]
        if asked := step.question:
            checked += [(text, asked.line, claims.check_claim) for text in asked.holds]
            if asked.expected:
                checked.append((asked.expected, asked.line, claims.check_expression))
        for text, line, check in checked:
            for numbers in lesson.variants:
                try:
                    check(fill_numbers(text, numbers), lesson.runs, main)
                except claims.ClaimError as error:
                    raise LessonError(line, str(error)) from None


def _check_bets(lesson: Lesson) -> None:
    """Raises :class:`LessonError` if a step compares bets and none came before, or some on which judges cannot bet."""
    for step in lesson.steps:
        asked = interval_bets.earlier_bet_steps(lesson, step) if step.bets else []
        if step.bets and not asked:
            raise LessonError(step.line, "bets are shown, and no interval is asked before; ask one, or leave them out")
        for question in (other.asked_question for other in asked if set(step.bets) - {*interval_bets.OWN}):
            if not interval_bets.PATH.fullmatch(question.expected) or question.level != interval_bets.LEVEL:
                raise LessonError(question.line, "judges bet on errors at the end, at a level of "
                                  f"{interval_bets.LEVEL:g}; give expected = \"fine.error.x.final\", or of v or sigma, "
                                  f"and that level, or leave the judges out in line {step.line}")


def _check_text(part: LessonSection, lesson: Lesson, folder: Path | None) -> None:
    """Raises :class:`LessonError` for a formula, picture or placeholder of a section that cannot be shown."""
    known = set(lesson.variants[0])
    for number, line in number_lines(part):
        plain = FORMULA.sub("", line)
        for found in PLACE.finditer(plain):
            if found[1] not in known:
                raise LessonError(number, f"{found[0]} is no number of a variant; give "
                                          f"{', '.join(f'{{{name}}}' for name in known) or 'none, for none is set'}")
    try:
        to_html("\n".join(part.text), folder)
    except RenderError as error:
        number = next((k for k, line in number_lines(part) if error.piece in line), part.line)
        raise LessonError(number, str(error)) from None
