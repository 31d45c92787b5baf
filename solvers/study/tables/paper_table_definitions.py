"""The paper's tables in this project: their rows, the runs for each, and choices that had to be made.

A row is up to three runs: ``errors`` with every estimator, sampled as often as the estimators step, so that sums over
samples are sums over steps; ``cost``, a tenth as long and sampled as a run is by default, for the price of each
estimator; and for Table 1 ``crossings``, longer and with nothing else switched on. Tables 2 and 3 share their runs.
Beside each stand the numbers that the paper prints."""

import functools
import json
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path

from solvers.problems.bar.scene import BarScene
from solvers.problems.judging_reference import read_parts
from solvers.problems.ring import RingScene
from solvers.scene.scene import Scene

NUMBERS = ("1", "2", "3")
COST_PART = 0.1  # of the run's length: shares of the time do not depend on it

BAR_CELLS = (20, 40, 80, 160)
#: Case of Table 1: modulus in Pa and amplitude in m.
BAR_CASES = {"small": (4.0, 2.5e-4), "large": (1000.0, 2.5e-2)}
BAR_FORCES = {"node": "body force at the nodes (the paper's)", "material": "body force at the material points"}

RING_CELLS = (12, 24, 48, 96)
RING_METHODS = ("ugimp", "cpgimp", "cpdi")
#: Set-up of Tables 2 and 3: amplitude in m, modulus in Pa, particles per cell and direction, and what it is.
RING_SETUPS = {"ours": (0.1, 1e7, 2, "our choice"), "fitted": (0.03, 4e7, 4, "the best fit to the paper's digits")}

RING_CAPTION = "polar lattice, density 1000 kg/m³, Poisson's ratio 0, dt = 2e-5 s, t = {end:g} s"
NOTES = Path(__file__).with_name("notes.md")
PRINTED = Path(__file__).parents[3] / "assets" / "reference" / "paper.json"
#: How the paper's file calls our numbers.
KEYS = {"err_x": "x", "err_v": "v", "err_sigma": "sigma_log", "err_a": "a_nodes"}


@functools.cache
def _printed_numbers() -> dict:
    return json.loads(PRINTED.read_text(encoding="utf-8"))


def printed_bar_row(modulus: float, cells: int) -> dict[str, float]:
    """Returns a printed row of Table 1, by modulus (Pa) and cells: errors (SI units), crossings, indices; or {}."""
    for case in _printed_numbers()["table1"]["cases"]:
        for row in case["rows"]:
            if case["modulus"] == modulus and row["cells"] == cells:
                return {KEYS.get(key, key): value for key, value in row.items() if key != "cells"}
    return {}


def printed_ring_errors(method: str, cells: int) -> dict[str, float]:
    """Returns the printed errors in Table 2 of x (m), v (m/s) and ``a_nodes`` (m/s²); empty without such a row."""
    return {KEYS[key]: value for key, value in _printed_ring_row("table2", cells).get(method, {}).items()}


def printed_ring_index(method: str, cells: int) -> dict[str, float]:
    """Returns the printed index in Table 3 of the error of x, as ``index_x``; empty without such a row."""
    row = _printed_ring_row("table3", cells)
    return {"index_x": row[method]} if method in row else {}


def _printed_ring_row(table: str, cells: int) -> dict:
    """Returns the printed values of "table2" or "table3" for a number of cells, by method; empty without a row."""
    return next((row for row in _printed_numbers()[table]["rows"] if row["cells"] == cells), {})


def format_digits(value: float, count: int) -> str:
    """Returns a number with ``count`` significant digits, with an exponent only if that is shorter: 3.49e-6, 0.0581."""
    mantissa, _, exponent = f"{value:.{count - 1}e}".partition("e")
    power = int(exponent)
    return f"{value:.{max(0, count - 1 - power)}f}" if -2 <= power <= 2 else f"{mantissa}e{power}"


def format_round_number(value: float) -> str:
    """Returns a round number as text: 0.025, 2.5e-4, 1e7."""
    mantissa, _, exponent = f"{value:.1e}".partition("e")
    return f"{value:g}" if 1e-3 <= value < 1e4 else f"{mantissa.removesuffix('.0')}e{int(exponent)}"


@dataclass(frozen=True)
class TableRowDefinition:
    """Row of a table of the paper: unique name, heading ``part``, runs by name, and the printed numbers."""

    name: str
    part: str
    scenes: Mapping[str, Scene]
    paper: Mapping[str, float]


@dataclass(frozen=True)
class PaperTableDefinition:
    """Table of the paper ("1", "2" or "3") before its runs. ``setup`` describes given and chosen parameters in
    sentences, ``caption`` those that all rows share."""

    number: str
    title: str
    caption: str
    setup: tuple[str, ...]
    rows: tuple[TableRowDefinition, ...]


def make_table(number: str, estimators: Mapping[str, Iterable[str]]) -> PaperTableDefinition:
    """Returns table "1", "2" or "3" of the paper; ``estimators`` maps problems to names of estimators to run."""
    makers: dict[str, Callable[..., PaperTableDefinition]] = {"1": table_1, "2": table_2, "3": table_3}
    return makers[number](estimators)


def table_1(estimators: Mapping[str, Iterable[str]], cells: Iterable[int] = BAR_CELLS, end: float = 1.0,
            long: float = 10.0) -> PaperTableDefinition:
    """Returns Table 1, of the bar: errors, grid crossings and indices, a row per case, body force and number of cells.
    Runs take ``end`` s, those that count crossings ``long`` s; ``estimators`` as for :func:`make_table`."""
    rows = []
    for case, force, n in product(BAR_CASES, BAR_FORCES, cells):
        modulus, amplitude = BAR_CASES[case]
        scene = BarScene(method="ugimp", linearity_preserving=True, cells=n, ppc=4, modulus=modulus, dt=2.5e-5,
                         amplitude=amplitude, t_end=end, body_force=force, estimators=tuple(estimators["bar"]))
        crossings = replace(scene, t_end=long, estimators=(), effects=("crossings",))
        part = f"E = {modulus:g} Pa, A = {format_round_number(amplitude)} m, {BAR_FORCES[force]}"
        rows.append(TableRowDefinition(f"bar-{case}-{force}-{n}", part,
                                       {**_error_and_cost_scenes(scene), "crossings": crossings},
                                       printed_bar_row(modulus, n)))
    notes = read_parts(NOTES, end=f"{end:g}", long=f"{long:g}")
    setup = tuple(notes[name] for name in ("bar: taken", "bar: chosen", "bar: force", "bar: index", "index", "cost"))
    caption = f"linearity-preserving uGIMP, 4 particles per cell, dt = 2.5e-5 s, T = {end:g} s"
    return PaperTableDefinition("1", "Table 1. Vibrating bar: errors, grid crossings and error indices", caption, setup,
                                tuple(rows))


def _ring_table(number: str, title: str, names: tuple[str, ...], printed: Callable[[str, int], Mapping[str, float]],
                estimators: Mapping[str, Iterable[str]], cells: Iterable[int] = RING_CELLS,
                methods: Iterable[str] = RING_METHODS, end: float = 0.02) -> PaperTableDefinition:
    """Returns a table of the ring, a row per set-up, method and number of cells; runs take ``end`` s. ``names`` are
    those of its notes; ``printed`` returns the numbers in the paper for a method and cells."""
    rows = []
    for name, method, n in product(RING_SETUPS, methods, cells):
        amplitude, modulus, ppc, what = RING_SETUPS[name]
        scene = RingScene(method=method, cells=n, ppc=ppc, amplitude=amplitude, modulus=modulus, dt=2e-5, t_end=end,
                          estimators=tuple(estimators["ring"]))
        part = f"A = {amplitude:g} m, E = {format_round_number(modulus)} Pa, {ppc} × {ppc} particles per cell ({what})"
        rows.append(TableRowDefinition(f"ring-{name}-{method}-{n}", part, _error_and_cost_scenes(scene),
                                       printed(method, n)))
    notes = read_parts(NOTES, end=f"{end:g}", long="")
    setup = tuple(notes[name] for name in ("ring: taken", "ring: chosen", *names))
    return PaperTableDefinition(number, title, RING_CAPTION.format(end=end), setup, tuple(rows))


table_2 = functools.partial(_ring_table, "2", "Table 2. Expanding ring: errors at the end of the run", ("ring: error",),
                            printed_ring_errors)
table_3 = functools.partial(_ring_table, "3", "Table 3. Expanding ring: error indices over the run",
                            ("ring: index", "index", "cost"), printed_ring_index)


def _error_and_cost_scenes(scene: Scene) -> dict[str, Scene]:
    """Returns the runs ``errors``, sampled as often as estimators step, and ``cost``, a tenth as long."""
    return {"errors": replace(scene, sample_every=scene.estimate_interval),
            "cost": replace(scene, t_end=COST_PART * scene.end_time)}
