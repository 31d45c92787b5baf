"""Readout of a run: each estimator beside the truth, the worst regions, the run itself, and tooltips."""

import html
import json
import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from app.colour_palette import ESTIMATE, PINNED, TRUTH
from app.frame.error_view_captions import ESTIMATED, TRUE, why_no_numbers
from app.language.translation import lazy, tr, translate_message
from app.names_and_units import NOTHING, QUANTITIES, difference_text, format_ratio, per_cent, with_unit
from app.page.stage.worst_region import BodyRegionErrors, WorstRegions
from app.page.visit.history import NormHistory, last_value, series_until
from app.page.visit.pinned_run import PinnedRun
from app.page.visit.run_session import RunSession
from solvers.engine.engine_messages import FrameReport
from solvers.running.quantities_of_interest import ENERGY, STRESS
from solvers.scene.effects import ALL, PER_CENT, Number, OutputLine, output_lines_by_effect
from solvers.scene.estimator_registry import ESTIMATORS
from solvers.solver.error_series import is_only_rounding
from solvers.solver.rounding import largest_rounding_error
from solvers.solver.soundness import OK, UNSTABLE
from solvers.study.coverage.estimate_coverage_counts import wilson_interval
from solvers.study.coverage.track_record_and_bets import RunSoFar, accurate_run_counts, bars_held

#: Tooltips of rows.
HINTS = {
    lazy("time"): lazy("simulated time since the start, and in periods of the exact vibration"),
    lazy("steps"): lazy("time steps taken, and how long each is"),
    lazy("step"): lazy("the time step divided by the stability bound of the present configuration (linear theory); "
                       "above 1 the run breaks"),
    lazy("solver"): lazy("how fast the kernels run, waiting not counted, and on what"),
    lazy("speed"): lazy("periods of the vibration in a second of yours: reached, of those asked for"),
    lazy("shown"): lazy("an earlier frame, of those that the slider Look back goes through"),
    lazy("kinetic energy"): lazy("of all particles, ± twice the error by the estimator on the stage"),
    lazy("mean stress"): lazy("over the undeformed body, ± twice the error by the estimator on the stage"),
    lazy("verdict"): lazy("a run is ok if its positions are ok; this quantity has a relative error near 1"),
    lazy("unseen"): lazy("what the verdict does not check"),
    lazy("region"): lazy("mean and worst error of the particles in a rectangle that you drag on the stage")}
#: Tooltips of columns, or of several rows.
NORM = lazy("root of the mean square over the particles, now")
INDEX = lazy("error index: estimated over true, summed over the run so far; 1 is perfect")
DISTANCE = lazy("norm of estimate − truth over the norm of the truth; 0 is perfect")
WORST = lazy("where the root mean square of the error is largest, by the estimate on the stage and in truth")

CAPPED_BELOW = 0.9  # of the speed asked for
ROUNDED = lazy("nothing but rounding")
GOALS = {ENERGY: lazy("kinetic energy"), STRESS: lazy("mean stress")}
SHORT = 30  # characters of a reason that fit beside a name
BARS = lazy("{value} ± {bar}; such bars held in {n} of {all} runs like this (95\N{NO-BREAK SPACE}% interval from "
            "{least:.0f}\N{NO-BREAK SPACE}%)")
NO_RECORD = lazy("{value} ± {bar}; how often such bars hold is not known: {reason}")
DRAG = lazy("drag a rectangle on the stage")


@dataclass(frozen=True)
class ReadoutTables:
    """Html tables of the ``errors`` by estimator and of the rest, ``beside``; ``cards_json`` is
    :func:`estimator_cards_json`."""

    errors: str
    beside: str
    cards_json: str = ""

    @property
    def html(self) -> str:
        return f"<div class='lab-readout'>{self.errors}{self.beside}</div>"


def live_readout(session: RunSession, history: NormHistory, report: FrameReport, quantity: str, estimator: str | None,
                 probed: str | None, worst: WorstRegions, ago: float = 0.0) -> ReadoutTables:
    """Returns a frame's numbers as tables, for a quantity ("x") and the ``estimator`` on the stage. ``history`` is that
    of the frame's run, ``probed`` the text of errors in a dragged rectangle, ``ago`` the frame's age in periods."""
    series = series_until(history.series, report.time)
    run = _run_table(session, history, report, series, estimator, probed, ago)
    return ReadoutTables(_estimate_rows(session, report, series, quantity, estimator),
                         _worst_rows(worst, estimator, quantity) + run,
                         estimator_cards_json(report, series, quantity, estimator))


def estimator_cards_json(report: FrameReport, series: dict[str, np.ndarray], quantity: str,
                         estimator: str | None) -> str:
    """Returns as JSON the data of the estimators' cards, for a quantity ("x") and the sampled ``series`` up to the
    frame.

    Keys: the ``problem``; the estimator on the ``stage``; and for each of the ``judges`` how much of the true error it
    ``finds`` now as text, and how often it was right in similar runs (``trust``), or what it ``says`` instead."""
    why_not = missing_reasons(report, series, quantity)
    true = last_value(series, f"error_{quantity}")
    judges: dict[str, dict[str, str]] = {}
    drawn = RunSoFar(report.scene, report.status, report.time)
    for name in report.scene.estimators:
        if says := why_not[name]:
            judges[name] = {"says": says[:1].upper() + says[1:]}
        else:
            counts = accurate_run_counts(drawn, name, quantity)  # None if not counted
            found = last_value(series, f"{name}/estimate_{quantity}") / true if true else math.nan
            judges[name] = {"finds": per_cent(found) if math.isfinite(found) else NOTHING,
                            "trust": "" if counts is None else tr(
                                "within 10\N{NO-BREAK SPACE}% of the truth in {n} of {all} such runs",
                                n=counts[0], all=counts[1])}
    return json.dumps({"problem": report.scene.problem, "stage": estimator, "judges": judges})


def _run_table(session: RunSession, history: NormHistory, report: FrameReport, series: dict[str, np.ndarray],
               estimator: str | None, probed: str | None, ago: float) -> str:
    scene = report.scene
    speed = report.real_speed / scene.period if report.playing and report.real_speed is not None else None
    slow = speed is not None and speed < CAPPED_BELOW * session.speed
    moves = tr("{speed} of {asked:.3g} periods/s", speed=NOTHING if speed is None else f"{speed:.2g}",
               asked=session.speed) + f" <span class='lab-capped'>{tr('CAPPED')}</span>" * slow
    rests = tr("stopped") if report.status == UNSTABLE else tr("at its end") if session.is_over else tr("paused")
    margin = history.step_to_bound_ratio
    if ago:
        known = series.get("margin", np.zeros(0))
        margin = next(reversed(known[np.isfinite(known)]), math.nan)
    rows = [("time", tr("{time:.4g} s = {periods:.2f} periods", time=report.time, periods=report.time / scene.period)),
            ("shown", tr("<b>{periods:.2f} periods back</b>, {rests}", periods=ago, rests=rests)) if ago else
            ("speed", moves if report.playing else
             tr("<b>{rests}</b>, {speed:.3g} periods/s asked", rests=rests, speed=session.speed))]
    lines = output_lines_by_effect(lambda effect: effect.readout)
    rows += [(line.name, text) for name, line in lines.items()
             if scene.has(name) and (text := _effect_html(name, line, series))]
    if scene.has("margin"):
        text = tr("{margin} of its bound", margin=format_ratio(margin))
        rows.append(("step", NOTHING if math.isnan(margin) else  # no node has mass before the first step
                     f"<span class='lab-over'>{text}</span>" if margin > 1 else text))
    rows += [] if ago else list(_goal_rows(report, estimator))
    rows += [
        ("steps", tr("{steps:,} of {length}", steps=report.step, length=with_unit(scene.time_step, "s"))),
        ("solver", tr("{rate:.1f} M particle-steps/s on {arch}", rate=report.rate, arch=html.escape(report.arch))),
        *([("verdict", html.escape(translate_message(report.reason)))] if report.status == OK and report.reason
          else []),
        *([("unseen", html.escape(translate_message(report.not_checked)))] if report.not_checked else []),
        ("region", html.escape(probed or tr(DRAG)))]
    hints = {**{line.name: line.hint for line in lines.values()}, **HINTS}
    return table_html("".join(f"<tr title=\"{html.escape(tr(hints[name]) if hints[name] else '')}\">"
                              f"<td>{html.escape(tr(name))}</td>\n<td>{text}</td></tr>\n" for name, text in rows),
                      "lab-run")


def _goal_rows(report: FrameReport, estimator: str | None) -> Iterator[tuple[str, str]]:
    """Yields label and text of each quantity of the whole body, with the error bar of an estimator (by name), if it has
    one, and how often such bars held in similar runs."""
    drawn = RunSoFar(report.scene, report.status, report.time)
    for name, goal in report.goals.items():
        if goal["value"] is None:
            continue
        text, bar = with_unit(goal["value"], goal["unit"]), goal["bar"].get(estimator)
        if bar is not None:
            counts, size = bars_held(drawn, name, estimator or ""), with_unit(bar, goal["unit"])
            if counts:
                text = tr(BARS, value=text, bar=size, n=counts[0], all=counts[1],
                          least=100 * wilson_interval(*counts)[0])
            else:
                text = tr(NO_RECORD, value=text, bar=size, reason=translate_message(drawn.why_not_counted)) \
                    if drawn.why_not_counted else f"{text} ± {size}"
        yield GOALS[name], html.escape(text)


def _effect_html(name: str, line: OutputLine, series: dict[str, np.ndarray]) -> str:
    """Returns an effect's numbers so far as html, with traffic lights for those that have bounds; "" if unknown."""
    numbers, values = ALL[name].numbers, ALL[name].values(series) if len(series.get("time", ())) else {}
    if all(value is None for value in values.values()):
        return ""
    lights = "".join(traffic_light(abs(value), number.bounds) for number in numbers
                     if number.bounds and (value := values[number.key]) is not None)
    texts = {number.key: _format_number(values[number.key], number) for number in numbers}
    return lights + html.escape(tr(line.words)).format(*texts.values(), **texts)


def _format_number(value: float | None, number: Number) -> str:
    if number.unit == PER_CENT or value is None:
        return _percent(value)
    return f"{value:,}" if number.kind is int else with_unit(value, number.unit) if number.unit else f"{value:.3g}"


def traffic_light(size: float, bounds: tuple[float, float]) -> str:
    """Returns html of a light and a word before a number: good up to ``bounds[0]``, bad above ``bounds[1]``."""
    kind, word = ("good", tr("fine")) if size <= bounds[0] else ("watch", tr("watch it")) if size <= bounds[1] else \
        ("bad", tr("alarming"))
    return f"<span class='lab-light lab-{kind}'>{word}</span> "


def _percent(share: float | None) -> str:
    if share is None:
        return NOTHING
    sign = "−" if share < 0 else "+"
    if f"{share:.2%}".lstrip("-") == "0.00%":
        return "0.00%"
    return f"{sign}{abs(share):.2%}" if abs(share) < 10 else f"{sign}{format_ratio(100 * abs(share))}%"


def _estimate_rows(session: RunSession, report: FrameReport, series: dict[str, np.ndarray], key: str,
                   estimator: str | None) -> str:
    """Returns a table: the norm now, index and distance so far, of the truth, each estimator and a pinned run."""
    unit = QUANTITIES[key].unit
    heads = (f"<span title=\"{html.escape(tr(hint))}\">{head}</span>" for head, hint in
             ((tr("norm now"), NORM), (tr("index so far"), INDEX), (tr("distance so far"), DISTANCE)))
    rows = [row_html("head", tr("error of {symbol}", symbol=QUANTITIES[key].symbol), *heads)]
    for name, silence in missing_reasons(report, series, key).items():
        if len(silence) > SHORT:
            rows.append(row_html("", f"<span class='lab-name'>{name_with_line_sample(name)}</span>: "
                                     f"{html.escape(silence)}"))
        elif silence:
            rows.append(row_html("", name_with_line_sample(name), html.escape(silence)))
        elif name == TRUE:
            rows.append(row_html("", name_with_line_sample(name), format_norm(series, f"error_{key}", unit), "", ""))
        else:
            rows.append(row_html("", name_with_line_sample(name), format_norm(series, f"{name}/estimate_{key}", unit),
                                 _ratio(series, f"{name}/index_{key}"), _ratio(series, f"{name}/distance_{key}")))
    if session.pinned:
        # How it differs: the stage shows it, but not to screen readers.
        said = "" if session.pinned.scene.problem != report.scene.problem else \
            difference_text(session.pinned.scene, report.scene) or tr("the same so far")
        rows.append(_pinned_rows(session.pinned, said, key, estimator))
    return table_html("".join(rows), "lab-numbers lab-estimates")


def _pinned_rows(run: PinnedRun, difference: str, key: str, drawn: str | None) -> str:
    """Returns a pinned run's rows: its true error, its estimator's index and distance, how it differs from the run."""
    estimator, series = run.estimator(drawn), run.history.series
    what = tr("norm: its true error; index and distance: its estimate by {estimator}", estimator=estimator) \
        if estimator else tr(NORM)
    name = f"<span title='{html.escape(what)}'>{line_svg(PINNED)} {tr('pinned')}</span>"
    if trouble := run.stop_reason():
        difference = f"{difference}; {trouble}"
    ratios = (_ratio(series, f"{estimator}/{ratio}_{key}") for ratio in ("index", "distance"))
    return row_html("", name, format_norm(series, f"error_{key}", QUANTITIES[key].unit), *ratios) \
        + row_html("", f"<span class='lab-name'>{tr('pinned: {run}', run=html.escape(difference))}</span>")


def missing_reasons(report: FrameReport, series: dict[str, np.ndarray], quantity: str) -> dict[str, str]:
    """Returns for the truth and each estimator (by name) why it has no number of a quantity ("x"), or "" if it has."""
    norms = {name: series.get(f"{name}/estimate_{quantity}", np.zeros(0)) for name in report.scene.estimators}
    silent = {name for name, values in norms.items() if len(values) and not np.isfinite(values).any()}
    reasons = why_no_numbers(report.scene, report.not_valid, quantity, silent)
    true = series.get(f"error_{quantity}", np.zeros(0))
    if len(true) > 1 and is_only_rounding(true, largest_rounding_error(report.scene, quantity, report.step)):
        reasons |= {name: reason or tr(ROUNDED) for name, reason in reasons.items() if name != TRUE}
    return reasons


def _worst_rows(worst: WorstRegions, estimator: str | None, quantity: str) -> str:
    """Returns a table of the regions with the largest error of a quantity ("x"), by estimate and by truth."""
    by = [(estimator, worst.by_estimate)] if estimator else []
    heads = "".join(f"<td>{head}</td>" for head in (tr("estim."), tr(TRUE)))
    rows = [f"<tr class='lab-head' title='{html.escape(tr(WORST))}'>"
            f"<td colspan='2'>{tr('worst region')}</td>{heads}</tr>",
            *(row_html("", html.escape(_row_label(name)), *_region_cells(region, QUANTITIES[quantity].unit))
              for name, region in (*by, (TRUE, worst.by_truth)))]
    return table_html("".join(rows), "lab-numbers lab-worst")


def _region_cells(region: BodyRegionErrors | None, unit: str) -> tuple[str, ...]:
    if region is None:
        return tr("unknown"), "", ""
    place = ", ".join(f"<span class='lab-together'>{html.escape(part)}</span>" for part in region.name.split(", "))
    return (place, *(NOTHING if value is None else with_unit(value, unit, 2)
                     for value in (region.estimated, region.true)))


def table_html(rows: str, kind: str = "") -> str:
    """Returns an html table of rows; ``kind`` is its CSS class."""
    return f"<table class='{kind}'>{rows}</table>"


def row_html(kind: str, *cells: str) -> str:
    """Returns an html row of up to four ``cells`` (html), the last spanning what is left; ``kind`` is a CSS class."""
    span = 5 - len(cells)
    first = "".join(f"<td>{cell}</td>\n" for cell in cells[:-1])
    last = f"<td colspan={span} class='lab-silence'>" if span > 1 else "<td>"
    return f"<tr class='lab-{kind}'>{first}{last}{cells[-1]}</td></tr>\n"


def name_with_line_sample(name: str) -> str:
    """Returns html: the name of an estimator or the truth after a sample of its line in the plots."""
    return f"{line_sample(name)} {html.escape(_row_label(name))}"


def _row_label(name: str) -> str:
    """Returns the name to show for a key: translated for truth and estimate, unchanged for an estimator."""
    return tr(name) if name in (TRUE, ESTIMATED) else name


def line_sample(name: str) -> str:
    """Returns svg of a short line in the style of an estimator (by name), of the truth or of estimates in general."""
    known = ESTIMATORS.get(name)
    colour = known.colour if known else TRUTH if name == TRUE else ESTIMATE
    own = "truth" if name == TRUE else name.replace("-", "")
    return line_svg(f"var(--{html.escape(own)}, {colour})", known.dashes if known else ())


def line_svg(colour: str, dashes: tuple[int, ...] = ()) -> str:
    """Returns a short line as svg in a CSS colour, with dashes given in pixels."""
    dashed = f" stroke-dasharray='{','.join(map(str, dashes))}'" if dashes else ""
    return "<svg width='18' height='8' aria-hidden='true'>" \
           f"<path d='M0 4h18' style='stroke: {colour}' stroke-width='3'{dashed}/></svg>"


def format_norm(series: dict[str, np.ndarray], name: str, unit: str) -> str:
    """Returns the last value of a series (by ``name``), in a unit, as text; a dash if unknown."""
    return with_unit(value, unit) if math.isfinite(value := last_value(series, name)) else NOTHING


def _ratio(series: dict[str, np.ndarray], name: str) -> str:
    if not math.isfinite(value := last_value(series, name)):
        return NOTHING
    return format_ratio(value).replace(" × ", "×")  # otherwise it seems to continue the number before
