"""The user interfaces: command line, page and pictures. Imports solvers; never the reverse."""

import solvers  # noqa: F401 - before numpy, for which it says how many threads there are

__version__ = "0.2.0"
