"""mpm-lab by a name that nobody else has.

Its four folders are called ``app``, ``solvers``, ``lessons`` and ``assets``, as other people's are. In a checkout they
stand where they stand; installed, in the folder ``packages`` beside this file, where no other package's files can come
to lie among them. The command is a process of the lab's own, in which all four names are the lab's: see :func:`main`.
Who imports this module has ``solvers`` from there, whatever else is called so, and all other names as before::

    from mpm_lab import BarScene, run
"""

import sys
from pathlib import Path
from typing import TYPE_CHECKING

HERE = Path(__file__).resolve().parent
HOME = next(folder for folder in (HERE / "packages", *HERE.parents) if (folder / "solvers" / "__init__.py").is_file())


def _take_solvers() -> None:
    """Import ``solvers`` from its place. What is found first under that name in a process is it for all who ask."""
    sys.path.insert(0, str(HOME))
    try:
        import solvers
    finally:
        sys.path.remove(str(HOME))
    place = solvers.__file__ or next(iter(solvers.__path__), "")  # a folder without __init__.py has no file
    if Path(place).resolve().parent != HOME / "solvers":
        raise ImportError(f"another package called solvers ({place}) was imported before mpm_lab, and a process has "
                          "room for one: leave the other out, or start the command mpm-lab beside it")


_take_solvers()

if TYPE_CHECKING:
    from solvers import *  # noqa: F403
else:  # each name is imported when it is asked for
    from solvers import __all__ as __all__
    from solvers import __getattr__ as __getattr__


def main(arguments: list[str] | None = None) -> int:
    """The command ``mpm-lab``: run it and return its exit status. The processes that it starts look where it does."""
    sys.path.insert(0, str(HOME))
    from app.cli import main

    return main(arguments)
