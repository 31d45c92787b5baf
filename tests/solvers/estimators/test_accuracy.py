"""How near each estimator comes to the truth: one run of a scene, watched by all estimators that are valid there.

That a run and its estimates do not depend on who else watches, to the bit, is what allows it: see
``tests/solvers/running/test_same_bits.py``. ``ROWS`` are the bounds: where a number of an estimator's own comes from
stands with it. What an estimator does beside being accurate is in the file of its name.
"""

import itertools
import json
import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest

from solvers.problems.bar.scene import BarScene
from solvers.problems.ring import RingScene
from solvers.problems.vortex import VortexScene
from solvers.running.result import Result
from solvers.running.run import run
from solvers.scene.scene import Scene
from solvers.solver.error_series import RATIOS, error_index
from solvers.solver.rounding import largest_rounding_error
from solvers.solver.samples import QUANTITIES
from tests.support.paths import ASSETS
from tests.support.reference_bar import NUMBERS

TABLE = {case: NUMBERS["table1"][case] for case in ("small", "large")}
RING_TABLE = json.loads((ASSETS / "reference" / "ring.json").read_text())
RING_METHODS = ("ugimp", "cpgimp", "cpdi")
CELLS = (20, 40, 80, 160)
EACH_GRID = pytest.mark.parametrize("cells", [*CELLS[:3], pytest.param(CELLS[3], marks=pytest.mark.slow)])
ALL = tuple(QUANTITIES)
XV, XVS = ALL[:2], ALL[:3]

BAR = BarScene(estimators=BarScene.choices("estimators"), linearity_preserving=True, dt=2.5e-5, t_end=1.0)
FREE_STEP = {"dt": None, "t_end": None}  # the usual one, and the usual time unless another is given
PLAIN = {**FREE_STEP, "linearity_preserving": False}
RING = RingScene(estimators=RingScene.choices("estimators"), cells=24, dt=2e-5, periods=1)
#: A = 1: the middle turns by 57 degrees.
VORTEX = VortexScene(estimators=VortexScene.choices("estimators"), cfl=0.1, t_end=1.0)
LARGE = {name: TABLE["large"][name] for name in ("modulus", "amplitude")}
KINDS = {"bar": BAR, "ring": RING, "vortex": VORTEX}


class Bound(NamedTuple):
    """Of these quantities the index lies between ``least`` and ``most``, the distance below ``distance``. With no index
    allowed (``least`` is None) the estimator says nothing of them. It holds there by its own word, unless ``doubted``.
    """

    estimator: str
    quantities: tuple[str, ...]
    least: float | None
    most: float | None = None
    distance: float = math.inf
    doubted: bool = False


def companion(index: float, distance: float) -> Bound:
    return Bound("companion", ALL, 1 - index, 1 + index, distance)


def recovered(least: float, most: float, quantities: tuple[str, ...] = XVS, distance: float = math.inf) -> Bound:
    return Bound("recovered", quantities, least, most, distance)


#: Of Table 1's rows, measured: index 1 within 1e-4, distance up to 5e-3.
TABLE_1 = companion(0.002, 0.02)
#: Table 1's rows within [0.8, 1.25], and in place.
TABLE_1_RECOVERED = (recovered(0.8, 1.25, ALL, 0.5), recovered(0.8, 1.25, distance=0.2))
#: Table 1's small case with the force at material points: measured .92-1.08, distances up to .34.
TABLE_1_TWO_GRID = Bound("two-grid", ALL, 0.85, 1.15, 0.45)


def table_1(case: str, force: str, cells: int) -> Scene:
    numbers = {name: TABLE[case][name] for name in ("modulus", "amplitude")}
    return replace(BAR, cells=cells, body_force=force, **numbers)


def table_1_bounds(case: str, force: str, cells: int) -> tuple[Bound, ...]:
    """Transport's: x within a factor 10 of the paper's index.

    The paper leaves the estimator's details open, so its size is asked for and not its digits. For sigma the theory is
    sharp: the error is the second term of L's Taylor series, which this estimator carries, and the next is k h/2 = pi h
    of it; and in the right places."""
    bounds = [TABLE_1, *TABLE_1_RECOVERED * (cells in (20, 80))]
    if (case, force) == ("small", "material") and cells < 160:
        bounds.append(TABLE_1_TWO_GRID)
    if (case, force) == ("small", "node"):
        paper = TABLE[case]["rows"][str(cells)]["paper_index"]["x"]
        bounds += [Bound("transport", ("x",), paper / 10, paper * 10),
                   Bound("transport", ("sigma",), 1 - math.pi / cells, 1 + math.pi / cells, 0.5)]
    return tuple(bounds)


#: Longer, coarser, faster, freer.
OTHER_BAR = companion(0.005, 0.03)
#: Measured: index 1 within 0.0015, distance up to 0.023 (stress, CPDI at 12 cells).
RING_ROW = companion(0.005, 0.05)
RING_RECOVERED = (recovered(0.8, 1.25, ("x",), 0.2), recovered(0.8, 1.25, ("v",), 0.3),
                  recovered(0.8, 1.25, ("sigma",), 0.5))
#: Measured: x .97-1.00 with distances .23, .13, .11; v and sigma .98-1.14; a is noise, and not said.
RING_TWO_GRID = (Bound("two-grid", ("x",), 0.93, 1.05, 0.3), Bound("two-grid", ("v", "sigma"), 0.8, 1.25),
                 Bound("two-grid", ("a",), None))


def ring_transport(method: str, cells: int) -> Bound:
    """The index of the paper's estimate is another program's within 15 %."""
    index = RING_TABLE["transport_index_x"][method][RING_TABLE["cells"].index(cells)]
    return Bound("transport", ("x",), 0.85 * index, 1.15 * index, doubted=True)


#: A staircase rim, few and many particles, large and small amplitudes, long runs, steps of its own in between.
OTHER_RING = companion(0.01, 0.06)
#: Scenes that recovered was not tuned on, chosen before it was run on them.
HOLDOUT = recovered(0.7, 1.3, XV)
DOUBTED = HOLDOUT._replace(doubted=True)
#: A fit over four cells, or six where particles stand unevenly, however many that takes; measured .99-1.05. Remedies
#: change nothing for it: x .98-1.02, v .96-1.06 on 20 bars of all methods.
ANY = recovered(0.9, 1.1)
LONG_STEP = recovered(0.7, 1.2, ("a",))
#: The large bar to T = 10 s (158 periods), and CPDI for 20.
LONG = recovered(0.5, 2)
#: Of x, of scenes beyond those that two-grid's rules come from (most of them .8 to 1.2, within .6), drawn by
#: hand before anything was run: corners of what the rules let pass.
KEPT = Bound("two-grid", ("x",), 0.8, 1.2, 0.6)
#: Fixed before anything was run and asked of all: .9 to 1.1 of x and v, .8 to 1.25 of sigma and a. Then measured:
VORTEX_ROW = companion(0.005, 0.03)
VORTEX_RECOVERED = (recovered(0.9, 1.1, XV), recovered(0.8, 1.25, ALL))
#: Of x and a within a factor of ten, as with the paper's figures; of v less, for eq 48 keeps one step of it. Measured
#: with CPDI on 48 cells, A = .25 and 1: x .79 and .88, v .13 and .16, a 4.8 and 4.9; nothing of sigma.
VORTEX_TRANSPORT = (Bound("transport", ("x", "a"), 0.1, 10, doubted=True),
                    Bound("transport", ("v",), 0.02, 1, doubted=True),
                    Bound("transport", ("sigma",), None, doubted=True))


def ring_case(method: str, cells: int) -> tuple:
    return ("ring", {"method": method, "cells": cells}, RING_ROW, ring_transport(method, cells), *RING_RECOVERED,
            *RING_TWO_GRID * (method == "cpdi" and cells < 96))


#: What of a problem's scene above is changed, and the bounds.
OTHERS = [
    ("bar", {"cells": 20, "t_end": 10.0, **LARGE}, LONG),
    ("bar", {"cells": 40, "ppc": 1}, OTHER_BAR),
    ("bar", {"cells": 40, "amplitude": 1e-6}, OTHER_BAR),
    ("bar", {"cells": 40, "body_force": "none", "amplitude": 0.05}, OTHER_BAR),
    ("bar", {"cells": 40, "dt": None, "cfl": 0.4}, OTHER_BAR),
    ("bar", {"cells": 7}, OTHER_BAR),
    ("bar", {"cells": 40, "dt": None, "cfl": 0.8, "amplitude": 0.005}, OTHER_BAR),
    ("bar", {"cells": 30, "modulus": 50.0, "amplitude": 0.01, "ppc": 2, **FREE_STEP, "periods": 3}, HOLDOUT),
    ("bar", {"cells": 64, "modulus": 7.0, "amplitude": 0.04, "ppc": 1, **FREE_STEP, "periods": 2}, DOUBTED),
    ("bar", {"cells": 50, "method": "mpm", "amplitude": 0.02, **PLAIN, "periods": 2}, HOLDOUT),
    ("bar", {"cells": 40, "body_force": "none", "amplitude": 0.02, **FREE_STEP, "periods": 4}, HOLDOUT),
    *(("bar", {"cells": 40, "ppc": ppc, "amplitude": 2.5e-3, **FREE_STEP, "periods": 2}, ANY) for ppc in (1, 5, 7)),
    ("bar", {"cells": 40, "amplitude": 0.025, **PLAIN, "periods": 2,
             "remedies": ("null-space-filter", "coupled-deformation")}, ANY),
    # Table 1's large case, where particles cross cells, for a while; a is noise, and not said.
    ("bar", {"cells": 40, "t_end": 0.25, **LARGE}, Bound("two-grid", XVS, 0.7, 1.25), Bound("two-grid", ("a",), None)),
    ("bar", {"method": "bspline", "cells": 64, "amplitude": 2.5e-4, **PLAIN, "periods": 5.0, "cfl": 0.1}, KEPT),
    ("bar", {"method": "cpgimp", "ppc": 4, "cells": 44, "amplitude": 0.04, "velocity": "corners", **FREE_STEP,
             "periods": 1.0, "cfl": 0.1}, KEPT),
    ("bar", {"ppc": 7, "cells": 37, "amplitude": 2e-3, **FREE_STEP, "periods": 2.0, "cfl": 0.4}, KEPT),
    *(ring_case("cpdi", cells) for cells in RING_TABLE["cells"]),
    ("ring", {"layout": "cartesian"}, OTHER_RING),
    ("ring", {"ppc": 4}, OTHER_RING),
    ("ring", {"amplitude": 0.19}, OTHER_RING),
    ("ring", {"amplitude": 0.01}, OTHER_RING),
    ("ring", {"periods": 20.0, "cells": 12}, OTHER_RING),
    ("ring", {"periods": 20.0}, LONG),
    ("ring", {"dt": None, "cfl": 0.8}, OTHER_RING),
    ("ring", {"modulus": 4e7, "density": 2000.0}, OTHER_RING),
    ("ring", {"dt": None, "cfl": 0.8, "cells": 12, "periods": 3}, OTHER_RING),
    ("ring", {"cells": 36, "amplitude": 0.02, "ppc": 3, "dt": None, "cfl": 0.1}, HOLDOUT),
    ("ring", {"cells": 48, "amplitude": 0.18, "modulus": 4e7, "dt": None, "cfl": 0.1}, HOLDOUT),
    ("ring", {"cells": 40, "dt": None, "cfl": 0.25, "periods": 2.5}, HOLDOUT),
    ("ring", {"cells": 30, "ppc": 3, "amplitude": 0.02, "dt": None, "cfl": 0.2}, KEPT),
    ("ring", {"cells": 21, "amplitude": 0.14, "dt": None, "cfl": 0.1, "periods": 1.5}, KEPT),
    ("vortex", {}, VORTEX_ROW, *VORTEX_RECOVERED),
    ("vortex", {"cells": 96, "amplitude": 0.25, "cfl": 0.2}, VORTEX_ROW),
    ("vortex", {"amplitude": 0.25, "cells": 24}, VORTEX_ROW),
    ("vortex", {"ppc": 2, "amplitude": 0.5}, VORTEX_ROW),
    ("vortex", {"poisson_ratio": 0.45, "amplitude": 0.5}, VORTEX_ROW),
    ("vortex", {"poisson_ratio": 0.0, "frequency": 0.7}, VORTEX_ROW),
    ("vortex", {"amplitude": 1e-3}, VORTEX_ROW),
    ("vortex", {"amplitude": 0.5, "t_end": 3.0}, VORTEX_ROW),
    ("vortex", {"modulus": 4e6, "density": 700.0, "frequency": 60.0, "t_end": 1 / 60}, VORTEX_ROW),
    ("vortex", {"amplitude": 0.5}, *VORTEX_RECOVERED),
    ("vortex", {"poisson_ratio": 0.45, "amplitude": 0.25}, *VORTEX_RECOVERED),
    ("vortex", {"amplitude": 0.25, "ppc": 2}, *VORTEX_RECOVERED),
    ("vortex", {"amplitude": 0.02, "frequency": 2.0, "t_end": 1.5}, *VORTEX_RECOVERED),
    ("vortex", {"cells": 24, "amplitude": 0.25, "cfl": 0.2}, *VORTEX_TRANSPORT),
    # Once refused as too coarse or too rough, though right.
    ("bar", {"method": "mpm", "cells": 11, "ppc": 5, "amplitude": 1e-4, **PLAIN, "cfl": 0.2, "periods": 0.66}, ANY),
    ("vortex", {"cells": 20, "amplitude": 0.1, "frequency": 0.25, "cfl": 0.2, "t_end": None, "periods": 0.3}, ANY),
    # With a step near the longest that the run stands, for which recovered's own elements were too narrow: refused as
    # having grown, or said, with an a of 5 and 2.4 times its error. Of a, for which a coarse ring has few particles
    # across: measured 1.1 and .73.
    ("ring", {"cells": 23, "amplitude": 0.0351, "dt": None, "cfl": 0.75, "periods": 4.0}, ANY, LONG_STEP),
    ("ring", {"cells": 13, "amplitude": 0.0576, "dt": None, "cfl": 0.8, "periods": 0.56}, ANY, LONG_STEP),
    # A free bar, whose acceleration begins at zero: between two of an estimator's own steps it was carried on along a
    # line, off by 2.7 (and two-grid's by 1.7) times the error, above all at the first reports. Measured since: 1.14.
    ("bar", {"method": "cpgimp", "body_force": "none", "cells": 51, "ppc": 3, "amplitude": 1.5e-4, **PLAIN,
             "cfl": 0.0427, "periods": 0.51}, recovered(0.8, 1.2, ("a",), 0.4)),
]
#: Compile longer than they run, or repeat what others show.
SLOW = [
    ("bar", {"body_force": "none", "method": "cpgimp", "cells": 46, "ppc": 7, "amplitude": 1.129e-4, "density": 0.2592,
             "modulus": 353300.0, "dt": "auto", "t_end": None, "periods": 1.241},
     Bound("two-grid", ("a",), 0.8, 1.2, 0.4)),
    ("bar", {"method": "mpm", "cells": 54, "ppc": 5, "amplitude": 6.5e-5, **PLAIN, "cfl": 0.25, "periods": 1.67},
     ANY._replace(estimator="two-grid")),
    *(("ring", {**changes, "dt": None}, ANY) for changes in (
        {"method": "cpgimp", "cells": 23, "amplitude": 0.01939, "cfl": 0.04322, "periods": 0.4178},
        {"method": "ugimp", "cells": 33, "amplitude": 0.23, "cfl": 0.35, "periods": 0.55})),
    ("ring", {"method": "cpgimp", "cells": 17, "ppc": 1, "amplitude": 0.02, "cfl": 0.2, "periods": 1.0, "dt": None},
     ANY._replace(quantities=("x", "v"))),  # of one particle per cell no stress is recovered
    *(("ring", {**changes, "dt": None}, ANY._replace(estimator="two-grid")) for changes in (
        {"cells": 33, "remedies": ("null-space-filter",), "amplitude": 4e-3, "cfl": 0.3, "periods": 0.5},
        {"method": "cpgimp", "cells": 20, "ppc": 3, "amplitude": 0.01, "cfl": 0.2, "periods": 1.0})),
    ("ring", {"cells": 23, "amplitude": 0.0351, "dt": None, "cfl": 0.69, "periods": 1.27,
              "remedies": ("null-space-filter",)}, ANY, LONG_STEP),
    *(ring_case(method, cells) for method in ("ugimp", "cpgimp") for cells in RING_TABLE["cells"]),
    ("bar", {"cells": 40, "t_end": 10.0, **LARGE}, OTHER_BAR),
    ("bar", {"cells": 50, "method": "bspline", "amplitude": 0.05, **PLAIN}, HOLDOUT),
    ("bar", {"cells": 36, "method": "cpgimp", "velocity": "corners", "amplitude": 0.1, **PLAIN, "periods": 4}, HOLDOUT),
    ("bar", {"cells": 72, "ppc": 3, "body_force": "node", "amplitude": 5e-4, "velocity": "particle", **FREE_STEP,
             "periods": 1.0, "cfl": 0.3}, KEPT),
    ("bar", {"method": "mpm", "ppc": 5, "cells": 30, "amplitude": 1e-3, "body_force": "none", **FREE_STEP,
             "periods": 2.0, "cfl": 0.2}, KEPT),
    ("bar", {"method": "cpgimp", "ppc": 1, "cells": 50, "amplitude": 1e-3, **FREE_STEP, "periods": 1.5, "cfl": 0.1},
     KEPT),
    ("ring", {"ppc": 1}, OTHER_RING),
    ("ring", {"cells": 30, "method": "ugimp", "amplitude": 0.15, "modulus": 1e6, "dt": None, "cfl": 0.1}, HOLDOUT),
    # An error grid as narrow as the particles' spacing made x 8 to 44 times too large. Now measured: 1.00 to 1.05 for x
    # and v; sigma and a, which the fit's own noise would fill, are not said.
    ("ring", {"cells": 36, "ppc": 1, "dt": None, "cfl": 0.2, "periods": 2.0}, recovered(0.9, 1.1, XV),
     Bound("recovered", ("sigma", "a"), None)),
    ("vortex", {"cells": 24}, VORTEX_ROW),
    ("vortex", {"amplitude": 1.5, "t_end": 0.6}, VORTEX_ROW),
    ("vortex", {"layout": "cartesian", "amplitude": 0.5, "cfl": 0.05}, VORTEX_ROW),
    ("bar", {"cells": 40, "ppc": 5, "velocity": "particle", "amplitude": 2.5e-3, **FREE_STEP, "periods": 2}, ANY),
    ("bar", {"cells": 40, "amplitude": 0.025, **PLAIN, "periods": 2, "remedies": ("frozen-weights",)}, ANY),
    ("vortex", {"method": "ugimp"}, VORTEX_ROW),
    ("vortex", {"amplitude": 0.25, "method": "ugimp"}, VORTEX_ROW, *VORTEX_RECOVERED),
    ("vortex", {"cells": 24, "amplitude": 0.25, "cfl": 0.2, "method": "cpgimp-v"}, *VORTEX_TRANSPORT),
    ("ring", {"cells": 24, "method": "mpm", "amplitude": 0.03, "ppc": 3, "dt": None, "cfl": 0.1}, HOLDOUT),
    ("vortex", {"method": "cpgimp-v"}, VORTEX_ROW),
    ("vortex", {"amplitude": 0.1, "method": "cpgimp-v"}, *VORTEX_RECOVERED),
]


#: A scene each with its bounds, and whether it is for the slow set.
CASES: dict[str, tuple[Scene, tuple[Bound, ...], bool]] = {
    **{f"{case} {force} {cells}": (table_1(case, force, cells), table_1_bounds(case, force, cells), cells == 160)
       for case in TABLE for force in ("material", "node") for cells in CELLS},
    **{f"{problem} {change}": (replace(KINDS[problem], **change), tuple(bounds), slow)
       for slow, cases in enumerate((OTHERS, SLOW)) for problem, change, *bounds in cases}}
#: What of a scene is compiled in: numbers are not.
SWITCHES = ("problem", "method", "linearity_preserving", "body_force", "velocity", "remedies", "layout")


def switches(scene: Scene) -> tuple:
    return tuple(getattr(scene, name, None) for name in SWITCHES)


def watched(scene: Scene) -> Scene:
    """The scene with each estimator that has a bound where the same is compiled, so that it is compiled once."""
    asked = {bound.estimator for other, bounds, _ in CASES.values() if switches(other) == switches(scene)
             for bound in bounds}
    return replace(scene, estimators=tuple(name for name in scene.estimators if name in asked))


def ratio_of(result: Result, kind: str, estimator: str) -> dict[str, float | None]:
    """Its "index" or "distance" also where it says itself that it does not hold, and the result has none."""
    return {q: error_index(result.series[f"{estimator}/{RATIOS[kind]}_{q}"], result.series[f"error_{q}"],
                           largest_rounding_error(result.scene, q, result.steps)) for q in QUANTITIES}


@pytest.mark.parametrize("name", [pytest.param(name, id=name, marks=pytest.mark.slow if slow else ())
                                  for name, (_, _, slow) in CASES.items()])
def test_bounds(name, simulate):
    scene, bounds, _ = CASES[name]
    result = simulate(watched(scene))
    assert result.status == "ok", result.reason
    missed = []
    for bound in bounds:
        assert bound.doubted or bound.estimator not in result.not_valid
        index, distance = (ratio_of(result, kind, bound.estimator) for kind in ("index", "distance"))
        for q in bound.quantities:
            if bound.least is None:
                met = index[q] is None and distance[q] is None
            else:
                met = bound.least < index[q] < bound.most and distance[q] < bound.distance
            if not met:
                missed.append(f"{bound.estimator} {q}: index {index[q]}, distance {distance[q]}, not {bound}")
    assert not missed, "\n".join(missed)


#: Said by recovered once, and wrong, each with what is said instead.
WRONG = [
    ({"cells": 28, "ppc": 2, "amplitude": 0.86, "cfl": 0.09, "periods": 0.32}, "against each other"),
    ({"method": "ugimp", "cells": 46, "amplitude": 1.29, "cfl": 0.0865, "periods": 0.8316, "poisson_ratio": 0.3622,
      "frequency": 1.334, "remedies": ("null-space-filter",)}, "against each other"),
    ({"method": "cpgimp", "cells": 25, "amplitude": 0.13, "frequency": 2.6, "cfl": 0.1, "periods": 0.17},
     "waves of a few cells")]


@pytest.mark.parametrize(("changes", "word"), [
    pytest.param(*each, marks=pytest.mark.slow if "method" in each[0] else ()) for each in WRONG], ids=str)
def test_what_is_refused_is_wrong(changes, word, monkeypatch):
    """Whether that is known beforehand or found in the run; with all rules switched off."""
    scene = replace(VORTEX, t_end=None, **changes)
    reason = scene.not_valid.get("recovered")
    monkeypatch.setattr(VortexScene, "LIMITS", ())
    with np.errstate(all="ignore"):
        result = run(replace(scene), prices=False)
    index = ratio_of(result, "index", "recovered")
    assert word in (reason or result.not_valid["recovered"])
    assert not all(index[q] is not None and 0.9 <= index[q] <= 1.1 for q in XVS)


def worst(result: Result) -> dict[str, float]:
    """The largest error norm of each quantity over the run."""
    assert result.status == "ok", result.reason
    return {name: values["max"] for name, values in result.error.items()}


def crossings(result: Result) -> int:
    return result.to_dict()["grid_crossings"]


@EACH_GRID
@pytest.mark.parametrize("case", TABLE)
def test_table_1(case, cells, simulate):
    """The paper's Table 1 set-up gives its upper half.

    The independent program printed three digits of the same scheme: 1 %. The paper leaves final time and
    body-force placement open; what is decided for them reproduces it to about 10 %: 12 %. The large case crosses cells
    as often as in the independent program, where single crossings near a turning point may differ by rounding: 1 %; the
    small one never does. (The paper prints 8 in the small case; two programs count 0.)"""
    result, row = simulate(watched(table_1(case, "node", cells))), TABLE[case]["rows"][str(cells)]
    ours, counted = worst(result), NUMBERS["crossings_large_t1"][str(cells)] if case == "large" else 0
    for name, value in row["prototype"].items():
        assert ours[name] == pytest.approx(value, rel=0.01), name
    for name, value in row["paper"].items():
        assert ours[name] == pytest.approx(value, rel=0.12), name
    assert crossings(result) == pytest.approx(counted, rel=0.01)


@EACH_GRID
def test_material_body_force_restores_second_order(cells, simulate):
    """Large case with b at the material points: no floor, with as many crossings. Printed to two digits: 6 %."""
    result, node = (simulate(watched(table_1("large", force, cells))) for force in ("material", "node"))
    ours = worst(result)
    for name in ("x", "sigma"):
        assert ours[name] == pytest.approx(NUMBERS["material_large"][name][str(cells)], rel=0.06)
    assert crossings(result) == pytest.approx(crossings(node), rel=0.06)


def ring_row(method: str, cells: int) -> Scene:
    """With estimators where these have bounds; of the others compiling takes longest."""
    row = replace(RING, method=method, cells=cells)
    return watched(row) if method == "cpdi" else replace(row, estimators=(), effects=("truth",))


@pytest.mark.parametrize("cells", RING_TABLE["cells"])
@pytest.mark.parametrize("method", RING_METHODS)
def test_table_of_the_ring(method, cells, simulate):
    """Errors of x and v after a period: within 15 % of another program's.

    The issue sets 15 %: the programs differ in rounding and sampling, and at 96 cells GIMP's error is noise."""
    k, errors = RING_TABLE["cells"].index(cells), simulate(ring_row(method, cells)).error
    for name in ("x", "v"):
        assert errors[name]["final"] == pytest.approx(RING_TABLE[method][name][k], rel=0.15), name


def test_cpdi_is_second_order(simulate):
    """Order of x at least 1.9 on every refinement, v at least 1.7 (the independent program's: 1.82 to 2.05)."""
    errors = [simulate(ring_row("cpdi", n)).error for n in RING_TABLE["cells"]]
    for coarse, fine in itertools.pairwise(errors):
        assert math.log2(coarse["x"]["final"] / fine["x"]["final"]) >= 1.9
        assert math.log2(coarse["v"]["final"] / fine["v"]["final"]) >= 1.7


def test_samples_hold_the_particles_estimates(simulate):
    """Estimated norm and distance at the end, against numpy on the final particles, of each estimator."""
    result = simulate(watched(table_1("small", "node", 20)))
    final = result.final
    assert set(final.estimate) == {"transport", "recovered", "companion"}
    for estimator, estimate in final.estimate.items():
        for k, name in enumerate(QUANTITIES):
            size, off = (np.sqrt(np.mean(field[:, k] ** 2)) for field in (estimate, estimate - final.error))
            assert result.series[f"{estimator}/estimate_{name}"][-1] == pytest.approx(size, rel=1e-9)
            assert result.series[f"{estimator}/difference_{name}"][-1] == pytest.approx(off, rel=1e-9)


@pytest.mark.parametrize("scene", [replace(BAR, cells=40, amplitude=2.5e-4, **FREE_STEP, periods=1.0), RING],
                         ids=lambda scene: scene.problem)
def test_two_grid_reports_between_its_steps(scene, simulate):
    """Samples every seventh step, which the second run does not meet, tell the same."""
    scene = watched(scene)
    wanted, other = (simulate(s).index["two-grid"] for s in (scene, replace(scene, sample_every=7)))
    for q, value in wanted.items():
        assert (value is other[q] is None) or other[q] == pytest.approx(value, abs=0.03), q
