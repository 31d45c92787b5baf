"""``uv run pytest`` collects with the dependency group ``test`` alone; what others bring is asked for, not assumed."""

from __future__ import annotations

import ast
import re
import sys

from tests.groups import MODULES
from tests.paths import ROOT

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

FILES = sorted((ROOT / "tests").rglob("*.py"))


def at_import(tree: ast.AST):
    """The names of the modules that a file imports as it is imported: all but those within functions."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.Import):
            yield from (name.name for name in node.names)
        elif isinstance(node, ast.ImportFrom) and not node.level:
            yield node.module
        elif not isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
            yield from at_import(node)


def test_no_file_imports_what_only_another_group_brings():
    others = {module for modules in MODULES.values() for module in modules}
    found = {(str(path.relative_to(ROOT)), name) for path in FILES
             for name in at_import(ast.parse(path.read_text(encoding="utf-8"))) if name.partition(".")[0] in others}
    assert not found


def test_the_groups_are_those_of_the_project():
    groups = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["dependency-groups"]
    for group, modules in MODULES.items():
        brought = [re.match(r"[\w.-]+", line)[0].replace("-", "_") for line in groups[group]]
        assert sorted(brought) == sorted(modules)
