"""Shared parts of the readers of VTK's formats: collection of arrays within limits, and numbers from text."""

import warnings
from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager
from xml.parsers import expat

import numpy as np

from solvers.judging.quantity_names import is_known_name
from solvers.untrusted.quoting import FileError, quote
from solvers.untrusted.size_limits import SizeLimits, check_name

POINTS = "points"
MOST_FIELD = 1000  # numbers of an array that is not of points


class NotVTK(ValueError):
    """Error for a file that is not of this format; the message says why, in few words."""


def make_xml_parser(refusal: Exception) -> expat.XMLParserType:
    """Returns a parser of XML in UTF-8, whatever encoding the file declares, that raises the ``refusal`` for document
    types and entities."""
    def refuse_doctype(*_: object) -> None:
        raise refusal

    parser = expat.ParserCreate("UTF-8")
    parser.StartDoctypeDeclHandler = parser.EntityDeclHandler = refuse_doctype
    return parser


@contextmanager
def xml_errors_named() -> Iterator[None]:
    """Raises :class:`NotVTK` with the reason where a parser of XML finds none."""
    try:
        yield
    except expat.ExpatError as error:
        raise NotVTK(f"no XML in UTF-8: {expat.ErrorString(error.code)}") from None


class PointData:
    """Data read from a VTK file called ``path``: positions and arrays of points, piece by piece, and ``fields``, the
    arrays that do not belong to points. Readers announce each array before they read it."""

    def __init__(self, path: str, limits: SizeLimits):
        self.path, self.fields = path, dict[str, np.ndarray]()
        self._limits, self._pieces = limits, defaultdict[str, list[np.ndarray]](list)
        self._rows, self._numbers, self._names, self._other = 0, 0, 0, set[str]()

    def begin_piece(self, rows: int) -> None:
        """Begins a piece of ``rows`` points."""
        self._other = set()
        if rows < 0:
            raise NotVTK("fewer than no points")
        self._limits.check_rows(self.path, self._rows + rows)
        self._rows += rows

    def wants(self, name: str, rows: int, width: int) -> bool:
        """Returns whether an array of points (rows, width) is needed. Raises an error for excess or duplicates."""
        self._names += 1
        self._limits.check_columns(self.path, self._names)
        check_name(self.path, name)
        if name in self._other:
            raise FileError(self.path, f"has two arrays called {quote(name)}; give each its own name")
        self._other.add(name)
        if min(rows, width) < 0:
            raise NotVTK("an array of fewer than no numbers")
        if not (is_known_name(name) or name == POINTS):
            self._pieces.setdefault(name, [])
            return False
        self._numbers += rows * width
        self._limits.check_numbers(self.path, self._numbers)
        return True

    def skip(self, name: str) -> None:
        """Notes an array that does not belong to points, and is not read."""
        self._pieces.setdefault(f"{name} (of cells)", [])

    def wants_field_data(self, name: str, numbers: int) -> bool:
        """Returns whether an array of so many numbers that does not belong to points is needed."""
        return self.wants(name, 1, 0 if numbers > MOST_FIELD else numbers) and 0 < numbers <= MOST_FIELD

    def add_array(self, name: str, values: np.ndarray, width: int) -> None:
        """Adds the values (n,) of an announced array, as rows of ``width`` numbers."""
        rows = values.reshape(-1, width) if width != 1 else values
        if self._pieces[name] and self._pieces[name][0].shape[1:] != rows.shape[1:]:
            raise NotVTK(f"pieces with different components of {quote(name, 20)}")
        self._pieces[name].append(rows)

    def concatenated_arrays(self) -> dict[str, np.ndarray]:
        """Returns all pieces concatenated, (n,) or (n, width) by name; arrays that are not needed are empty."""
        if POINTS not in self._pieces:
            raise FileError(self.path, "has no points; write points with data, in text or binary")
        return {name: pieces[0] if len(pieces) == 1 else np.concatenate(pieces) if pieces else np.empty(0)
                for name, pieces in self._pieces.items()}


def parse_numbers(text: bytes, count: int) -> np.ndarray:
    """Returns ``count`` numbers from text with blanks between. Raises NotVTK for fewer or for other text."""
    if not count:
        return np.empty(0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # raised for invalid numbers
        try:
            values = np.fromstring(text, dtype=float, sep=" ", count=count)
        except (ValueError, DeprecationWarning):
            values = np.empty(0)
    if len(values) != count:
        raise NotVTK(f"no {count:,} numbers where so many are announced")
    return values
