"""A stability map as one object and as Markdown (see ``solvers.study.stability``)."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from solvers.problems import PROBLEMS
from solvers.scene.scene import Scene
from solvers.scene.step_bound import SAFE
from solvers.study.markdown import grid
from solvers.study.series import measured
from solvers.study.stability import TREATMENTS, held, scene_of, survived, treatment_of

SCHEMA = "mpm-lab/stability/1"
NOTHING = "–"


def as_dict(problem: str, rows: Sequence[dict], prices: Mapping[tuple[str, str], float]) -> dict:
    """The map: a line for every method and treatment, with the lives at each amplitude and step."""
    kind = PROBLEMS[problem].scene
    lines: dict[tuple[str, str], dict[str, Any]] = {}
    for row in measured(rows):
        scene, key = row["scene"], (row["scene"]["method"], treatment_of(row))
        line = lines.setdefault(key, {"method": key[0], "treatment": key[1], "price": prices.get(key), "lives": [],
                                      "predicted": {}, "automatic_cfl": {}})
        line["lives"].append({"amplitude": scene["amplitude"], "cfl": scene["cfl"], "periods": survived(row),
                              "held": held(row), "status": row["status"], "first_period": row["life"]["first_period"],
                              "margin": row["step"]["margin"] if "step" in row else None})
        at, asked = f"{scene['amplitude']:g}", _scene(kind, row)
        if asked is not None and at not in line["automatic_cfl"]:
            line["automatic_cfl"][at] = SAFE * asked.step_bound * asked.wave_speed / asked.spacing
            line["predicted"][at] = PROBLEMS[problem].predicted_life(asked)
    order = {name: place for place, name in enumerate(TREATMENTS)}
    found = sorted(lines.values(), key=lambda line: (kind.choices("method").index(line["method"]),
                                                     order.get(line["treatment"], len(order))))
    return {"schema": SCHEMA, "problem": problem, "lines": found, "rows": list(rows)}


def _scene(kind: type[Scene], row: Mapping) -> Scene | None:
    """The scene of a row, without its length."""
    treated = scene_of(kind, row, treatment_of(row)) if treatment_of(row) in TREATMENTS else None
    return treated and replace(treated, amplitude=row["scene"]["amplitude"])


def as_markdown(values: dict) -> str:
    """The map for a reader: lives at each amplitude, from the shortest step to the longest."""
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
            grid(heads, [_line(line, amplitudes, steps) for line in values["lines"]])]
    return "\n\n".join(text) + "\n"


def _line(line: dict, amplitudes: Sequence[float], steps: Sequence[float]) -> list[str]:
    lives = {(life["amplitude"], life["cfl"]): life for life in line["lives"]}
    cells = []
    for A in amplitudes:
        found = [lives.get((A, cfl)) for cfl in steps]
        auto = line["automatic_cfl"].get(f"{A:g}")
        cells.append(" / ".join(map(_life, found)) + (f" (auto {auto:.2f})" if auto else ""))
    first = lives.get((amplitudes[0], steps[0]), {}).get("first_period")
    predicted = " / ".join(f"{value:.0f}" for value in line["predicted"].values() if value is not None)
    return [line["method"], line["treatment"], NOTHING if line["price"] is None else f"{line['price']:.2f}", *cells,
            NOTHING if first is None else f"{first:.2g}", predicted or NOTHING]


def _life(life: dict | None) -> str:
    if life is None:
        return " "
    return NOTHING if life["held"] else f"{life['periods']:.3g}"
