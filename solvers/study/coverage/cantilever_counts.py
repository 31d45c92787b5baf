"""Counts of how often error bars of random cantilevers held, and how far estimates were off; and their tables."""

from collections.abc import Callable, Mapping, Sequence

from solvers.solver.soundness import OK
from solvers.study.coverage.estimate_coverage_counts import count_statuses, median_if_any
from solvers.study.coverage.random_cantilevers import CELLS, LENGTHS, PERIODS, POISSONS_RATIOS, PPC, SLOPES
from solvers.study.markdown_tables import markdown_table

SCHEMA = "mpm-lab/body-coverage/1"
QUANTITIES = {"x": "x", "v": "v", "sigma": "σ"}
TRUSTS = {"number": "a number", "30 %": "± 30 %", "none": "none"}
NOTHING = "–"


def tally_cantilevers(seed: int, rows: Sequence[Mapping]) -> dict:
    """Returns counts of rows of random cantilevers (``random_cantilevers.measure``) as a dict for JSON: runs by status;
    by goal the bars that held, also twice as wide, with the median of bar over true error (``width``) and of true error
    over value; by quantity and trust the number of runs, with least, median and largest index."""
    usable = [row for row in rows if row["status"] == OK]
    return {"schema": SCHEMA, "problem": "body", "seed": seed, "runs": len(rows),
            "status": count_statuses(rows),
            "goals": {name: _count_bars([row["goals"][name] for row in usable])
                      for name in dict.fromkeys(name for row in usable for name in row["goals"])},
            "estimates": {q: {trust: _index_range([row["estimates"][q]["index"] for row in usable
                                                   if q in row["estimates"] and row["estimates"][q]["trust"] == trust])
                              for trust in TRUSTS} for q in QUANTITIES}}


def error_over_bar(goal: Mapping) -> float | None:
    """Returns the true error of a row's goal over its bar, at most 1 where the bar holds; None without a bar."""
    if goal["bar"] is None or goal["true"] is None:
        return None
    return abs(goal["value"] - goal["true"]) / max(goal["bar"], 1e-300)


def _count_bars(goals: Sequence[Mapping]) -> dict:
    known = [(goal, off) for goal in goals if (off := error_over_bar(goal)) is not None]
    return {"runs": len(known), "held": sum(off <= 1 for _, off in known), "twice": sum(off <= 2 for _, off in known),
            "width": median_if_any([1 / off for _, off in known if off]),
            "error": median_if_any([off * goal["bar"] / abs(goal["true"]) for goal, off in known])}


def _index_range(indices: Sequence[float]) -> dict:
    return {"runs": len(indices), "least": min(indices, default=None), "median": median_if_any(indices),
            "most": max(indices, default=None)}


def cantilever_summary(counted: Mapping, picture: str = "") -> str:
    """Returns counts (:func:`tally_cantilevers`) as Markdown: text, tables, a ``picture`` (path) unless ""."""
    statuses = ", ".join(f"{count} {status}" for status, count in counted["status"].items())
    parts = ["# How often error bars hold: random cantilevers",
             f"{counted['runs']:,} runs of seed {counted['seed']}: {statuses}. Beams of {LENGTHS[0]:g} to "
             f"{LENGTHS[-1]:g} m by 1 m, Poisson's ratio {POISSONS_RATIOS[0]:g} to {POISSONS_RATIOS[-1]:g}, static "
             f"deflection of the tip {SLOPES[0]:g} to {SLOPES[1]:g} of the length, {CELLS[0]} to {CELLS[-1]} cells per "
             f"metre, {PPC[0]} to {PPC[-1]} particles per cell and direction, anywhere between the grid's lines, "
             f"{PERIODS:g} periods. The truth is a much finer companion. Only runs that ended as ok count.",
             goals_table(counted),
             indices_table(counted), *([f"![How often error bars hold]({picture})"] if picture else [])]
    return "\n\n".join(parts)


def goals_table(counted: Mapping) -> str:
    """Returns the table of bars, a row per goal."""
    return markdown_table(
        ("goal", "bars", "held", "held, twice as wide", "median bar over true error", "median true error"),
        [(name, str(one["runs"]), str(one["held"]), str(one["twice"]), _text(one["width"], "{:.2f}".format),
          _text(one["error"], "{:.2%}".format)) for name, one in counted["goals"].items()])


def indices_table(counted: Mapping) -> str:
    """Returns the table of indices, a row per quantity and trust."""
    return markdown_table(
        ("estimate of", "says", "runs", "median index", "least", "largest"),
        [(QUANTITIES[q], TRUSTS[trust], str(one["runs"]),
          *(_text(one[key], "{:.3f}".format) for key in ("median", "least", "most")))
         for q, trusts in counted["estimates"].items() for trust, one in trusts.items()])


def _text(value: float | None, form: Callable[[float], str]) -> str:
    return NOTHING if value is None else form(value)
