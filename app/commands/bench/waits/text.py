"""The table of what people wait for, as Markdown: it is read in a terminal and stands in documents."""

from typing import Any


def waits_table(found: dict[str, Any], /) -> str:
    """A line for each row, with what went before where that was measured."""
    machine, beside = found["machine"], found["beside"]
    heads = ["what is waited for", "unit", *["before"] * beside, "now", *["now / before"] * beside, "others"]
    lines = [f"{machine['system']} {machine['processor']}, {machine['cores']} cores, Python {machine['python']}, "
             f"Taichi {machine['taichi']}; medians of turns, the least and the most in brackets; *others*: processors "
             "that other work had meanwhile", "",
             _line(heads), _line([":--", ":--", *["--:"] * (len(heads) - 2)])]
    for row in found["rows"]:
        columns = [_spread(row["before"]), _spread(row["now"]), _ratio(row)] if beside else [_spread(row["now"])]
        load = "" if row["load"] is None else f"{row['load']:.2f}"
        lines.append(_line([row["name"], row["unit"], *columns, load]))
    reasons = dict.fromkeys(f"{row['name']}: {spread['missing']}" for row in found["rows"]
                            for spread in (row.get("before", {}), row["now"]) if spread.get("missing"))
    return "\n".join([*lines, *([""] if reasons else []), *reasons])


def _line(cells: list[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _spread(values: dict[str, Any]) -> str:
    if values["median"] is None:
        return "none"
    if values["turns"] < 2:
        return _number(values["median"])
    return f"{_number(values['median'])} ({_number(values['least'])}–{_number(values['most'])})"


def _ratio(row: dict[str, Any]) -> str:
    before, now = row["before"]["median"], row["now"]["median"]
    return "" if not before or now is None else f"{now / before:.2f}"


def _number(value: float) -> str:
    return f"{value:.1f}" if value >= 10 else f"{value:.2f}"
