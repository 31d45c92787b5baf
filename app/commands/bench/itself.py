"""The command ``mpm-lab`` in a process of its own: this code, though the working folder may have an ``app``, too."""

import sys
from pathlib import Path

from solvers.workers.processes import HOME

START = "import sys; sys.path.insert(0, sys.argv.pop(1)); from app.cli import main; sys.exit(main())"


def command_of(folder: Path) -> tuple[str, ...]:
    """The same from any ``folder`` with the packages ``app`` and ``solvers``."""
    return sys.executable, "-c", START, str(folder)


ITSELF = command_of(HOME)
