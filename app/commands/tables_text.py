"""A table's JSON object as Markdown: the paper's numbers, ours and their ratio, then what each estimator says."""

from __future__ import annotations

from collections.abc import Iterable

from solvers.samples import QUANTITIES
from solvers.tables.digits import digits

DASH = "–"
METHODS = {"ugimp": "uGIMP", "cpgimp": "cpGIMP", "cpdi": "CPDI"}
SYMBOLS = {"x": "x", "v": "v", "sigma": "σ", "a": "a"}
#: What is compared with the paper in each table: key and heading with the unit.
COMPARED = {"1": {"x": "x (m)", "v": "v (m/s)", "sigma_log": "σ (Pa)", "grid_crossings": "crossings"},
            "2": {"x": "x (m)", "v": "v (m/s)", "a_nodes": "Err A (m/s²)"},
            "3": {"index_x": "index of x, transport"}}


class Footnotes:
    """Sentences under the table, each once."""

    def __init__(self) -> None:
        self._numbers: dict[str, int] = {}

    def mark(self, sentence: str) -> str:
        """The mark of a sentence, which is added if it is new."""
        return f"[^{self._numbers.setdefault(sentence, len(self._numbers) + 1)}]"

    def lines(self) -> list[str]:
        return [f"[^{number}]: {sentence}" for sentence, number in self._numbers.items()]


def markdown(table: dict) -> str:
    """The whole file."""
    notes = Footnotes()
    blocks = [f"# {table['title']}", *table["setup"]]
    for part, rows in parts(table).items():
        blocks += [f"## {part}", _comparison(table["table"], rows, notes)]
        if table["table"] != "2":
            blocks += [f"Index of each estimator, its distance and its cost — {part}:", _estimators(table, rows, notes)]
    seconds = table["seconds"]
    blocks.append(f"These runs took {seconds['run']:.0f} s, and {seconds['setup'] + seconds['compile']:.0f} s to set "
                  "up and compile.")
    return "\n\n".join([*blocks, *notes.lines()]) + "\n"


def parts(table: dict) -> dict[str, list[dict]]:
    """The rows under each heading, in order."""
    found: dict[str, list[dict]] = {}
    for row in table["rows"]:
        found.setdefault(row["part"], []).append(row)
    return found


def _comparison(number: str, rows: list[dict], notes: Footnotes) -> str:
    """Ours, the paper's and the ratio, one line a row."""
    heads = _row_heads(rows)
    for key, heading in COMPARED[number].items():
        ours = [f"{heading} to {rows[0]['inputs'][end]:g} s" for end in ("t_end_crossings", "t_end")] \
            if key == "grid_crossings" else [heading]
        heads += [*ours, "paper", "ratio"]
    others = [name for name in rows[0]["estimators"] if name != "transport"] if number == "3" else []
    heads += others
    lines = []
    for row in rows:
        cells = _row_cells(row, notes)
        for key in COMPARED[number]:
            cells.append(_ours(row, key, notes))
            if key == "grid_crossings":
                cells.append(_count(row["ours"]["grid_crossings_short"]))
            cells += [_printed(key, row["paper"][key]), _factor(row["ratio"][key])]
        lines.append([*cells, *(_index_of_x(row, name, notes) for name in others)])
    return _grid(heads, lines)


def _ours(row: dict, key: str, notes: Footnotes) -> str:
    value = row["ours"][key]
    if key == "index_x":
        return _index_of_x(row, "transport", notes)
    return _count(value) if key == "grid_crossings" else size(value)


def _estimators(table: dict, rows: list[dict], notes: Footnotes) -> str:
    """Index, distance and cost, one line for each estimator of a row; the paper's indices of Table 1 above them."""
    heads = [*_row_heads(rows), "estimator", *(f"index {s}" for s in SYMBOLS.values()),
             *(f"distance {s}" for s in SYMBOLS.values()), "cost"]
    lines = []
    for row in rows:
        if table["table"] == "1":
            printed = [_printed(f"index_{q}", row["paper"].get(f"index_{q}")) for q in QUANTITIES]
            lines.append([*_row_cells(row, notes), "the paper's, printed", *printed, *[DASH] * 5])
        for name, said in row["estimators"].items():
            values = [_factor(said[kind][q]) for kind in ("index", "distance") for q in QUANTITIES]
            lines.append([*_row_cells(row, notes), name + _why(name, said, notes), *values, _percent(said["cost"])])
    return _grid(heads, lines)


def _index_of_x(row: dict, name: str, notes: Footnotes) -> str:
    """An estimator's index; where it does not hold, a dash and why."""
    said = row["estimators"].get(name)
    return _factor(said["index"]["x"]) + _why(name, said, notes) if said else DASH


def _why(name: str, said: dict, notes: Footnotes) -> str:
    """The mark of the sentence in which an estimator says that it does not hold; nothing where it does."""
    return notes.mark(f"{name}: {said['not_valid']}") if said["not_valid"] else ""


def _row_heads(rows: list[dict]) -> list[str]:
    return ["method", "cells"] if rows[0]["inputs"]["problem"] == "ring" else ["cells"]


def _row_cells(row: dict, notes: Footnotes) -> list[str]:
    scene = row["inputs"]
    cells = str(scene["cells"]) + (notes.mark(row["unstable"]) if row["unstable"] else "")
    return [METHODS[scene["method"]], cells] if scene["problem"] == "ring" else [cells]


def _grid(heads: list[str], lines: Iterable[list[str]]) -> str:
    rows = [heads, [":---" if head in ("method", "estimator") else "---:" for head in heads], *lines]
    return "\n".join("| " + " | ".join(row) + " |" for row in rows)


def size(value: float | None) -> str:
    """A size with three digits, as short as it goes: 3.49e-6."""
    if value is None:
        return DASH
    return digits(value, 3)


def _printed(key: str, value: float | None) -> str:
    """A number of the paper, with the digits that it has."""
    if value is None:
        return DASH
    if key == "grid_crossings":
        return _count(round(value))
    if key.startswith("index"):
        return f"{value:.1f}" if value < 10 and value == round(value, 1) else f"{value:g}"
    return digits(value, 2)


def _count(value: int | None) -> str:
    return DASH if value is None else f"{value:,}"


def _factor(value: float | None) -> str:
    """A ratio or an index: two digits at least, hundredths where they mean something."""
    if value is None:
        return DASH
    if value >= 1000 or value == 0:
        return f"{value:,.0f}"
    return f"{value:.2f}" if 0.1 <= value < 9.995 else f"{value:.3g}" if value > 1 else digits(value, 2)


def _percent(value: float | None) -> str:
    return DASH if value is None else f"{100 * value:.0f} %"
