"""``assets/strangers.md``, from what is said of the codes (``listed.py``) and what was recorded of them (the JSON)."""

from __future__ import annotations

import textwrap
from typing import Any

from solvers.study.markdown import grid
from tests.strangers.listed import SAID, STRANGERS, Stranger

HEAD = """# Codes that we did not write

Back to the [README](../README.md). Public codes from the package registries, each with a problem of the lab. A script
of at most 80 lines (`tests/strangers/codes/`, with `handout.py` there, which all share) reads what `mpm-lab problem`
wrote and nothing else of ours, sets the code up with its own settings where the problem leaves a choice, and writes its
particles; `mpm-lab judge` judged them. `python -m tests.strangers` makes all of it anew, each code in an environment of
its own that is thrown away. The numbers here are those of [strangers.json](strangers.json).

What a code was made for is said of each. None was made for these problems, and a difference of purpose is no error: the
table says what comes out when one asks of a code what it did not promise.
"""
NAMES = {"mpm": "MPM", "ugimp": "uGIMP", "cpdi": "CPDI", "bspline": "B-spline"}
WIDTH = 120  # characters of a line of text
UNITS = {"x": "x (m)", "v": "v (m/s)", "sigma": "σ (Pa)"}


def percent(report: dict[str, Any], one: dict[str, Any]) -> str:
    """The largest error of x in per cent of A, in m; of the vortex A is in rad, the way of its middle circle in m."""
    return f"{100 * one['error']['x']['max'] / report['scene']['amplitude']:.3g} %"


def orders(report: dict[str, Any]) -> str:
    found = {name: report["order"].get(name) for name in UNITS}
    return ", ".join(f"{'σ' if name == 'sigma' else name} {value:.2f}" for name, value in found.items() if value)


def verdict(report: dict[str, Any]) -> str:
    """The judge's notes on the finest grid, or that there are none."""
    return "; ".join(report["grids"][-1]["notes"]) or "nothing found"


def summary(stranger: Stranger, report: dict[str, Any]) -> list[str]:
    finest = report["grids"][-1]
    learned = stranger.said()[2]
    return [f"[{report['package'].replace('==', ' ')}](#{anchor(stranger)})", stranger.problem, f"{finest['cells']}",
            percent(report, finest), orders(report), verdict(report), learned, report["date"]]


def anchor(stranger: Stranger) -> str:
    """The name that a heading's link has: of the words in it, small and with dashes."""
    return heading(stranger).lower().replace(" ", "-").replace(",", "").replace(".", "").replace("=", "")


def heading(stranger: Stranger) -> str:
    return f"{stranger.package.replace('==', ' ')}, {stranger.problem}"


def wrapped(text: str) -> str:
    return textwrap.fill(text, WIDTH, break_long_words=False, break_on_hyphens=False)


def section(stranger: Stranger, report: dict[str, Any]) -> str:
    """One code: what it was made for, how it was set up, its errors on each grid beside one of ours."""
    scene, rows = report["scene"], []
    for one in report["grids"]:
        ours = one["ours"].get(stranger.kin)
        errors = [one["error"][name]["max"] for name in UNITS]
        rows.append([f"{one['cells']}", f"{one['particles']:,}", percent(report, one),
                     *("–" if value is None else f"{value:.3e}" for value in errors),
                     f"{one['error']['x']['max'] / ours:.2f}" if ours else "ours is lost",
                     f"{one['crossings_at_least']:,}"])
    notes = {note: [one["cells"] for one in report["grids"] if note in one["notes"]]
             for one in report["grids"] for note in one["notes"]}
    steps = ", ".join(f"{one['dt']:.3g} s" for one in report["ran"])
    others = [f"{name} {value}" for name, value in report["ran"][0].items()
              if name not in ("cells", "dt", "steps", "version")]
    versions = f"With {', '.join(others)} on" if others else "On"
    head = ["cells", "particles", "x, of A", *UNITS.values(), f"x over our {NAMES[stranger.kin]}", "crossings"]
    made_for, here, _ = stranger.said()
    direction = "" if stranger.problem == "bar" else " and direction"
    return "\n\n".join([
        f"## {heading(stranger)}", wrapped(f"*Made for:* {made_for}"), wrapped(f"*Here:* {here}"),
        wrapped(f"{versions} Python {stranger.python}, {stranger.precision} precision; `{stranger.problem} "
                f"{' '.join(stranger.flags)}`, {scene['ppc']} particles per cell{direction}, to "
                f"{report['grids'][0]['end']:.3g} s in steps of {steps}."),
        grid(head, rows).strip(), f"Order in h: {orders(report)}.",
        *(["\n".join(f"* {', '.join(map(str, on))} cells: {note}" for note, on in notes.items())] if notes else [])])


def page(recorded: dict[str, dict[str, Any]]) -> str:
    """The whole text, of the codes that have a record."""
    told = [(stranger, recorded[stranger.script]) for stranger in STRANGERS if stranger.script in recorded]
    head = ["code", "problem", "cells", "error of x, of A", "order in h", "verdict", "what we learned", "judged"]
    table = grid(head, [summary(stranger, report) for stranger, report in told]).strip()
    others = (SAID / "no_number.md").read_text(encoding="utf-8").strip()
    sections = [section(*one) for one in told]
    parts = [HEAD.strip(), table, *sections, "## Which did not come to a number, and why", others]
    return "\n\n".join(parts) + "\n"
