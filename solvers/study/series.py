"""Rows that belong on one line: alike in every input but one."""

import json
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass

from solvers.solver.samples import QUANTITIES
from solvers.solver.soundness import OK
from solvers.study.fit import Slope, slope

TIME_INPUTS = ("dt", "cfl")


@dataclass(frozen=True)
class Series:
    """``rows`` differ in one input, by which they are sorted; ``inputs`` are the others that vary in the study."""

    rows: tuple[dict, ...]
    inputs: dict

    @property
    def method(self) -> str:
        return self.rows[0]["scene"]["method"]

    @property
    def variant(self) -> tuple:
        """What tells it from other series of the same method."""
        return tuple((name, value) for name, value in self.inputs.items() if name != "method")

    def label(self, names: dict[str, str] | None = None) -> str:
        """Its inputs in words; ``names`` spells methods out."""
        method = (names or {}).get(self.method, self.method)
        words = {"amplitude": "A", "modulus": "E"}
        return ", ".join([method, *(f"{words.get(name, name.replace('_', ' '))} {_shown(value)}"
                                    for name, value in self.variant)])

    def fit(self, quantity: str, norm: str = "max") -> Slope | None:
        """The order of the error in h, over the rows that stood."""
        rows = [row for row in self.rows if row["status"] == OK]
        return slope([row["h"] for row in rows], [error_of(row, quantity, norm) or 0 for row in rows])


def error_of(row: dict, quantity: str, norm: str = "max") -> float | None:
    """A true error out of a row, None where there is none."""
    return ((row.get("error") or {}).get(quantity) or {}).get(norm)


def measured(rows: Iterable[dict]) -> list[dict]:
    """The rows of runs: neither refused nor failed."""
    return [row for row in rows if row.get("seconds")]


def varying(rows: Sequence[dict]) -> list[str]:
    """The inputs, as they were asked for, that are not the same in all rows."""
    names = dict.fromkeys(name for row in rows for name in row["asked"])
    return [name for name in names if len({json.dumps(row["asked"].get(name)) for row in rows}) > 1]


def series(rows: Sequence[dict], along: str = "cells") -> list[Series]:
    """The measured rows as lines along one input. ``along`` may be ``dt``: then steps given as cfl count too."""
    rows = measured(rows)
    ignored = TIME_INPUTS if along in TIME_INPUTS else (along,)
    others = [name for name in varying(rows) if name not in ignored]
    lines: dict[str, list[dict]] = {}
    for row in rows:
        lines.setdefault(json.dumps([row["asked"].get(name) for name in others]), []).append(row)
    return [Series(tuple(sorted(line, key=lambda row: row["scene"][along])),
                   {name: line[0]["asked"].get(name) for name in others}) for line in lines.values()]


def fits(rows: Sequence[dict], norm: str = "max") -> list[dict]:
    """The order in h of each quantity and each series with two or more h, as plain values."""
    found = []
    for line in series(rows):
        orders = {quantity: line.fit(quantity, norm) for quantity in QUANTITIES}
        if any(orders.values()):
            found.append({"method": line.method, **line.inputs, "norm": norm,
                          "orders": {quantity: fit and asdict(fit) for quantity, fit in orders.items()}})
    return found


def _shown(value: object) -> str:
    if isinstance(value, bool):
        return "on" if value else "off"
    if isinstance(value, (list, tuple)):
        return " ".join(value) or "none"
    return "default" if value is None else f"{value:g}" if isinstance(value, float) else str(value)
