"""Which tests belong to a change: ``uv run python -m tests.affected_tests [FILE ...]``, by default the files that git
sees changed.

Prints the test files that import a changed module, or a module that does, nearest first. Files of a package that is
imported as a whole and texts have none; ``uv run pytest`` is short.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path

import grimp

from tests.support.paths import ROOT

STEPS = 2  # imports between a test and what it belongs to; with three nearly all tests belong to anything


def module_of(path: str) -> str:
    """The module of a file, by its path from the top."""
    return ".".join(Path(path).with_suffix("").parts).removesuffix(".__init__")


def tests_of(changed: Iterable[str]) -> list[str]:
    """Paths of the test files that belong to changed files, nearest first."""
    graph = grimp.build_graph("app", "solvers", "tests", cache_dir=None)
    near, found = {module_of(path) for path in changed} & graph.modules, dict[str, None]()
    for _ in range(STEPS + 1):
        found |= dict.fromkeys(sorted(name for name in near if name.rpartition(".")[2].startswith("test_")))
        near |= {importer for name in near for importer in graph.find_modules_that_directly_import(name)}
    return [f"{name.replace('.', '/')}.py" for name in found]


def main() -> None:
    changed = sys.argv[1:] or subprocess.run(["git", "diff", "--name-only", "HEAD"], cwd=ROOT, check=True,
                                             capture_output=True, text=True).stdout.split()
    print(*tests_of(changed), sep="\n")


if __name__ == "__main__":
    main()
