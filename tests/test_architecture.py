"""The house keeps its plan: an honest list of kernel files, private parts left alone, no long file.

That rooms look down, problems do not know each other and nothing goes in circles are contracts of import-linter in
``pyproject.toml``; here is what a contract cannot say.
"""

import ast
import re
import sys

import pytest

from solvers.problems import PROBLEMS
from tests.support.paths import ROOT

if sys.version_info >= (3, 11):
    import tomllib
else:  # mypy brings it
    import tomli as tomllib

SOURCES = sorted(path for room in ("app", "solvers") for path in (ROOT / room).rglob("*.py"))
KERNEL = re.compile(r"^\s*@ti\.(func|kernel)\b", re.MULTILINE)
LONGEST_FILE, APP = 320, ROOT / "app"
PRIVATE = re.compile(r"(^|\.)_[a-z]|^viser\.infra")


@pytest.mark.parametrize("problem", PROBLEMS)
def test_a_scene_names_the_estimators_that_its_solver_has(problem):
    """The one without Taichi, the other with it."""
    assert tuple(PROBLEMS[problem].solver.HOOKS) == PROBLEMS[problem].estimators


def test_only_kernel_files_are_spared_by_mypy():
    overrides = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["mypy"]["overrides"]
    rules = {name: override["ignore_errors"] for override in overrides if "ignore_errors" in override
             for name in override["module"]}
    patterns = [name.replace(".", r"\.").replace(r"\.*", r"(\..*)?") for name in rules if "*" in name]
    modules = {".".join(path.relative_to(ROOT).with_suffix("").parts): path for path in SOURCES}
    spared = {module for module in modules  # as mypy has it: a rule for the very name before one for a pattern
              if rules.get(module, any(re.fullmatch(pattern, module) for pattern in patterns))}
    assert [name for name in rules if "*" not in name and name not in modules] == []
    assert [module for module in spared if not KERNEL.search(modules[module].read_text(encoding="utf-8"))] == []


def private_parts(text):
    """What a file has of private modules and attributes of anybody: modules by their names, attributes by theirs."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            names = [f"{node.module}.{alias.name}" for alias in node.names]
        else:
            names = [node.attr] if isinstance(node, ast.Attribute) else []
        yield from (name for name in names if PRIVATE.search(name))


def test_only_its_own_room_touches_private_parts_of_the_viewer():
    """Of others' a module that is named so, or ``viser.infra``; an attribute that no file of ours has on itself."""
    texts = {path.relative_to(ROOT): path.read_text(encoding="utf-8") for path in SOURCES if path.is_relative_to(APP)}
    ours = {name for text in texts.values() for name in re.findall(r"\bself\.(_\w+)|\bdef (_\w+)|^ *(_\w+):", text)
            for name in name if name}
    touched = {str(path): {name for name in private_parts(text) if name not in ours} for path, text in texts.items()
               if path.parts[:2] != ("app", "viewer")}
    assert {path: names for path, names in touched.items() if names} == {}


def test_no_file_is_too_long():
    lengths = {str(path.relative_to(ROOT)): path.read_text(encoding="utf-8").count("\n") for path in SOURCES}
    assert {path: n for path, n in lengths.items() if n > LONGEST_FILE} == {}


#: Names that meant several things here, or nothing to a stranger, and what to take instead.
VAGUE = {
    "told said says shown drawn spoken": "what it makes: format_..., to_json, draw_...",
    "found known looked look": "what it looks for: find_..., probe_..., or the quantity",
    "heard hearing asked wish wanted": "the event: on_..., a request, a message",
    "kept held taken laid given made carried": "store_..., load_..., or the quantity",
    "of here there ours alone apart back beside who why": "a noun or a verb",
    "bell tower": "event, notifier", "door doors anteroom": "access control", "spark sparks": "suggestion",
    "lectern": "lecturer's panel", "shelf": "catalogue", "hands": "controls", "room": "bounds, quota", "seat": "slot",
    "sight": "display", "trouble": "error", "doubt": "why_not_trusted", "goodbye": "close", "pulse": "ping",
    "wire": "queue"}


FRAGMENT = re.compile(r"(Of|One (?!visitor)|Those|By|That|These|As|Its|Their|Whose|Meanwhile|And|The same|Again) ")


def test_docstrings_say_their_subject():
    """An editor shows them alone: a verb in the third person, or a noun phrase."""
    documented = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    texts = {f"{path.relative_to(ROOT)}:{getattr(node, 'lineno', 1)}": ast.get_docstring(node) or "" for path in SOURCES
             for node in ast.walk(ast.parse(path.read_text("utf-8"))) if isinstance(node, documented)}
    assert {place: text[:60] for place, text in texts.items() if FRAGMENT.match(text)} == {}


def test_vague_names_do_not_come_back():
    """Of modules, classes and functions; names that are longer say more."""
    instead, vague = {word: term for words, term in VAGUE.items() for word in words.split()}, {}
    for path in SOURCES:
        names = [(path.stem, 1), *((node.name, node.lineno) for node in ast.walk(ast.parse(path.read_text("utf-8")))
                                   if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef))]
        vague |= {f"{path.relative_to(ROOT)}:{line} {name}": instead[word] for name, line in names
                  if (word := name.strip("_").lower()) in instead}
    assert vague == {}, "take the term instead"
