"""How a result is drawn: by whoever says so under the entry points of ``GROUP``; the solvers draw nothing themselves.

The installed package names ``app``'s picture of a run and its table; another may name its own.
"""

from collections.abc import Callable
from importlib.metadata import entry_points
from typing import Any

GROUP = "mpm_lab.result"


def view(name: str) -> Callable[[Any], Any] | None:
    """What draws a result as ``name``; None where nothing that is installed does, as in a tree that was only copied."""
    return next((entry.load() for entry in entry_points(group=GROUP, name=name)), None)
