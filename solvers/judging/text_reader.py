"""Reader of particles as text, one in each line, as codes, spreadsheets and people write them.

Above the first row stands a line with as many names, in a comment or not, and perhaps others, such as the time. What
differs between tools (separator, decimal comma, quotes, comments, exponents, encoding) is found from these lines and
the rows; numpy reads the columns whose names are known, and no others.
"""

import io
import re
from collections.abc import Iterator, Sequence
from typing import IO

import numpy as np

from solvers.judging.column_names import add_scene, build_table, check_cell_count
from solvers.judging.particle_data_types import RawTable
from solvers.judging.quantity_names import TIMES, ColumnMeaning
from solvers.judging.text_layout import COMMENT, MOST_REMARKS, TextLayout, TextLayoutFinder, readable, too_many_remarks
from solvers.untrusted import number_parsing
from solvers.untrusted.quoting import FileError, quote
from solvers.untrusted.size_limits import LONGEST_LINE, SizeLimits

ENCODINGS = {b"\xef\xbb\xbf": "utf-8-sig", b"\xff\xfe": "utf-16", b"\xfe\xff": "utf-16"}  # by their first bytes
SAMPLE = 4096  # bytes
#: A time, alone in its line or after a step: not the end of a run, nor what it took on a clock.
TIME = re.compile(r"(?:^|[,;]|^(?:time)?step\s*[=:]?\s*\d+)\s*"
                  r"(?:t\s*[=:]|(?:(?:current|physical|simulation|solution)[ _]?)?time(?:\s*[\[(](?P<inside>\w+)[\])])?"
                  r"[\s=:;,]+)\s*(?P<number>[+-]?(?:\d+[.,]?\d*|\.\d+)(?:[ed][+-]?\d+)?)\s*(?P<unit>[^\W\d_]+)?"
                  r"\s*(?:$|[,;)])", re.IGNORECASE)
STATED = re.compile(r"(cells|scene)\s*[=:]\s*(\S+)\s*$", re.IGNORECASE)
#: Fortran's exponents: another letter, or none, where three digits leave no place for it (1.0-103).
FORTRAN_LETTER, LOST_LETTER = str.maketrans("dD", "ee"), re.compile(r"(?<=[\d.])([+-]\d{3})(?![\d.])")
#: As Fortran writes equal numbers, 3*0.0, in lines of so many letters at most.
REPEATED, MOST_LETTERS = re.compile(r"(?<![^\s,;])(\d{1,2})\*([^\s,;*]+)"), 10_000
DECIMAL_COMMA = str.maketrans(",.", ".'")  # a point beside decimal commas is none
COMMA, FORTRAN = "a decimal comma", "an exponent as in Fortran"


class TextReader:
    """Reader of an open file with the name ``path``, within ``limits``."""

    def __init__(self, path: str, file: IO[bytes], limits: SizeLimits):
        self._path, self._file, self._limits = path, file, limits
        encoding = self._find_encoding()  # bytes that are no UTF-8 are kept, for columns that are not read
        self._text = io.TextIOWrapper(file, encoding, "surrogateescape" if "8" in encoding else "strict")
        self._number, self._row = 0, ""  # of the line read last, and its text if it is a row
        self._texts, self._times = dict[str, str](), dict[int, float]()  # stated: by name; by the row below, in s

    def read(self) -> RawTable:
        """Returns the table. Raises FileError for a file that has none, or more than the limits allow."""
        try:
            layout = TextLayoutFinder(self._path, self._limits).find(self._lines())
            self._first_row = self._number
            known = layout.meanings()
            used = [k for k, name in enumerate(layout.names) if name in known]
            if not used:
                raise FileError(self._path, "has no number in the first row of any column that is known by name; give "
                                            "numbers in columns such as id, x, vx")
            self._check_names(layout.names, used)
            values = self._read_numbers(layout, used)
        except UnicodeDecodeError:
            raise self._no_text() from None
        finally:
            self._text.detach()  # whoever has opened the file closes it
        columns = {name: np.empty(0) for name in layout.names}
        columns |= {layout.names[k]: values[:, column] for column, k in enumerate(used)}
        time, cells = None, self._texts.get("cells")
        if len(self._times) > 1 and "t" not in {meaning.key for meaning in known.values()}:
            columns["t"], known["t"] = self._time_column(len(values)), ColumnMeaning("t", None)
        elif self._times:
            time = list(self._times.values())[-1]
        if cells is not None and not number_parsing.is_number(cells):
            raise FileError(self._path, "has {names} = {text}; give a number", "cells", quote(cells))
        count = check_cell_count(self._path, None if cells is None else number_parsing.parse_float(cells))
        return add_scene(build_table(self._path, columns, time, count, self._limits, known), self._texts.get("scene"))

    def _find_encoding(self) -> str:
        self._file.seek(0)
        sample = self._file.read(SAMPLE)
        for begin, encoding in ENCODINGS.items():
            if sample.startswith(begin):
                return encoding
        for odd, encoding in ((1, "utf-16-le"), (0, "utf-16-be")):
            if len(sample) > 1 and not any(sample[odd::2]):
                return encoding
        if b"\0" in sample:
            raise self._no_text()
        return "utf-8"

    def _no_text(self) -> FileError:
        return FileError(self._path, "is no text; give names in the first line and a particle in each other")

    def _lines(self) -> Iterator[str]:
        """Yields the lines that are not blank, from the first on."""
        self._text.seek(0)
        self._number = 0
        while line := self._text.readline(LONGEST_LINE):
            self._number += 1
            if len(line) >= LONGEST_LINE:
                raise FileError(self._path, "has a line of more than {n:,} letters; give a line for each particle",
                                LONGEST_LINE)
            if "*" in line and len(line) <= MOST_LETTERS:
                line = _repeat_numbers(line)
            if line[0].isdigit() or line.strip(" \t\r\n,;\""):
                yield line

    def _check_names(self, names: Sequence[str], used: Sequence[int]) -> None:
        """Raises FileError where a column that is read is there twice."""
        known = [names[k] for k in used]
        if (twice := next((name for name in known if known.count(name) > 1), None)) is not None:
            raise FileError(self._path, "has two columns called {twice}; give each its own name", quote(twice))

    def _read_numbers(self, layout: TextLayout, used: Sequence[int]) -> np.ndarray:
        """Returns the numbers of the columns ``used``, (n, columns)."""
        dialect: set[str] = set()
        columns = [layout.before + k for k in used]
        while True:
            try:
                rows = self._rows(layout, len(used), dialect)
                return np.loadtxt(rows, delimiter=layout.separator, usecols=columns, ndmin=2, dtype=float,
                                  comments=None, quotechar='"')
            except ValueError as error:
                if isinstance(error, (FileError, UnicodeDecodeError)):
                    raise
                dialect |= self._explain_row(layout, used, dialect)

    def _rows(self, layout: TextLayout, width: int, dialect: set[str]) -> Iterator[str]:
        """Yields the rows in a form that numpy reads, and stores what is stated between them."""
        count = 0
        most, remarks = min(self._limits.rows, self._limits.numbers // width), 0
        by_cell = layout.has_arrays or (COMMA in dialect and layout.separator == ",")
        self._times.clear()
        for line in self._lines():
            begins_with_digit = line[0].isdigit()  # as most rows do, and no comment and no heading
            if self._number < self._first_row or (not begins_with_digit and COMMENT.match(line)):
                self._store_stated(line, count)
                remarks += 1
                if remarks > MOST_REMARKS:
                    raise too_many_remarks(self._path)
                continue
            if not layout.fits(line):
                line = line.partition("#")[0]
                if not layout.fits(line):
                    if not self._is_remark(line, layout, count):
                        raise FileError(self._path, "has {names} columns, but {n} in line {line}; give as many in all "
                                        "lines", len(layout.names), len(layout.split(line)), self._number)
                    continue
            elif not begins_with_digit and readable(line).strip() == layout.heading:
                continue
            self._row, count = line, count + 1
            if count > most:
                self._limits.check_rows(self._path, count)
                self._limits.check_numbers(self._path, count, width)
            if by_cell:
                yield (layout.separator or " ").join(f'"{_translate(cell, dialect)}"' for cell in layout.cells(line))
            else:
                yield _translate(line, dialect) if dialect else line

    def _is_remark(self, line: str, layout: TextLayout, row: int) -> bool:
        """Returns whether a line between rows is a heading again or states a time, which is stored."""
        bare = readable(line).strip()
        return bare == layout.heading or self._store_stated(bare, row)

    def _store_stated(self, line: str, row: int) -> bool:
        """Stores what a line states of the rows from ``row`` on; returns whether it is a time."""
        bare = COMMENT.sub("", line, count=1)
        if found := STATED.match(bare):
            self._texts[found[1].lower()] = found[2]
        found = TIME.search(bare.strip())
        if found is None or (unit := TIMES.get(found["inside"] or found["unit"] or "s")) is None:
            return False
        number = found["number"].replace(",", ".").translate(FORTRAN_LETTER)
        if number_parsing.is_number(number):
            self._times[row] = number_parsing.parse_float(number) * unit
        return True

    def _time_column(self, count: int) -> np.ndarray:
        """Returns the time (n,) of each of ``count`` rows, from those stated above them."""
        if 0 not in self._times:
            raise FileError(self._path, "has rows before the first time that it states; give it above the rows")
        return np.repeat(list(self._times.values()), np.diff([*self._times, count]))

    def _explain_row(self, layout: TextLayout, used: Sequence[int], dialect: set[str]) -> set[str]:
        """Returns the peculiarities of numbers that the last row has beside those in the ``dialect``. Raises FileError
        where a cell is no number with them."""
        cells = layout.split(self._row)
        for k in used:
            cell = cells[k] if k < len(cells) else ""
            name, line = quote(layout.names[k]), self._number
            if not cell:
                raise FileError(self._path, "has nothing in the column {name} of line {line}; give a number in all "
                                            "rows, or leave the column out", name, line)
            if COMMA in dialect and "." in cell:
                raise FileError(self._path, "has {cell} in the column {name} of line {line}, beside numbers with a "
                                            "decimal comma; give one decimal sign in all rows", quote(cell, 30), name,
                                line)
            plain, found = cell, set[str]()
            if "," in plain:
                plain, found = plain.replace(",", "."), found | {COMMA}
            if (written := LOST_LETTER.sub(r"e\1", plain.translate(FORTRAN_LETTER))) != plain:
                plain, found = written, found | {FORTRAN}
            if not number_parsing.NUMERAL.fullmatch(plain) and plain.lower().strip("+-") not in ("nan", "inf"):
                raise FileError(self._path, "has {cell} in the column {name} of line {line}; give a number in all "
                                            "rows", quote(cell, 30), name, line)
            if found - dialect:
                return found
        raise FileError(self._path, "has a row in line {line} that cannot be read; give a number in every column",
                        self._number)


def _translate(text: str, dialect: set[str]) -> str:
    """Returns a text whose numbers have the peculiarities of a ``dialect`` with numbers as numpy reads them."""
    if FORTRAN in dialect:
        text = LOST_LETTER.sub(r"e\1", text.translate(FORTRAN_LETTER))
    return text.translate(DECIMAL_COMMA) if COMMA in dialect else text


def _repeat_numbers(line: str) -> str:
    """Returns a line with equal numbers written out, with the separator of the line between."""
    between = next((mark for mark in ";," if mark in line), " ")
    return REPEATED.sub(lambda found: between.join([found[2]] * int(found[1])), line)
