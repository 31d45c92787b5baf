"""Text summary of ``mpm-lab run``, made from the JSON object, and the goals with their error bars."""

from collections.abc import Iterator, Sequence

from app.names_and_units import QUANTITIES, particles_per_cell, unit_of
from solvers.motion.laws.elastic_material import NEO_HOOKEAN
from solvers.problems import PROBLEMS
from solvers.running.quantities_of_interest import SAFETY
from solvers.running.result import Result
from solvers.scene.effects import ALL, EFFECTS, PER_CENT, Number, output_lines_by_effect
from solvers.scene.error_causes import FIELDS, cause_labels
from solvers.scene.estimator_registry import COMPANION
from solvers.study.coverage.estimate_coverage_counts import wilson_interval
from solvers.study.coverage.track_record_and_bets import RunSoFar, bars_held
from solvers.untrusted.number_parsing import LARGEST_EXACT

NOTHING = "-"
UNITS = {"x": "m", "v": "m/s", "F": "1"}
STEP_MEANING = ("\nwithout what a step leaves out, at the same steps; shorter ones also map more often between "
                "particles and\ngrid, and may have larger errors")
SUMMARY = ("final", "max", "mean")
GOAL_WIDTH = 14
BAR_MEANING = f"bar: {SAFETY:g} times the estimated error of the number"
HELD_MEANING = ("held: how often such a bar held the truth in runs\n"
                "like this one that were drawn at random (mpm-lab coverage)")


def run_table(result: dict, corrected: str = "") -> str:
    """Returns the text for a run's JSON object: heading, errors, estimates of each estimator, what is left of the error
    when the estimate by ``corrected`` (an estimator's name, "" for none) is subtracted, times."""
    errors = [_norm_row(key, summary) for key, summary in result["error"].items()]
    parts = [_heading(result), _align_columns([("true error, RMS", *SUMMARY), *errors])]
    names = result["scene"]["estimator"] if "estimate" in result["effects"] else []
    estimates = [name for name in names if name not in result["not_valid"]]
    for name in estimates:  # a single estimator's values are not keyed by its name
        estimate, index, distance = (result[key] if len(names) == 1 else result[key][name]
                                     for key in ("estimate", "index", "distance"))
        rows = [(*_norm_row(q, estimate[q]), format_value(index[q], ".3f"),
                 format_value(distance[q], ".3f")) for q in QUANTITIES]
        parts.append(_align_columns([(f"estimate: {name}", *SUMMARY, "index", "distance"), *rows]))
    if estimates:
        parts += ["index: estimate over truth, 1 is perfect; distance: their difference over truth, 0 is perfect"]
    if estimates and result["rounding"]:
        parts += ["\n".join(f"no index of {q}: {why}" for q, why in result["rounding"].items())]
    if corrected:
        parts.append(_corrected_table(result, corrected))
    parts += [f"estimate: {name}\n{sentence}" for name, sentence in result["not_valid"].items()]
    if result.get("budget"):
        parts.append(budget_table(result["budget"], result["grid_crossings"] != 0))
    return "\n\n".join([*parts, _cost_text(result)])


def _corrected_table(result: dict, estimator: str) -> str:
    """Returns a text table of the RMS errors of the result minus its estimate by an estimator, or why it has none."""
    if why := result["not_valid"].get(estimator):
        return f"not corrected: {why}"
    left = result["corrected"][estimator]
    factors = [None if not left[q]["max"] else result["error"][q]["max"] / left[q]["max"] for q in QUANTITIES]
    rows = [(*_norm_row(q, left[q]), format_value(factor, ".3g"))
            for q, factor in zip(QUANTITIES, factors, strict=True)]
    return _align_columns([(f"corrected by {estimator}", *SUMMARY, "smaller by"), *rows]) \
        + f"\nno MPM is left in it: the result is the {COMPANION}'s own" * (estimator == COMPANION)


def budget_table(budget: dict, crossed: bool) -> str:
    """Returns a text table of each cause's share of the errors of x, v and F, or why they are not valid; ``crossed`` is
    whether a particle has changed its cell."""
    rows = [(cause, *(format_share(budget[field][name]) for field in FIELDS))
            for name, cause in cause_labels(crossed).items()]
    whose = "the error" if budget["reference"] == "exact" else f"what the {budget['reference']} has the error is"
    text = _align_columns([("share of the error of", *FIELDS), *rows])
    return f"{text}\n{budget['not_valid'] or f'shares of {whose} over the run, adding up to 1'}"


def _heading(result: dict) -> str:
    scene = result["scene"]
    per = particles_per_cell(scene["problem"], scene["ppc"])
    if scene["amplitude"] is None:
        moving = f"patch test with stretch {scene['stretch']:g} at {scene['initial_velocity']:g} m/s"
    elif scene.get("displacement"):
        moving = f"displacement {scene['displacement']}"
    else:
        moving = f"amplitude {scene['amplitude']:g} {unit_of(PROBLEMS[scene['problem']].scene, 'amplitude')}"
    if scene.get("law", NEO_HOOKEAN) != NEO_HOOKEAN:
        moving += f", {scene['law']}"
    # Quantities that the status ok does not include.
    doubts = f" for x, not for {', '.join(result['as_large_as_itself'])}" \
        if result["status"] == "ok" and result["as_large_as_itself"] else ""
    return (f"{scene['problem']}, {scene['method']}, {scene['cells']} cells, {per} "
            f"({result['particles']:,}), {moving}, cfl {scene['cfl']:.3g}\n"
            f"{result['status']}{doubts}: {result['steps']:,} steps to t = {result['t']:.6g} s"
            + f"\n{result['not_checked']}" * bool(result["not_checked"]))


def _norm_row(key: str, summary: dict) -> tuple[str, ...]:
    """Returns the cells of a norm's row: its key, such as x or a_nodes, with the unit, then final, max and mean."""
    name = f"{key} ({QUANTITIES[key.partition('_')[0]].unit})"
    return name, *(format_value(summary[part], ".3e") for part in SUMMARY)


def removed_cause_table(values: dict, crossed: bool) -> str:
    """Returns a text table of the RMS errors with all causes, predicted without one, and run again; ``crossed`` is
    whether a particle has changed its cell."""
    heads = {"before": "before", "predicted": "predicted", "again": "run again"}
    rows = [(words, *(format_value(values[key][field], ".3e") for field in FIELDS)) for key, words in heads.items()]
    return _align_columns([(f"without {cause_labels(crossed)[values['class']]}, RMS",
                            *(f"{field} ({UNITS[field]})" for field in FIELDS)),
                           *rows]) + STEP_MEANING * (values["class"] == "time_step")


def _effect_lines(result: dict) -> Iterator[tuple[str, str]]:
    """Yields name and text of a line for each effect with numbers in a run's JSON object; those of only some problems
    if they are on."""
    for name, line in output_lines_by_effect(lambda effect: effect.text).items():
        effect, found = ALL[name], result[ALL[name].json_key]
        if found is not None or name in EFFECTS:
            values = found if isinstance(found, dict) else {"": found}
            texts = {number.key: _format_number(values.get(number.key), number) for number in effect.numbers}
            yield line.name, line.words.format(*texts.values(), **texts)


def _format_number(value: float | None, number: Number) -> str:
    if number.unit == PER_CENT:
        return NOTHING if value is None else f"{100 * value:.3g} %"
    counted = number.kind is int and value is not None and value < LARGEST_EXACT  # a broken run counts beyond it
    return format_value(value, "," if counted else ".4g") + f" {number.unit}" * bool(number.unit)


def _cost_text(result: dict) -> str:
    seconds = result["seconds"]
    estimators = "" if seconds["estimate"] is None else f"; estimators {seconds['estimate']:.3g} s of it"
    rows = [*_effect_lines(result),
            ("time", f"{seconds['run']:.3g} s{estimators}; and {seconds['compile']:.3g} s to compile"),
            ("rate", f"{result['rate']:.3g} million particle-steps/s on {result['arch']}, "
             f"{result['threads']} thread{'s' * (result['threads'] != 1)}, {result['plan']} plan"
             if result["rate"] else NOTHING)]
    return "\n".join(f"{name:<15} {value}" for name, value in rows)


def _align_columns(rows: list[tuple[str, ...]]) -> str:
    return "\n".join(f"{row[0]:<24}" + "".join(f"{cell:>12}" for cell in row[1:]) for row in rows)


def format_value(value: float | None, form: str) -> str:
    """Formats a number by a format such as ".3g"; a dash for None."""
    return NOTHING if value is None else format(value, form)


def format_share(value: float | None) -> str:
    """Formats a share to three decimals, one that rounds to 0 without a sign; a dash for None."""
    return format_value(None if value is None else round(value, 3) + 0.0, ".3f")


def goal_table(result: Result) -> str:
    """Returns a text for each of a run's goals, and one on their error bars if they have any; "" without goals."""
    if not result.goals:
        return ""
    drawn, blocks, seen = RunSoFar(result.scene, result.status, result.time), [], []
    for name, goal in result.goals.items():
        unit = goal["unit"]
        lines = [f"{name:<24}{format_value(goal['value'], '.6g'):>{GOAL_WIDTH}} {unit}"]
        for estimator, bar in goal["bar"].items():
            counts = bars_held(drawn, name, estimator) if bar is not None else None
            seen += [counts] if counts else []
            often = "   held {} of {}".format(*counts) if counts else ""
            lines.append(f"  {'+- ' + estimator:<22}{format_value(bar, '.2g'):>{GOAL_WIDTH}} {unit}{often}")
        if goal["true_error"] is not None:
            lines.append(f"  {'true error':<22}{format_value(goal['true_error'], '.2g'):>{GOAL_WIDTH}} {unit}")
        blocks.append("\n".join(lines))
    if any(goal["bar"] for goal in result.goals.values()):
        blocks.append(_bar_meaning(seen, drawn.why_not_counted))
    return "\n\n".join(["", *blocks])


def _bar_meaning(counts: Sequence[tuple[int, int]], why_not: str) -> str:
    """Returns what an error bar is and what is known of how often such bars hold: ``counts`` of those that held and of
    all, or ``why_not``, why no drawn run is like this one."""
    if not counts:
        return f"{BAR_MEANING}; how often such bars hold is not known:\n{why_not or 'too few such runs were drawn'}"
    least = min((all_runs for held, all_runs in counts if held == all_runs), default=None)
    sure = f";\nof {least} of {least} the 95 % interval begins at {100 * wilson_interval(least, least)[0]:.0f} %" \
        if least else ""
    return f"{BAR_MEANING}; {HELD_MEANING}{sure}"
