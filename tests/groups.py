"""What some tests need beyond the dependency group ``test``, which ``uv run pytest`` brings: the group that has it."""

import importlib.util
import os

import pytest

#: What is imported from each group of ``pyproject.toml``.
MODULES = {"browser": ("playwright", "axe_playwright_python"), "cluster": ("distributed",),
           "notebook": ("jupyterlab", "jupytext", "nbclient", "nbformat", "ipykernel"),
           "docs": ("sphinx", "myst_parser", "furo")}
HOW = "no {} found, of the dependency group {}: `uv run --all-groups pytest` brings it and runs these tests"


def require_group(group: str) -> None:
    """Skip the test with a word where one of the group's modules is missing; where CI is set, fail."""
    missing = [module for module in MODULES[group] if importlib.util.find_spec(module) is None]
    if missing:
        (pytest.fail if os.environ.get("CI") else pytest.skip)(HOW.format(" and ".join(missing), group))
