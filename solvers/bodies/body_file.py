"""Files of bodies, in TOML: the sections material, load, run and goals, and one [[patch]] for each patch."""

import sys
from collections.abc import Mapping
from dataclasses import MISSING, fields
from pathlib import Path
from typing import Any

from solvers.bodies.body import MOST_GOALS, Body
from solvers.bodies.goal import Goal
from solvers.bodies.patch import Patch
from solvers.scene.validation import SceneError
from solvers.translatable_message import Message
from solvers.untrusted.quoting import FileError, suggest_word

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

LIBRARY = Path(__file__).with_name("library")
MOST_BYTES = 100_000
SECTIONS: Mapping[str, tuple[str, ...]] = {
    "material": ("youngs_modulus", "poissons_ratio", "density"), "load": ("gravity", "velocity", "force"),
    "run": ("method", "cells_per_metre", "ppc", "cfl", "t_end", "domain", "elements_across")}
TABLES = ("patch", *SECTIONS, "goals")
DEFAULTS = {one.name: one.default for one in fields(Body)}
#: What else a section may be expected to have, and why it has not.
REASONS: Mapping[str, str] = {
    "material": Message("; the material is elastic: others, plastic, viscous or damaging, have no companion"),
    "load": Message("; loads on sides and contact are not computed"),
    "patch": Message("; contact and loads on sides are not computed")}


def library_names() -> list[str]:
    """Returns the names of the bodies that come with the package."""
    return sorted(path.stem for path in LIBRARY.glob("*.toml"))


def library_text(name: str) -> str:
    """Returns the file of a body that comes with the package."""
    return LIBRARY.joinpath(f"{name}.toml").read_text(encoding="utf-8")


def read_body(path: str) -> Body:
    """Returns the body of a file. Raises FileError where it cannot be read, SceneError for what it says."""
    try:
        with Path(path).open("rb") as file:
            content = file.read(MOST_BYTES + 1)
    except (OSError, ValueError) as error:  # ValueError: a character invalid in names
        raise FileError.from_os_error(path, error) from None
    if len(content) > MOST_BYTES:
        raise FileError(path, "is longer than {most:,} bytes, and so no file of a body", MOST_BYTES)
    try:
        return parse_body(content.decode("utf-8-sig"))  # some editors begin a file with a byte order mark
    except SceneError:
        raise
    except UnicodeDecodeError:
        raise FileError(path, "is no text in UTF-8") from None
    except tomllib.TOMLDecodeError as error:
        raise FileError(path, "is no TOML: {error}", str(error)) from None
    except RecursionError:
        raise FileError(path, "is nested too deeply") from None
    except ValueError:  # of whole numbers that have more digits than Python reads
        raise FileError(path, "has a number of too many digits") from None


def parse_body(text: str) -> Body:
    """Returns the body that a text in TOML defines. Raises SceneError, or TOMLDecodeError where it is no TOML."""
    content = tomllib.loads(text)
    _check_keys("file", content, TABLES)
    values: dict[str, Any] = {}
    for section, names in SECTIONS.items():
        table = _as_table(section, content.get(section, {}))
        _check_keys(section, table, names)
        if missing := [name for name in names if name not in table and DEFAULTS[name] is MISSING]:
            raise SceneError("file", f"[{section}]", "lacks {names}", ", ".join(missing))
        values |= {name: _to_tuples(value) for name, value in table.items()}
    patches = content.get("patch", [])
    if not isinstance(patches, list):
        raise SceneError("patch", patches, "give patches in tables with two brackets: [[patch]]")
    return Body(patches=tuple(map(_read_patch, patches)), goals=_read_goals(content.get("goals", {})), **values)


def body_from_dict(values: Mapping[str, Any]) -> Body:
    """Returns the body with these fields, as ``dataclasses.asdict`` and JSON give them; raises SceneError."""
    own = {name: _to_tuples(value) for name, value in values.items() if name not in ("patches", "goals")}
    return Body(patches=tuple(map(_read_patch, values["patches"])), goals=_read_goals(values["goals"]), **own)


def _read_patch(content: Any) -> Patch:
    table = _as_table("patch", content)
    _check_keys("patch", table, ("corners", "sides", "arc"))
    if "corners" not in table:
        raise SceneError("file", "[[patch]]", "lacks {names}", "corners")
    values = {name: _to_tuples(value) for name, value in table.items() if name != "arc"}
    arcs = _as_table("arc", table.get("arc", {}))
    return Patch(**values, arc={side: _to_tuples(centre) for side, centre in arcs.items()})


def _read_goals(content: Any) -> dict[str, Goal]:
    goals = {}
    for name, value in _as_table("goals", content).items():
        table = _as_table("goals", value)
        _check_keys("goals", table, ("value", "at"))
        goals[name] = Goal(table.get("value", ""), _to_tuples(table.get("at", ())))
    if len(goals) > MOST_GOALS:
        raise SceneError("goals", len(goals), "are too many; give at most {most}", MOST_GOALS)
    return goals


def _as_table(name: str, value: Any) -> dict[str, Any]:
    if not isinstance(value, dict):
        raise SceneError(name, value, "is no table; give names with values")
    return value


def _check_keys(where: str, table: Mapping[str, Any], known: tuple[str, ...]) -> None:
    for name in table:
        if name not in known:
            raise SceneError(where, name, "is not known{near}; give {names}{reason}", suggest_word(name, known),
                             ", ".join(known), REASONS.get(where, ""))


def _to_tuples(value: Any) -> Any:
    return tuple(map(_to_tuples, value)) if isinstance(value, list) else value
