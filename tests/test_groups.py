"""``uv run pytest`` collects with the dependency group ``test`` alone; what others bring is asked for, not assumed."""

from __future__ import annotations

import ast

from tests.groups import MODULES
from tests.paths import ROOT

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
