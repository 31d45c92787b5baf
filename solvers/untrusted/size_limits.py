"""Size limits of files, which are checked before memory is allocated, because a file may claim any size.

A number needs eight bytes when it is read, however few it has in the file. Matching and comparison need as much again:
with these limits every file is rejected within a gigabyte.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from solvers.translatable_message import Message
from solvers.untrusted.quoting import FileError, quote

FEWER = Message(", fewer times for example")


@dataclass(frozen=True)
class SizeLimits:
    """Upper limits of a file, or of several judged together: ``bytes`` on disk and unpacked, ``columns`` or arrays,
    ``rows`` (particles of all times), ``numbers`` and ``times``. Each check raises FileError for more."""

    bytes: int
    columns: int
    rows: int
    numbers: int
    times: int
    otherwise: str = ""  # what else one can do, for the end of a sentence

    def check_bytes(self, file: str, size: int) -> None:
        if size > self.bytes:
            raise self._refusal(file, Message("has {size:,.0f} MB", size / 1e6), f"{self.bytes / 1e6:,.0f} MB" + FEWER)

    def check_unpacked(self, file: str, size: int) -> None:
        if size > self.bytes:
            raise self._refusal(file, Message("unpacks to {size:,.0f} MB", size / 1e6), f"{self.bytes / 1e6:,.0f} MB")

    def check_columns(self, file: str, count: int) -> None:
        if count > self.columns:
            raise self._refusal(file, Message("has {count:,} columns or arrays", count), f"{self.columns:,}")

    def check_rows(self, file: str, rows: int) -> None:
        if rows > self.rows:
            raise self._refusal(file, Message("has {rows:,} particles of all times together", rows), f"{self.rows:,}")

    def check_numbers(self, file: str, *counts: int) -> None:
        """Raises FileError for too many numbers: the product of ``counts``, which are as the file claims them."""
        total = math.prod(counts)
        if min(counts, default=0) < 0 or total > self.numbers:
            told = f"{total:,}" if abs(total) < 10**15 else Message("10¹⁵ or more")
            raise self._refusal(file, Message("has {told} numbers", told), f"{self.numbers:,}" + FEWER)

    def check_times(self, file: str, times: int) -> None:
        if times > self.times:
            raise self._refusal(file, Message("has {times:,} times", times), f"{self.times:,}")

    def remaining_after(self, columns: Mapping[str, np.ndarray]) -> "SizeLimits":
        """Returns the limits with the rows and numbers of these columns (n, ...), by name, subtracted."""
        rows = len(next(iter(columns.values())))
        numbers = sum(column.size for column in columns.values())
        return replace(self, rows=max(0, self.rows - rows), numbers=max(0, self.numbers - numbers))

    def _refusal(self, file: str, has: str, most: str) -> FileError:
        return FileError(file, "{has}; give at most {most}{otherwise}", has, most, self.otherwise)


LIMITS = SizeLimits(bytes=500_000_000, columns=1000, rows=4_000_000, numbers=40_000_000, times=10_000)
LONGEST_NAME = 200  # letters of a column's name
LONGEST_LINE = 250_000  # letters of a line of text


def check_name(file: str, name: str) -> None:
    """Raises FileError for a column's name of more than 200 letters, which would take long to parse."""
    if len(name) > LONGEST_NAME:
        raise FileError(file, "has a column or an array with a name of {count:,} letters ({name}); give at most {most}",
                        len(name), quote(name, 30), LONGEST_NAME)
