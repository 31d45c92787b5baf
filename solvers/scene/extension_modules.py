"""External modules that register estimators and effects: those named in ``MPM_LAB_EXTENSIONS``.

Every process imports them once, before it looks up what a problem supports.
"""

import contextlib
import functools
import importlib
import os
import sys
from collections.abc import Iterable

EXTENSIONS = "MPM_LAB_EXTENSIONS"
COMPILED_PROBLEMS: set[str] = set()  # problems whose solvers are imported, so that extensions come too late


class ExtensionError(Exception):
    """Error for a module named in ``MPM_LAB_EXTENSIONS`` that cannot be imported; the message says which and why."""


@functools.cache
def load_extensions() -> None:
    """Imports the modules that ``MPM_LAB_EXTENSIONS`` names; what they print goes to standard error, because standard
    output may be JSON. Raises :class:`ExtensionError` where that fails."""
    for module in filter(None, os.environ.get(EXTENSIONS, "").replace(",", " ").split()):
        try:
            with contextlib.redirect_stdout(sys.stderr):
                importlib.import_module(module)
        except (Exception, SystemExit) as error:
            missing = isinstance(error, ModuleNotFoundError) and error.name == module.partition(".")[0]
            raise ExtensionError(f"{EXTENSIONS} names {module}, which cannot be imported ({type(error).__name__}: "
                                 f"{error}); correct it or leave it out"
                                 f"{', or name its folder in PYTHONPATH' * missing}") from error


def require_before_solver_import(name: str, problems: Iterable[str]) -> None:
    """Raises RuntimeError where the solver of one of the ``problems`` has been imported: it is too late to register the
    estimator or effect ``name`` for them, because the solver's kernels are fixed."""
    if late := [problem for problem in problems if problem in COMPILED_PROBLEMS]:
        raise RuntimeError(f"register {name} before the solver of the {' and '.join(late)} is imported")
