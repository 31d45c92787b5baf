"""The command ``mpm-lab`` in a process of its own: this code, though the working folder may have an ``app``, too."""

import sys

from solvers.workers.processes import HOME

START = "import sys; sys.path.insert(0, sys.argv.pop(1)); from app.cli import main; sys.exit(main())"
ITSELF = (sys.executable, "-c", START, str(HOME))
