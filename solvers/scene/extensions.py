"""Modules from outside, which register estimators and effects: those that ``MPM_LAB_EXTENSIONS`` names.

Every process imports them, once, before it asks what a problem has.
"""

import functools
import importlib
import os
from collections.abc import Iterable

EXTENSIONS = "MPM_LAB_EXTENSIONS"
COMPILED_PROBLEMS: set[str] = set()  # problems whose solvers have what they need of all extensions


class ExtensionError(Exception):
    """A module that ``MPM_LAB_EXTENSIONS`` names cannot be imported; the message says which and why."""


@functools.cache
def load_extensions() -> None:
    """Import what the environment names; :class:`ExtensionError` where that fails."""
    for module in filter(None, os.environ.get(EXTENSIONS, "").replace(",", " ").split()):
        try:
            importlib.import_module(module)
        except Exception as error:
            missing = isinstance(error, ModuleNotFoundError) and error.name == module.partition(".")[0]
            raise ExtensionError(f"{EXTENSIONS} names {module}, which cannot be imported ({type(error).__name__}: "
                                 f"{error}); correct it or leave it out"
                                 f"{', or name its folder in PYTHONPATH' * missing}") from error


def require_early(name: str, problems: Iterable[str]) -> None:
    """RuntimeError where the solver of one of the ``problems`` that ``name`` is for has been imported: its kernels have
    been told what there is. Register first."""
    if late := [problem for problem in problems if problem in COMPILED_PROBLEMS]:
        raise RuntimeError(f"register {name} before the solver of the {' and '.join(late)} is imported")
