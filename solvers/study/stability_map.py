"""The stability map: how many periods a method survives, with and without remedies, over amplitude and time step.

A treatment is what a scene uses against breakdown: remedies, linearity preservation, domain corners that move with the
grid. A map row is a study row (``solvers.study.row``) whose long run computes only truth and contradictions.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from solvers.problems import PROBLEMS
from solvers.scene.scene import LOOKS_A_PERIOD, Scene
from solvers.scene.stabilisations import CENTRED, COUPLED, FILTER, FROZEN, PIECES
from solvers.scene.step_bound import SAFE
from solvers.scene.validation import SceneError
from solvers.solver.soundness import BROKEN
from solvers.study.convergence_analysis import completed_rows
from solvers.study.markdown_tables import markdown_table
from solvers.study.parameter_grid import Task

SCHEMA = "mpm-lab/stability/1"
NOTHING = "–"
EFFECTS = ["truth", "soundness", "margin"]
PRICE_TURNS = 7
PRICE_CFL = 0.1

#: What a treatment changes in a scene, by the name that the map gives it.
TREATMENTS: dict[str, dict[str, Any]] = {
    "plain": {},
    "filter": {"remedies": [FILTER]},
    "coupled": {"remedies": [COUPLED]},
    "filter+coupled": {"remedies": [FILTER, COUPLED]},
    "lp": {"linearity_preserving": True},
    "lp+zero-drift": {"linearity_preserving": True, "remedies": [CENTRED]},
    "all-three": {"linearity_preserving": True, "remedies": [FILTER, COUPLED]},
    "tiled": {"velocity": "corners"},
    "tiled+filter": {"velocity": "corners", "remedies": [FILTER]},
    "frozen": {"remedies": [FROZEN]},
    "pieces": {"remedies": [PIECES]},
}


def offered_treatments(scene: type[Scene]) -> tuple[str, ...]:
    """Returns the treatments (names of combinations of stabilisations) that work with any of a problem's methods."""
    return tuple(name for name in TREATMENTS
                 if any(_scene_with_treatment(scene, {"method": method}, name) for method in scene.choices("method")))


def map_tasks(problem: str, inputs: Sequence[Mapping[str, Any]], treatments: Iterable[str], version: str) -> list[Task]:
    """Returns a task for every combination of scene ``inputs`` and treatment that the problem supports."""
    kind = PROBLEMS[problem].scene
    tasks: dict[str, Task] = {}
    for treatment in treatments:
        for given in inputs:
            if scene := _scene_with_treatment(kind, given, treatment):
                every = max(1, round(scene.period / scene.time_step / LOOKS_A_PERIOD))
                task = Task(problem, {**given, **TREATMENTS[treatment], "estimator": [], "effects": EFFECTS,
                                      "sample_every": every}, repeats=0, version=version)
                tasks.setdefault(task.key, task)
    return list(tasks.values())


def _scene_with_treatment(kind: type[Scene], inputs: Mapping[str, Any], treatment: str) -> Scene | None:
    """Returns the scene with a treatment, or None where the method does not support it."""
    changes = TREATMENTS[treatment]
    try:
        return kind(**{**inputs, **changes})
    except SceneError as error:
        if error.field in changes or error.field in ("velocity", "linearity_preserving", "remedies"):
            return None
        raise


def treatment_of(row: Mapping) -> str:
    """Returns the name of the treatment (combination of stabilisations) in a row's scene, or "other"."""
    scene = row["scene"]
    had = {"remedies": sorted(scene["remedies"]), "linearity_preserving": scene["linearity_preserving"],
           "velocity": scene["velocity"]}
    plain = {"remedies": [], "linearity_preserving": False, "velocity": "grid"}
    for name, changes in TREATMENTS.items():
        wanted = {**plain, **changes}
        if had == {**wanted, "remedies": sorted(wanted["remedies"])}:
            return name
    return "other"


def gentle_scene_for_timing(kind: type[Scene], row: Mapping, treatment: str) -> Scene:
    """Returns a scene with the row's method and grid and a treatment, gentle (cfl 0.1), so timed steps are stable."""
    scene = row["scene"]
    gentle = {"method": scene["method"], "cells": scene["cells"], "ppc": scene["ppc"], "cfl": PRICE_CFL,
              "amplitude": kind.GENTLE_AMPLITUDE}
    found = _scene_with_treatment(kind, gentle, treatment)
    assert found is not None, f"{treatment} is in the map and yet not offered"
    return found


def survived_periods(row: Mapping) -> float:
    """Returns for how many periods a run stayed sound and its error of x below a tenth of the amplitude."""
    ends = [row["life"][name] for name in ("accurate", "sound") if row["life"][name] is not None]
    return min(ends, default=row["scene"]["periods"])


def stayed_accurate(row: Mapping) -> bool:
    """Returns whether a run stayed sound to its end, its error of x below a tenth of the amplitude."""
    return row["status"] not in BROKEN and row["life"]["accurate"] is None


def measure_prices(kind: type[Scene], rows: Iterable[dict]) -> dict[tuple[str, str], float]:
    """Measures the seconds per step over those of the plain method; returns them by (method, treatment)."""
    from solvers.running.repeated_step_timing import time_ratios

    pairs: dict[tuple[str, str], tuple[Scene, Scene]] = {}
    for row in completed_rows(rows):
        plain, treated = (replace(gentle_scene_for_timing(kind, row, name), effects=(), estimators=(),
                                  sample_every=None) for name in ("plain", treatment_of(row)))
        pairs |= {(plain.method, "plain"): (plain, plain), (plain.method, treatment_of(row)): (treated, plain)}
    return time_ratios(pairs, PRICE_TURNS)


def as_dict(problem: str, rows: Sequence[dict], prices: Mapping[tuple[str, str], float]) -> dict:
    """Returns the map for JSON: for every method and treatment the survived periods at each amplitude and step."""
    kind = PROBLEMS[problem].scene
    lines: dict[tuple[str, str], dict[str, Any]] = {}
    for row in completed_rows(rows):
        scene, key = row["scene"], (row["scene"]["method"], treatment_of(row))
        line = lines.setdefault(key, {"method": key[0], "treatment": key[1], "price": prices.get(key), "lives": [],
                                      "predicted": {}, "automatic_cfl": {}})
        line["lives"].append({"amplitude": scene["amplitude"], "cfl": scene["cfl"], "periods": survived_periods(row),
                              "held": stayed_accurate(row), "status": row["status"],
                              "first_period": row["life"]["first_period"],
                              "margin": row["step"]["margin"] if "step" in row else None})
        at = f"{scene['amplitude']:g}"
        if key[1] in TREATMENTS and at not in line["automatic_cfl"]:
            asked = replace(gentle_scene_for_timing(kind, row, key[1]), amplitude=scene["amplitude"])
            line["automatic_cfl"][at] = SAFE * asked.step_bound * asked.wave_speed / asked.spacing
            line["predicted"][at] = PROBLEMS[problem].predicted_life(asked)
    order = {name: place for place, name in enumerate(TREATMENTS)}
    found = sorted(lines.values(), key=lambda line: (kind.choices("method").index(line["method"]),
                                                     order.get(line["treatment"], len(order))))
    return {"schema": SCHEMA, "problem": problem, "lines": found, "rows": list(rows)}


def as_markdown(values: dict) -> str:
    """Returns the map of :func:`as_dict` in Markdown: survived periods by amplitude, shortest step first."""
    lives = [life for line in values["lines"] for life in line["lives"]]
    if not lives:
        return "# Stability: no run was possible\n"
    amplitudes = sorted({life["amplitude"] for life in lives})
    steps = sorted({life["cfl"] for life in lives})
    scene = next(row["scene"] for row in values["rows"] if row["scene"])
    heads = ["method", "called for", "price of a step", *(f"A = {A:g}" for A in amplitudes), "error in period 1",
             "predicted life"]
    kind = PROBLEMS[values["problem"]].scene
    text = [f"# Stability of the {kind.TITLE}",
            f"Periods until the error of x exceeds A/10 or the run breaks, of {scene['periods']:g}; {NOTHING} means "
            f"that it held to the end. {scene['cells']} cells, {' x '.join([str(scene['ppc'])] * kind.DIMENSIONS)} "
            f"particles per cell. In each column the lives at cfl {' / '.join(f'{cfl:g}' for cfl in steps)}, then the "
            "cfl that --dt auto takes. Price: seconds of a step over the plain method's. Error in period 1: of x, in "
            "amplitudes, at the smallest A and step. Predicted: periods until the drift of the velocity that no node "
            "sees reaches A w, by theory alone, at each A; other causes may come first.",
            markdown_table(heads, [_line(line, amplitudes, steps) for line in values["lines"]])]
    return "\n\n".join(text) + "\n"


def _line(line: dict, amplitudes: Sequence[float], steps: Sequence[float]) -> list[str]:
    lives = {(life["amplitude"], life["cfl"]): life for life in line["lives"]}
    cells = []
    for A in amplitudes:
        found = [lives.get((A, cfl)) for cfl in steps]
        auto = line["automatic_cfl"].get(f"{A:g}")
        cells.append(" / ".join(" " if life is None else NOTHING if life["held"] else f"{life['periods']:.3g}"
                                for life in found) + (f" (auto {auto:.2f})" if auto else ""))
    first = lives.get((amplitudes[0], steps[0]), {}).get("first_period")
    predicted = " / ".join(f"{value:.0f}" for value in line["predicted"].values() if value is not None)
    return [line["method"], line["treatment"], NOTHING if line["price"] is None else f"{line['price']:.2f}", *cells,
            NOTHING if first is None else f"{first:.2g}", predicted or NOTHING]
