"""The fenced blocks of a lesson's step: runs, question, claims; errors give the line and what is expected."""

import re
import sys
from collections.abc import Callable, Mapping
from typing import Any

from app import shareable_state
from app.frame.slow_motion.step_phases import PHASES
from app.lessons.body_runs import body_of_run, is_body_run
from app.lessons.interval_bets import BETTORS
from app.lessons.lesson import (
    CHOICE,
    QUESTIONS,
    REACH,
    Claim,
    LessonError,
    LessonRun,
    Numbers,
    Question,
    ShownPhase,
    fill_numbers,
)
from solvers.untrusted import quoting

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

NAME = re.compile(r"[a-z][a-z0-9_]*")
STAGE, SHOWN = "stage", "on-the-stage"
DRAGGED = tuple(REACH)  # fields of a scene that a student may drag
VARIED = (*DRAGGED, "dt")  # fields that may have several values in a run
MOST_OPTIONS = 8
MOST_RUNS = 8  # of one block that differ in a number
_AT = re.compile(r" \(at (?:line (\d+), column \d+|end of document)\)$")


def parse_toml(text: str, line: int) -> dict[str, Any]:
    """Parses a TOML text that begins at a line of its file; raises :class:`LessonError` if it is invalid."""
    try:
        return tomllib.loads(text)
    except (RecursionError, OverflowError):
        raise LessonError(line, "this is nested too deep; give lines such as key = 3") from None
    except tomllib.TOMLDecodeError as error:
        where = _AT.search(str(error))
        last = max(0, len(text.rstrip("\n").splitlines()) - 1)
        at = line + (int(where[1]) - 1 if where and where[1] else last)
        raise LessonError(at, f"this is no TOML ({_AT.sub('', str(error)).lower()}); give lines such as "
                              "key = \"text\", key = 3 or key = [\"one\", \"two\"]") from None
    except ValueError:  # of whole numbers that have more digits than Python reads
        raise LessonError(line, "a number here has too many digits; give lines such as key = 3") from None


def line_of_key(key: str, text: str, line: int) -> int:
    """Returns the line in the file of a key in a TOML text that begins at ``line``; that line if the key is missing."""
    pattern = re.compile(rf"\s*\[*\s*[\"']?{re.escape(key)}[\"']?\s*[=\]]")
    return next((line + k for k, row in enumerate(text.splitlines()) if pattern.match(row)), line)


def require_value(values: Mapping[str, Any], key: str, kind: type | tuple[type, ...], expected: str, line: int) -> Any:
    """Returns a key's value of a ``kind``; else raises :class:`LessonError` with the sentence ``expected``."""
    found = values.get(key)
    if not isinstance(found, kind) or isinstance(found, bool):
        said = f"{key} is missing" if key not in values else f"{key} = {str(found)[:60]}"
        raise LessonError(line, f"{said}: {expected}")
    return found


def require_texts(values: Mapping[str, Any], key: str, line: int) -> tuple[str, ...]:
    """Returns the texts listed under a key, () if it is missing; raises :class:`LessonError` for the line otherwise."""
    found = values.get(key, [])
    if not isinstance(found, list) or not all(isinstance(item, str) and item.strip() for item in found):
        raise LessonError(line, f"{key} = {str(found)[:60]}: give a list of texts, such as [\"one\", \"two\"]")
    return tuple(found)


def parse_runs_and_stage(text: str, line: int, variants: tuple[Numbers, ...]
                         ) -> tuple[tuple[LessonRun, ...], str, ShownPhase | None]:
    """Returns the runs of a block, which begins at ``line`` of the file, the text of the state that it puts on the
    stage (of a named run, a scene, or the first run; "" where that is a body's), and the phase in slow motion that it
    begins with or None. Raises :class:`LessonError` if any is invalid for a variant."""
    values, found = parse_toml(text, line), dict[str, LessonRun]()
    shown = values.pop(SHOWN, None)
    for name, scene in values.items():
        at = line_of_key(name, text, line)
        if not NAME.fullmatch(name):
            raise LessonError(at, f"{name} is no name for a run; give small letters, digits and _, such as fine_grid")
        if not isinstance(scene, str):
            raise LessonError(at, f"{name} = {str(scene)[:60]}: give a scene as text, such as \"bar cells=40\"")
        if name != STAGE:
            found[name] = _parse_run(name, scene, at, variants)
    stage = values.get(STAGE, next(iter(found), ""))
    if not stage:
        raise LessonError(line, "a run without a scene: give lines such as hat = \"bar method=mpm cells=40\"")
    if stage in found:
        stage = found[stage].texts[0]
        if is_body_run(stage):
            return tuple(found.values()), "", None
    elif is_body_run(stage):
        raise LessonError(line_of_key(STAGE, text, line), "a body is not put on the stage; leave the line out")
    else:
        _check_state(stage, line_of_key(STAGE, text, line), variants)
    most = shareable_state.parse_state(fill_numbers(stage, variants[0])).scene.particles
    return tuple(found.values()), stage, None if shown is None else _parse_shown_phase(
        shown, most, line_of_key(SHOWN, text, line))


def _parse_shown_phase(values: Any, particles: int, line: int) -> ShownPhase:
    """Returns the phase that ``on-the-stage`` names, of a run with so many particles; raises :class:`LessonError`."""
    limits = {"particle": range(particles), "phase": range(1, len(PHASES) + 1)}
    if not isinstance(values, dict) or values.keys() != limits.keys() \
            or any(type(values[key]) is not int or values[key] not in limit for key, limit in limits.items()):
        raise LessonError(line, f"{SHOWN} = {str(values)[:60]}: give {{particle = 0, phase = 1}}, with a particle up "
                                f"to {particles - 1} and a phase up to {len(PHASES)}")
    return ShownPhase(**values)


def _parse_run(name: str, text: str, line: int, variants: tuple[Numbers, ...]) -> LessonRun:
    """Returns the run with this name and scene ``text``; "cells=20,40" in it stands for several scenes of the run."""
    words = text.split()
    several = [] if is_body_run(text) else [
        k for k, word in enumerate(words) if "," in word and word.partition("=")[0] in VARIED]
    if len(several) > 1:
        raise LessonError(line, f"{name}: only one number may have several values, not {words[several[0]]} and "
                                f"{words[several[1]]}")
    if not several:
        _check_state(text, line, variants)
        return LessonRun(name, (text,), line)
    field, _, values = words[several[0]].partition("=")
    each = values.split(",")
    if not 2 <= len(each) <= MOST_RUNS:
        raise LessonError(line, f"{name}: {field} has {len(each)} values; give 2 to {MOST_RUNS}")
    lines = tuple(" ".join((*words[:several[0]], f"{field}={one}", *words[several[0] + 1:])) for one in each)
    for one in lines:
        _check_state(one, line, variants)
    return LessonRun(name, lines, line, field)


def _check_state(text: str, line: int, variants: tuple[Numbers, ...]) -> None:
    for numbers in variants:
        try:
            (body_of_run if is_body_run(text) else shareable_state.parse_state)(fill_numbers(text, numbers))
        except shareable_state.StateError as error:
            raise LessonError(line, str(error)) from None


def parse_question(text: str, line: int) -> Question:
    """Parses a question block that begins at a line; raises :class:`LessonError`. Names of runs are not checked yet."""
    values = parse_toml(text, line)
    kind = values.pop("kind", None)
    if kind not in QUESTIONS:
        raise LessonError(line_of_key("kind", text, line), f"kind = {kind!s:.60}: give one of {', '.join(QUESTIONS)}")
    keys = QUESTIONS[kind]
    for key in values:
        if key not in keys:
            raise LessonError(line_of_key(key, text, line), f"{key} means nothing for a {kind}; give "
                                                        f"{', '.join(keys) or 'nothing else'}")
    for key, needed in keys.items():
        if needed and key not in values:
            raise LessonError(line, f"{key} is missing: a {kind} needs {', '.join(k for k in keys if keys[k])}")
    asked = Question(kind, line, **{key: _READ[key](values, key, line_of_key(key, text, line)) for key in values})
    return _check_options(asked) if kind == CHOICE else asked


def _check_options(asked: Question) -> Question:
    """Returns a choice unchanged; raises :class:`LessonError` unless it defines the right option in one of two ways."""
    if not 2 <= len(asked.options) <= MOST_OPTIONS:
        raise LessonError(asked.line, f"there are {len(asked.options)} options; give 2 to {MOST_OPTIONS}")
    if (asked.correct is None) == (not asked.holds):
        raise LessonError(asked.line, "give either correct, the number of the right option counted from 1, or holds, "
                                      "a claim for each option")
    if asked.correct is not None and not 1 <= asked.correct <= len(asked.options):
        raise LessonError(asked.line, f"correct = {asked.correct}: there are options 1 to {len(asked.options)}")
    if asked.holds and len(asked.holds) != len(asked.options):
        raise LessonError(asked.line, f"holds has {len(asked.holds)} claims for {len(asked.options)} options; give one "
                                      "for each")
    return asked


def parse_claims(text: str, line: int) -> tuple[Claim, ...]:
    """Parses the claims of a block that begins at a line: one per line, comments after #. Raises if there is none."""
    found = [Claim(row.partition("#")[0].strip(), line + k) for k, row in enumerate(text.splitlines())]
    if not any(claim.text for claim in found):
        raise LessonError(line, "no claim: give lines such as error.x.max < 1e-5")
    return tuple(claim for claim in found if claim.text)


def parse_bettors(text: str, line: int) -> tuple[str, ...]:
    """Parses the names of the bettors that a block compares, one per line; raises :class:`LessonError` for others."""
    found = tuple(row.strip() for row in text.splitlines() if row.strip())
    if unknown := [name for name in found if name not in BETTORS]:
        raise LessonError(line, f"'{quoting.quote(unknown[0])}' does not bet; give {', '.join(BETTORS)}, one a line")
    if not found:
        raise LessonError(line, f"nobody bets here; give {', '.join(BETTORS)}, one a line")
    return tuple(dict.fromkeys(found))


def _make_reader(kind: Any, fits: Callable[[Any], bool], expected: str) -> Callable[[Mapping[str, Any], str, int], Any]:
    """Returns a function of (TOML values, key, line) that returns a word, or a number as float, if it is of a ``kind``
    and ``fits``; else it raises :class:`LessonError` with the sentence ``expected``."""
    def read(values: Mapping[str, Any], key: str, line: int) -> Any:
        found = require_value(values, key, kind, expected, line)
        if not fits(found):
            raise LessonError(line, f"{key} = {found}: {expected}")
        return found if kind is str else float(found)

    return read


_READ: dict[str, Callable[[Mapping[str, Any], str, int], Any]] = {
    "options": require_texts, "holds": require_texts,
    "control": _make_reader(str, DRAGGED.__contains__, f"give one of {', '.join(DRAGGED)}"),
    "level": _make_reader((int, float), lambda level: 0 < level < 1, "give a chance above 0 and below 1, such as 0.8"),
    "tolerance": _make_reader((int, float), lambda part: 0 < part <= 1,
                              "give a part of the expected value, above 0 and up to 1, such as 0.1"),
    "expected": lambda values, key, line: str(require_value(
        values, key, (str, int, float), "give a number or an expression such as \"error.x.max\"", line)),
    "correct": lambda values, key, line: require_value(values, key, int, "give the number of the right option", line),
    "unit": lambda values, key, line: require_value(values, key, str, "give a text, such as \"m\"", line)}
