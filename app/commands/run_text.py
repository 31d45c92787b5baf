"""The summary that ``mpm-lab run`` prints for people, made from the JSON object and nothing else."""

from app.words import QUANTITIES, per_cell

NOTHING = "-"


def run_table(result: dict) -> str:
    """Heading, errors, estimates of each estimator, and what the run cost."""
    parts = [_heading(result), _errors(result["error"])]
    estimates = {name: values for name, values in _by_estimator(result).items() if name not in result["not_valid"]}
    parts += [_estimates(name, *values) for name, values in estimates.items()]
    if estimates:
        parts += ["index: estimate over truth, 1 is perfect; distance: their difference over truth, 0 is perfect"]
    parts += [f"estimate: {name}\n{sentence}" for name, sentence in result["not_valid"].items()]
    return "\n\n".join([*parts, _cost(result)])


def _heading(result: dict) -> str:
    scene = result["scene"]
    per = per_cell(scene["problem"], scene["ppc"])
    return (f"{scene['problem']}, {scene['method']}, {scene['cells']} cells, {per} particles per cell "
            f"({result['particles']:,}), amplitude {scene['amplitude']:g} m, cfl {scene['cfl']:.3g}\n"
            f"{result['status']}: {result['steps']:,} steps to t = {result['t']:.6g} s")


def _norm(key: str) -> str:
    """What an error is of, with its unit; a problem's own norms say first which quantity they are of: a_nodes."""
    return f"{key} ({QUANTITIES[key.partition('_')[0]].unit})"


def _errors(error: dict) -> str:
    rows = [(_norm(q), *(_size(values[k]) for k in ("final", "max", "mean"))) for q, values in error.items()]
    return _columns([("true error, RMS", "final", "max", "mean"), *rows])


def _estimates(name: str, estimate: dict, index: dict, distance: dict) -> str:
    rows = [(_norm(q), *(_size(estimate[q][k]) for k in ("final", "max", "mean")),
             _ratio(index[q]), _ratio(distance[q])) for q in QUANTITIES]
    heads = (f"estimate: {name}", "final", "max", "mean", "index", "distance")
    return _columns([heads, *rows])


def _by_estimator(result: dict) -> dict:
    """``{estimator: (estimate, index, distance)}``; one estimator's values are not keyed by its name."""
    names = result["scene"]["estimator"] if "estimate" in result["effects"] else []
    blocks = [result[key] for key in ("estimate", "index", "distance")]
    if len(names) == 1:
        return {names[0]: blocks}
    return {name: [block[name] for block in blocks] for name in names}


def _cost(result: dict) -> str:
    energy, seconds, crossings = result["energy"], result["seconds"], result["grid_crossings"]
    estimators = "" if seconds["estimate"] is None else f"; estimators {seconds['estimate']:.3g} s of it"
    rows = [("grid crossings", NOTHING if crossings is None else f"{crossings:,}"),
            ("energy drift", _percent(energy["drift"]) if energy else NOTHING),
            ("time", f"{seconds['run']:.3g} s{estimators}; and {seconds['compile']:.3g} s to compile"),
            ("rate", f"{result['rate']:.3g} million particle-steps/s on {result['arch']}, "
             f"{result['threads']} thread{'s' * (result['threads'] != 1)}, {result['plan']} plan"
             if result["rate"] else NOTHING)]
    return "\n".join(f"{name:<16}{value}" for name, value in rows)


def _columns(rows: list[tuple[str, ...]]) -> str:
    return "\n".join(f"{row[0]:<24}" + "".join(f"{cell:>12}" for cell in row[1:]) for row in rows)


def _size(value: float | None) -> str:
    return NOTHING if value is None else f"{value:.3e}"


def _ratio(value: float | None) -> str:
    return NOTHING if value is None else f"{value:.3f}"


def _percent(value: float | None) -> str:
    return NOTHING if value is None else f"{100 * value:.3g} %"
