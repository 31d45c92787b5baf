"""Layout of particles as text: which line above the first row has the names, and how cells are separated."""

import csv
import functools
import re
from collections import deque
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from solvers.judging.particle_data_types import list_names
from solvers.judging.quantity_names import ColumnMeaning, find_meanings, is_unit
from solvers.untrusted.quoting import FileError
from solvers.untrusted.size_limits import SizeLimits, check_name

MOST_REMARKS = 100_000  # lines that are no rows
MOST_HEADINGS, MOST_UNNAMED = 30, 100  # lines above the first row, and rows that no heading fits, that are looked at
COMMENT = re.compile(r"\s*(?:#|%|//|!)[#%/!]*\s*")
SEPARATORS: tuple[str | None, ...] = ("\t", ";", "|", ",", None)  # None: blanks
SPREADSHEET = re.compile(r'"?sep=([,;|\t])"?\s*', re.IGNORECASE)  # a first line for spreadsheets alone
#: What stands before the names, as LAMMPS, Tecplot and people write it.
BEFORE_NAMES = re.compile(r"(?:ITEM:\s*ATOMS|VARIABLES\s*=|(?:columns|fields|names)\s*[:=])\s*", re.IGNORECASE)
NUMBER = re.compile(r"\s*\"?\s*(?:[+-]?(?:\d+[.,]?\d*|[.,]\d+)(?:[ed]?[+-]?\d+)?|[+-]?inf(?:inity)?|nan)\s*\"?\s*",
                    re.IGNORECASE | re.ASCII)


MOST_COMPONENTS = 9  # of an array in a cell


@dataclass(frozen=True)
class TextLayout:
    """Layout of rows: the ``names`` of columns, the separator, the number of cells ``before`` the first of them, the
    line with the names, and the first row."""

    names: list[str]
    separator: str | None
    before: int
    heading: str
    first_row: str

    def meanings(self) -> dict[str, ColumnMeaning]:
        """Returns the meanings of the columns that are read, by name: those of known quantities, except where the first
        row has no number in one of its columns, and positions need none of it."""
        known, cells = find_meanings(self.names), dict(zip(self.names, self.split(self.first_row), strict=False))
        texts = {known[name].key for name in known if not NUMBER.fullmatch(cells[name])} - {"t", "x"}
        return {name: meaning for name, meaning in known.items() if meaning.key not in texts}

    @functools.cached_property
    def has_arrays(self) -> bool:
        """Whether cells have arrays, of which each number has a name."""
        return any(len(split_array(cell)) > 1 for cell in split_line(self.first_row, self.separator))

    def cells(self, row: str) -> list[str]:
        """Returns the cells of a row, a cell for each number of an array."""
        cells = split_line(row, self.separator)
        return [part for cell in cells for part in split_array(cell)] if self.has_arrays else cells

    def split(self, row: str) -> list[str]:
        """Returns the cells of the named columns."""
        return self.cells(row)[self.before:]

    def fits(self, line: str) -> bool:
        """Returns whether a line has as many cells as there are names, or an empty one more at its end."""
        count = self.before + len(self.names)
        if '"' in line or self.has_arrays:
            cells = self.cells(line)
            return len(cells) == count or (len(cells) == count + 1 and not cells[-1])
        if self.separator is None:
            return len(line.split()) == count
        found = line.count(self.separator) + 1
        return found == count or (found == count + 1 and line.rstrip(" \r\n").endswith(self.separator))


def split_line(line: str, separator: str | None) -> list[str]:
    """Returns the cells of a line, without blanks and quotes around; the separator None is any number of blanks."""
    if '"' in line and len(line) < csv.field_size_limit():
        line = line.replace("\t", " ").strip() if separator is None else line
        cells = next(csv.reader([line.strip("\r\n")], delimiter=separator or " ", skipinitialspace=True), [])
    else:
        cells = line.split(separator)
    return [cell.strip(" \t\r\n'") for cell in cells]


def split_array(cell: str) -> list[str]:
    """Returns the numbers of an array in a cell, such as [0.1, 0.2] or (0.1 0.2); other cells as they are."""
    if cell[:1] not in ("[", "("):
        return [cell]
    parts = re.split(r"[\s,;\[\]()]+", cell.strip("[]() "))
    return parts if len(parts) <= MOST_COMPONENTS and all(map(NUMBER.fullmatch, parts)) else [cell]


class TextLayoutFinder:
    """Search for the layout of a text with the name ``path``."""

    def __init__(self, path: str, limits: SizeLimits):
        self._path, self._limits = path, limits
        self._too_long: FileError | None = None  # of what could be a heading

    def find(self, lines: Iterable[str]) -> TextLayout:
        """Returns the layout from the first ``lines``, up to the first row that one of those above fits. Raises
        FileError where there is none."""
        above, separators = deque[str](maxlen=MOST_HEADINGS), SEPARATORS
        unnamed, unknown = list[str](), None
        for count, line in enumerate(lines):
            mark = COMMENT.match(line)
            bare = readable(line[mark.end():] if mark else line)
            if mark is None and (found := SPREADSHEET.fullmatch(bare.strip())) and not above:
                separators = (found[1],)
                continue
            if mark is None:
                known, layout = max((self._fit_heading(above, row, separators) for row in
                                     dict.fromkeys((line, line.partition("#")[0]))), key=lambda fit: fit[0])
                if known and layout is not None:
                    return layout
                unknown = unknown or layout
            if mark is None and all(map(NUMBER.fullmatch, re.split(r"[\s,;]+", bare.strip(" \t\r\n,;")))):
                unnamed.append(bare)
                if len(unnamed) > MOST_UNNAMED:
                    break
            else:
                above.append(bare)
            if count > MOST_REMARKS:
                raise too_many_remarks(self._path)
        if self._too_long is not None:
            raise self._too_long
        if unknown is not None:
            some = list_names(unknown.names, 8)
            raise FileError(self._path, "holds no particles that are known by name, but {some}; give columns such as "
                                        "id, x, vx", some)
        if not unnamed:
            raise FileError(self._path, "holds no particles; give names in the first line and a particle in each other")
        if not above:
            raise FileError(self._path, "has no names in its first line; begin with a line such as id,x,vx")
        names, numbers = (min((split_line(line, separator) for separator in separators), key=_blank_cells)
                          for line in (above[-1], unnamed[0]))
        raise FileError(self._path, "has {names} names and {width} numbers in a line; give as many of both", len(names),
                        len(numbers))

    def _fit_heading(self, above: Sequence[str], row: str,
                     separators: Sequence[str | None]) -> tuple[int, TextLayout | None]:
        """Returns the number of known names in the line ``above`` that has most, of those with as many names as a row
        has cells, and the layout; None where none has, or the row has no number."""
        fitting: list[tuple[int, int, int, TextLayout | None]] = [(0, 0, 0, None)]
        for separator in separators:
            cells = split_line(row, separator)
            if not any(NUMBER.fullmatch(split_array(cell)[0]) for cell in cells):
                continue
            for k, line in enumerate(above):
                for other in dict.fromkeys((separator, *separators)):
                    if other is None and re.search("[,;]", line) and '"' not in line:
                        continue
                    names = split_line(BEFORE_NAMES.sub("", line), other)
                    before = self._cells_before(names, cells, row)
                    if before is not None:
                        names = _with_units(names, split_line(above[k + 1], other) if k + 1 < len(above) else ())
                        names = _with_components(names, cells[before:])
                        layout = TextLayout(names, separator, before, line.strip(), row)
                        fitting.append((len(find_meanings(names)), len(names), k, layout))
        known, _, _, best = max(fitting, key=lambda one: one[:3])
        return known, best

    def _cells_before(self, names: list[str], cells: Sequence[str], row: str) -> int | None:
        """Returns how many cells of the first row stand before those with names, None where the names do not fit the
        cells; takes empty names from the end."""
        full = len(cells) - (not cells[-1])
        while len(names) > full and not names[-1]:
            names.pop()
        # Names of rows, as R writes them, have no name above.
        before = int(len(cells) == len(names) + 1 and row.lstrip().startswith('"'))
        if not names or len(names) + before not in (full, len(cells)) or all(map(NUMBER.fullmatch, names)):
            return None
        try:
            self._limits.check_columns(self._path, len(names))
            for name in names:
                check_name(self._path, name)
        except FileError as error:
            self._too_long = error
            return None
        return before


def _with_units(names: list[str], below: Sequence[str]) -> list[str]:
    """Returns names with the units of the line below them, if that has a unit for each."""
    units = [cell.strip("[]()") for cell in below]
    are_units = len(units) == len(names) and any(units) and all(unit in ("", "-") or is_unit(unit) for unit in units)
    return [f"{name} [{unit}]" for name, unit in zip(names, units, strict=True)] if are_units else names


def _with_components(names: list[str], cells: Sequence[str]) -> list[str]:
    """Returns names with one for each number of an array in the cell below, counted from 0 before the unit."""
    counts = [len(split_array(cell)) for cell in cells[:len(names)]]
    return [name if count == 1 else re.sub(r"\s*(?=[\[(]|$)", str(k), name, count=1)
            for name, count in zip(names, counts, strict=True) for k in range(count)]


def _blank_cells(cells: Sequence[str]) -> tuple[int, int]:
    """Returns how badly a line is split in such cells: those with blanks or signs within, and fewer cells."""
    return sum(bool(re.search(r"[\s,;]", cell)) for cell in cells), -len(cells)


def readable(line: str) -> str:
    """Returns a line whose bytes were no UTF-8 as Windows writes it."""
    return line if line.isascii() else line.encode("utf-8", "surrogateescape").decode("cp1252", "replace") \
        if any("\udc80" <= letter <= "\udcff" for letter in line) else line


def too_many_remarks(path: str) -> FileError:
    return FileError(path, "has more than {most:,} lines that are no particles; leave them out", MOST_REMARKS)
