"""The rows of a sweep as a user of Python has them: a list of rows, each a mapping, and a column by its name."""

from __future__ import annotations

import numbers
from collections.abc import Iterable, Mapping
from typing import SupportsIndex, overload

import numpy as np

from solvers.outside import quoting
from solvers.scene.rules import SceneError


class Rows(list[dict]):
    """Rows with the same keys. A name gives the column: ``rows["error.x.max"]``, as an array over the rows."""

    def __init__(self, rows: Iterable[Mapping] = ()):
        super().__init__(map(dict, rows))

    @overload
    def __getitem__(self, which: SupportsIndex) -> dict: ...
    @overload
    def __getitem__(self, which: slice) -> Rows: ...
    @overload
    def __getitem__(self, which: str) -> np.ndarray: ...

    def __getitem__(self, which):
        """A row by its number, rows by a slice, a column by its name: numbers with NaN where a row has none, or
        anything else as objects, so that ``rows["scene.method"] == "mpm"`` says which rows are.

        Raises
        ------
        SceneError
            For a column that there is not, with those that are.
        """
        if isinstance(which, str):
            return self._column(which)
        found = super().__getitem__(which)
        return Rows(found) if isinstance(which, slice) else found

    @property
    def columns(self) -> list[str]:
        """The names of all columns."""
        return list(self[0]) if self else []

    def _column(self, name: str) -> np.ndarray:
        if name not in self.columns:
            raise SceneError("column", name, f"is none of these rows{quoting.meant(name, self.columns)}; they have "
                                             f"{', '.join(self.columns) or 'none'}")
        values = [row[name] for row in self]
        known = [value for value in values if value is not None]
        if not known or not all(isinstance(value, numbers.Real) and not isinstance(value, bool) for value in known):
            return np.array([*values, None], dtype=object)[:-1]
        if len(known) == len(values) and all(isinstance(value, numbers.Integral) for value in values):
            return np.array(values)
        return np.array([np.nan if value is None else value for value in values], float)
