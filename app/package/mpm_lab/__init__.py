"""The package mpm-lab under a unique name.

Its four top-level folders, ``app``, ``solvers``, ``lessons`` and ``assets``, have common names. The wheel puts them
into ``packages`` beside this file, to avoid collisions. The command runs in a process of its own, in which all four
names are the lab's: see :func:`main`. Importing this module imports its ``solvers``, in place of any other of that
name, and no other name but ``app``, when something is shown::

    from mpm_lab import BarScene, run, show
"""

import importlib
import importlib.metadata
import sys
from pathlib import Path
from typing import TYPE_CHECKING

HERE = Path(__file__).resolve().parent
HOME = next(folder for folder in (HERE / "packages", *HERE.parents) if (folder / "solvers" / "__init__.py").is_file())


def import_own_package(name: str) -> None:
    """Imports ``app`` or another of the lab's packages; raises ImportError if another of its name is imported."""
    sys.path.insert(0, str(HOME))
    try:
        found = importlib.import_module(name)
    finally:
        sys.path.remove(str(HOME))
    place = found.__file__ or next(iter(found.__path__), "")  # a folder without __init__.py has no file
    if Path(place).resolve().parent != HOME / name:
        raise ImportError(f"another package called {name} ({place}) was imported before mpm_lab's, and a process has "
                          "room for one: leave the other out, or start the command mpm-lab beside it")


import_own_package("solvers")

if TYPE_CHECKING:
    from app.notebook import show as show
    from solvers import *  # noqa: F403
else:  # names are imported on first use
    import solvers

    __all__ = [*solvers.__all__, "show"]

    def __getattr__(name):
        if name == "__version__":
            return importlib.metadata.version("mpm-lab")
        if name != "show":
            return solvers.__getattr__(name)
        import_own_package("app")
        from app.notebook import show
        return show


def main(arguments: list[str] | None = None) -> int:
    """Runs ``mpm-lab`` with ``arguments``, by default the process's, and returns its exit status."""
    sys.path.insert(0, str(HOME))
    from app.cli import main
    return main(arguments)
