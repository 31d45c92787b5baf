"""Counts of random runs as tables in Markdown."""

import math
from collections.abc import Iterable, Mapping, Sequence

from solvers.running.quantities_of_interest import DISPLACEMENT, ENERGY, SAFETY, STRESS
from solvers.study.coverage import estimate_coverage_counts
from solvers.study.coverage.estimate_coverage_counts import (
    COARSEST_CELLS,
    FACTORS,
    INTERVALS,
    NEEDLESS,
    NO_ORDER,
    ORDERS,
    REGIMES,
    wilson_interval,
)
from solvers.study.coverage.random_runs import AFTER, BEFORE, IMPOSSIBLE, QUANTITIES, draw_ranges_of
from solvers.study.markdown_tables import markdown_table

NOTHING = "–"
CLOSE = 0.1  # to 1: a multiple that is shown with more digits
GOALS = {DISPLACEMENT: "displacement of a point", STRESS: "mean stress", ENERGY: "kinetic energy"}
PARTS = {"x": "x", "v": "v", "sigma": "σ"}


def coverage_summary(counted: Mapping, picture: str = "") -> str:
    """Returns a problem's counts (``coverage_counts.tally``) as Markdown: text, tables, a picture (path) unless ""."""
    statuses = ", ".join(f"{count} {status}" for status, count in counted["status"].items())
    ranges = draw_ranges_of(counted["problem"])
    parts = [f"# How often estimates are right: {counted['problem']}",
             f"{counted['runs']:,} runs of seed {counted['seed']}: {statuses}. Drawn from {ranges.cells[0]} to "
             f"{ranges.cells[1]} cells, {ranges.ppc[0]} to {ranges.ppc[1]} particles per cell, amplitudes of "
             f"{ranges.amplitude[0]:g} to {ranges.amplitude[1]:g}, {ranges.periods[0]:g} to {ranges.periods[1]:g} "
             f"periods, steps of {ranges.step[0]:g} to {ranges.step[1]:g} of the longest, up to {ranges.work:,.0f} "
             "particle-steps. Only runs that ended as ok count.",
             estimates_table(counted), central_ranges_table(counted), motion_regimes_table(counted),
             refusals_table(counted), error_bars_table(counted), regime_error_bars_table(counted),
             grid_index_table(counted), by_truth_table(counted)]
    return "\n\n".join([*parts, *([f"![{picture}]({picture})"] if picture else [])]) + "\n"


def estimates_table(counted: Mapping) -> str:
    """Returns Markdown: how often each estimator was within each factor of the true error, from a tally's counts."""
    lines = []
    for name, split in counted["estimators"].items():
        for q in QUANTITIES:
            found = split["all"][q]
            if found["runs"]:
                shares = [format_share(found["within"][f"{f:g}"], found["runs"], f == FACTORS[0]) for f in FACTORS]
                lines.append([name, PARTS[q], f"{found['runs']}", *shares, f"{found['median']:.3f}"])
    return ("## The estimate within a factor of the true error\n\nShares of the runs in which the estimator speaks, in "
            "per cent, the first with its 95 % interval; norms over the whole run.\n\n"
            + markdown_table(["estimator", "of", "runs", *(f"factor {f:g}" for f in FACTORS), "median index"], lines))


def central_ranges_table(counted: Mapping) -> str:
    """Returns Markdown: between which multiples of each estimate the central 80 % of true errors were at the end."""
    lines = [[name, *(_central_range_text(split["all"][q]["at the end"]["middle"]) for q in QUANTITIES)]
             for name, split in counted["estimators"].items()]
    percent = 100 * estimate_coverage_counts.CENTRAL
    return f"## Where {percent:g} of 100 true errors lie\n\nAt the end of the run, in multiples of the " \
        "estimate; as many lie below as above. Between these an estimator bets in lesson 10.\n\n" \
        + markdown_table(["estimator", *(PARTS[q] for q in QUANTITIES)], lines)


def motion_regimes_table(counted: Mapping) -> str:
    """Returns Markdown: how often x was within a factor of 1.1, by how far particles move and by method."""
    least = f"{FACTORS[0]:g}"
    lines = []
    for name, split in counted["estimators"].items():
        found = [*(split["regime"][one]["x"] for one in REGIMES), *(each["x"] for each in split["method"].values())]
        lines.append([name, *(f"{one['within'][least]} of {one['runs']}" if one["runs"] else NOTHING for one in found)])
    methods = list(next(iter(counted["estimators"].values()))["method"])
    return (f"## Where: x within a factor of {least}\n\nBy how far particles move at most, and by method: runs in "
            "which it was so, of those in which the estimator speaks.\n\n"
            + markdown_table(["estimator", *REGIMES, *methods], lines))


def refusals_table(counted: Mapping) -> str:
    """Returns Markdown: how often estimators were refused, and how often needlessly, from a tally's counts."""
    lines = []
    for name, found in counted["refusals"].items():
        cells = [f"{found[kind]['needless']} of {found[kind]['told']}" if found[kind]["told"] else NOTHING
                 for kind in (BEFORE, AFTER)]
        lines.append([name, f"{found[BEFORE]['runs']}", cells[0], f"{found[AFTER]['runs']}", cells[1],
                      f"{found[IMPOSSIBLE]['runs']}"])
    return (f"## Not valid here\n\nOf {next(iter(counted['refusals'].values()))['runs']} runs. A refusal was needless "
            f"where x, v and sigma would have been within a factor of {NEEDLESS:g}.\n\n"
            + markdown_table(["estimator", "before the run", "needless", "after it", "needless", "cannot run"], lines))


def error_bars_table(counted: Mapping) -> str:
    """Returns Markdown: how often bars around the goals' values at the end contained the truth, and their widths."""
    names = main_bar_names(counted)
    lines = [[_bar_label(name), *(cell for kind in counted["goals"]
                                  for cell in _bar_cells(counted["goals"][kind]["all"][name]))] for name in names]
    heads = [text for kind in counted["goals"] for text in (GOALS[kind], "given", "width", "score")]
    return ("## Bars around a number: how often they hold the truth\n\nPer cent of the bars that are given, with the "
            "95 % interval; how many per cent of the runs are given one; the median of the bar over the true error; "
            "and the mean score, in decades by which a bar is too long, or 19 times those by which it is too short (0 "
            f"is perfect). The grid convergence index and its successor promise 95 %; {SAFETY:g} times an estimated "
            "error promises nothing.\n\n" + markdown_table(["bar", *heads], lines))


def regime_error_bars_table(counted: Mapping) -> str:
    """Returns Markdown: how often bars contained the truth, all goals together, by how far particles move."""
    lines = []
    for name in main_bar_names(counted):
        cells = []
        for one in REGIMES:
            found = [split["regime"][one][name] for split in counted["goals"].values()]
            cells.append(format_share(sum(f["held"] for f in found), sum(f["runs"] for f in found), True))
        lines.append([_bar_label(name), *cells])
    return "### All three numbers, by how far particles move\n\n" + markdown_table(["bar", *REGIMES], lines)


def grid_index_table(counted: Mapping) -> str:
    """Returns Markdown: how often grid convergence indices contained the truth, by order and by the coarsest grid."""
    heads = [*(f"order {key}" for key in (*ORDERS, NO_ORDER)), *(f"coarsest {key}" for key in COARSEST_CELLS)]
    lines = [[name, *(" of ".join([format_share(one["held"], one["runs"], True), f"{one['runs']:,}"]) if one["runs"]
                      else NOTHING for split in ("order", "coarsest") for one in found[split].values())]
             for name, found in counted["grids"].items()]
    return ("### Grid convergence indices, by observed order and by the coarsest grid\n\nPer cent of the bars of all "
            "three numbers, with the 95 % interval; the coarsest grid is counted in cells along a unit of length.\n\n"
            + markdown_table(["bar", *heads], lines))


def by_truth_table(counted: Mapping) -> str:
    """Returns Markdown: how often estimates and bars were right in all runs that are ok by the truth alone."""
    found, least = counted["by truth"], f"{FACTORS[0]:g}"
    lines = [[name, *(format_share(split[q]["within"][least], split[q]["runs"], True) for q in QUANTITIES),
              *(format_share(one["held"], one["runs"], True) for goal in found["goals"].values()
                for one in [goal[f"{SAFETY:g} x {name}"]])] for name, split in found["estimators"].items()]
    return (f"## All runs that the truth alone calls ok\n\nThe same of {found['runs']:,} runs, with those that an "
            f"estimator or a contradiction called lost: x, v and σ within a factor of {least}, and bars of {SAFETY:g} "
            "times the estimated error that contained the truth, in per cent.\n\n" + markdown_table(
                ["estimator", *(PARTS[q] for q in QUANTITIES), *(GOALS[kind] for kind in found["goals"])], lines))


def main_bar_names(counted: Mapping) -> list[str]:
    """Returns the names in a tally of bars of twice the estimated error, and of grid convergence indices."""
    return [*(f"{SAFETY:g} x {name}" for name in counted["estimators"]), *INTERVALS]


def format_share(count: int, total: int, bounds: bool = False) -> str:
    """Returns ``count`` of ``total`` in per cent, as text, with its 95 % interval if ``bounds``; "–" for 0 of 0."""
    if not total:
        return NOTHING
    low, high = (100 * part for part in wilson_interval(count, total))
    return f"{100 * count / total:.1f}" + (f" ({low:.0f}–{high:.0f})" if bounds else "")


def _bar_label(name: str) -> str:
    return name.replace(" x ", " × ")


def _central_range_text(ratios: Sequence[float] | None) -> str:
    """Returns as text a range of true over estimated error, from two ratios of estimated over true error."""
    if not ratios:
        return NOTHING
    least, most = (1 / ratio if ratio > 0 else math.inf for ratio in reversed(ratios))
    return " to ".join(f"{end:.4f}" if abs(end - 1) < CLOSE else f"{end:.3g}".replace("inf", "∞")
                       for end in (least, most))


def _bar_cells(found: Mapping) -> Iterable[str]:
    if not found["runs"]:
        return [NOTHING] * 4
    return [format_share(found["held"], found["runs"], True), f"{100 * found['runs'] / found['of']:.0f}",
            f"{found['width']:.2f}", f"{found['score']:.2f}"]
