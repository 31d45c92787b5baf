"""Texts of the Cost tab: sentences about runs, jobs and advice, and the table of runs."""

import functools
import math
from collections.abc import Iterable, Sequence
from html import escape

from app.language.translation import lazy, localise_number, tr, translate_message, trn
from app.names_and_units import (
    NOTHING,
    QUANTITIES,
    format_number,
    format_power_of_ten,
    functions_name,
    motion_text,
    particles_per_cell,
    per_cell,
    reword_for_page,
    with_unit,
)
from app.page.features.cost.jobs import CostJobStatus
from app.page.features.cost.visitor_run_list import HERE, LIVE, SEARCH, SHIPPED, SWEEP, NumberedRun, comparable_runs
from solvers.problems import PROBLEMS
from solvers.scene.scene import Scene
from solvers.scene.stabilisations import REMEDIES
from solvers.solver.soundness import BROKEN, LOST, UNSTABLE
from solvers.study.parameter_grid import Task
from solvers.study.row import FAILED
from solvers.untrusted import number_parsing, quoting

LONGEST_BUDGET = 60.0
TOGETHER = "\N{NO-BREAK SPACE}"  # between a number and its unit, in running text
LEAST_PLAIN, MOST_PLAIN = -5, 3  # powers of ten of a percentage that are written out
MOST_LINES = 40  # rows of the table, which is rebuilt for every run
NOTHING_TO_FIND = lazy("A search makes no sense for a patch test: its error is round-off, or does not fall with the "
                       "cells. Compare methods and particles per cell instead.")
ENDS = {LOST: lazy("lost"), UNSTABLE: lazy("unstable"), FAILED: lazy("failed")}  # of runs that have no error
#: Texts about a job, by kind.
STARTING = {SWEEP: lazy("Sweep: starting."), SEARCH: lazy("Search: starting.")}
ON_THE_WAY = {SWEEP: lazy("Sweep: {done} of {total} runs."), SEARCH: lazy("Search: {done} of at least {total} runs.")}
DONE = {SWEEP: lazy("Sweep: {done} runs."),
        SEARCH: lazy("Search: {done} runs. It ends when no remaining run promises to be cheaper.")}
CANCELLED = {SWEEP: lazy("The sweep was cancelled."), SEARCH: lazy("The search was cancelled.")}
ENDED = {SWEEP: lazy("The sweep ended: {trouble}."), SEARCH: lazy("The search ended: {trouble}.")}
PAUSED = {SWEEP: lazy("The stage is paused while your sweep measures times, and continues afterwards. Press Play to "
                      "continue now."),
          SEARCH: lazy("The stage is paused while your search measures times, and continues afterwards. Press Play to "
                       "continue now.")}
BOUNDED = lazy("{name} '{typed}': give a number above 0 and up to {most:g}.")
POSITIVE = lazy("{name} '{typed}': give a number above 0, such as 1e-3.")


class InvalidNumber(ValueError):
    """Error for a text that is no valid number; the message gives the reason."""


def parse_positive(name: str, text: str, most: float = math.inf) -> float:
    """Returns the number above 0 and up to ``most`` in a field called ``name``; raises :class:`InvalidNumber`."""
    try:
        value = number_parsing.parse_float(text.strip())
    except ValueError:
        value = math.nan
    if not 0 < value <= most:
        raise InvalidNumber(tr(BOUNDED if math.isfinite(most) else POSITIVE, name=name, most=most,
                               typed=quoting.quote(text.strip(), 20)))
    return value


def parse_tolerance(text: str) -> float:
    """Returns the relative tolerance in a text such as "0.5 %", "0,5 %" or "5e-3"; raises :class:`InvalidNumber`."""
    number = text.strip().replace(",", ".")
    share = parse_positive(tr("Tolerance"), number.removesuffix("%"))
    return share / 100 if number.endswith("%") else share


def scene_summary(scene: Scene) -> str:
    """Returns method, cells, particles and Courant number of a scene in one line."""
    method = functions_name(scene.method)
    if scene.linearity_preserving:
        method = tr("linearity-preserving {method}", method=method)
    if scene.remedies:
        method = tr("{method} with {remedies}", method=method,
                    remedies=join_names([tr(REMEDIES[name].label) for name in scene.remedies]))
    return tr("{method}, {cells} cells, {particles}, CFL {number:.3g}", method=method, cells=scene.cells,
              particles=particles_per_cell(scene.problem, scene.ppc), number=scene.courant_number)


def join_names(names: Iterable[str]) -> str:
    """Joins names with "and" in the page's language."""
    return functools.reduce(lambda before, last: tr("{before} and {last}", before=before, last=last), names)


def run_sentence(run: NumberedRun) -> str:
    """Returns a run in one line: number, method, details, motion, errors or how it ended, and time."""
    scene = run.scene
    parts = [tr("run {number}: {run}", number=run.number, run=run_name(run)), run_details(run),
             f"{motion_text(scene)}, E {with_unit(scene.modulus, 'Pa')}"]
    if run.outcome in (*BROKEN, FAILED):
        return "; ".join([*parts, f"{tr(ENDS[run.outcome])}: {translate_message(run.row['reason'] or '')}"])
    of, quantity = reference_size_name(scene, run.quantity), QUANTITIES[run.quantity].noun
    if run.error is not None:
        parts.append(tr("true error of the {quantity} {share} of {whole}", quantity=quantity,
                        share=format_percent(run.error), whole=of))
    if run.estimate is not None:
        parts.append(tr("{share} of {whole}, estimated by {estimator}", share=format_percent(run.estimate), whole=of,
                        estimator=run.estimator))
    time = format_seconds(run.seconds)
    how = {LIVE: tr("{time} on the stage", time=time), SHIPPED: tr("{time} on the authors' machine", time=time)}
    return "; ".join([*parts, how.get(run.source, tr("{time} alone", time=time))])


def run_name(run: NumberedRun) -> str:
    """Returns a run's method, number of cells and what corrects it as text."""
    name = tr("{method} on {cells} cells", method=functions_name(run.method), cells=run.scene.cells)
    return tr("{run}, corrected by {estimator}", run=name, estimator=run.corrected_by) if run.corrected_by else name


def run_details(run: NumberedRun) -> str:
    """Returns a run's particles per cell, Courant number, steps and remedies as text."""
    scene = run.scene
    chosen = tr("{particles} per cell, CFL {number:.3g}, {steps:,} steps", particles=per_cell(scene.problem, scene.ppc),
                number=scene.courant_number, steps=scene.steps)
    return ", ".join([chosen, *[tr("linearity-preserving")] * scene.linearity_preserving,
                      *(tr(REMEDIES[name].label) for name in scene.remedies)])


def motion_until_end(scene: Scene) -> str:
    """Returns what moves a scene's body and until when, as text: "A = 25 mm, E 4 Pa, until 1 s"."""
    return tr("{motion}, E {modulus}, until {time}", motion=motion_text(scene), modulus=with_unit(scene.modulus, "Pa"),
              time=f"{format_number(scene.end_time)} s")


def reference_size_name(scene: Scene, quantity: str) -> str:
    """Returns the name of the size that errors of a quantity ("x") are divided by: "A" or "the largest stress"."""
    if quantity == "x" and "amplitude" in scene.motion_fields and scene.size_of("x") == scene.amplitude:
        return "A"
    return tr("the largest {quantity}", quantity=QUANTITIES[quantity].noun)


def format_percent(value: float | None) -> str:
    """Formats a fraction as a percentage of two digits: 12 %, 0.5 %, 3.1 × 10⁻⁶ %."""
    if value is None:
        return NOTHING
    digits, _, power = f"{100 * value:.1e}".partition("e")
    if not LEAST_PLAIN <= int(power) <= MOST_PLAIN:
        return f"{localise_number(digits)} × {format_power_of_ten(int(power)).strip()}{TOGETHER}%"
    plain = f"{float(f'{digits}e{power}'):.{max(0, 1 - int(power))}f}"
    return localise_number(plain.rstrip("0").rstrip(".") if "." in plain else plain) + f"{TOGETHER}%"


def format_seconds(value: float | None) -> str:
    """Formats a time in s with two digits and a prefix, such as 2.5 ms; None and NaN as :data:`NOTHING`."""
    if value is None or not math.isfinite(value):
        return NOTHING
    return (f"{value:.0f} s" if value >= 99.5 else with_unit(value, "s", 2)).replace(" ", TOGETHER)


def runs_table(runs: Sequence[NumberedRun], marked: Sequence[NumberedRun], own: NumberedRun | None) -> str:
    """Returns an html table of the runs of a problem: those of the stage and of searches, the newest first; then of the
    others the ``marked``, the ``own``, and what other methods reach on its grid. Each has a button that loads it."""
    told = [run for run in reversed(runs) if run.source in (LIVE, SEARCH)][:MOST_LINES]
    beside = [] if own is None else [run for run in comparable_runs(runs, own.scene)
                                     if run.scene.cells == own.scene.cells]
    chosen = {run.mark: run for run in (*beside, *marked) if run.source in (SHIPPED, SWEEP)}
    lines = [*told, *sorted(chosen.values(), key=lambda run: run.seconds)]
    if not lines:
        return ""
    shipped = sum(run.source == SHIPPED and not run.corrected_by for run in runs)
    notes = [trn("{count} run, measured on the authors' machine on one thread. Ratios hold elsewhere, milliseconds do "
                 "not.", "{count} runs, measured on the authors' machine on one thread. Ratios hold elsewhere, "
                 "milliseconds do not.", shipped)] if shipped else []
    if shipped and any(run.source in HERE for run in runs):
        notes.append(tr("They are hollow, and not compared with those measured here."))
    if judges := dict.fromkeys(run.estimator for run in runs if run.error is None and run.estimate is not None):
        notes.append(tr("Small hollow marks: the error is estimated by {judges}.", judges=join_names(judges)))
    if len(runs) > len(lines):
        notes.append(tr("{n} more are on the chart and in the file.", n=len(runs) - len(lines)))
    heads = "".join(f"<th>{head}</th>" for head in (tr("method, cells"), tr("true"), tr("estimate"), tr("time")))
    rows = "".join(_run_row_html(run, run in marked, run is own) for run in lines)
    return f"<table class='lab-runs'><thead><tr>{heads}</tr></thead>{rows}</table><p>{' '.join(notes)}</p>"


def _run_row_html(run: NumberedRun, marked: bool, own: bool) -> str:
    if run.outcome in (*BROKEN, FAILED):
        errors = f"<td colspan=2 class='lab-bad'>{tr(ENDS[run.outcome])}</td>"
    else:
        errors = f"<td>{format_percent(run.error)}</td><td>{format_percent(run.estimate)}</td>"
    name = f"{functions_name(run.method)}, {run.scene.cells}"
    if run.corrected_by:
        name = tr("{run}, corrected by {estimator}", run=name, estimator=run.corrected_by)
    small = [run_details(run), *[tr("timed on the stage")] * (not run.timed_alone)]
    details = "" if run.source in (SHIPPED, SWEEP) else \
        f"<tr><td colspan=4 class='lab-details'>{escape('; '.join(small))}</td></tr>"
    return (f"<tbody title='{escape(run_sentence(run), quote=True)}'{' class=lab-marked' * marked}><tr>"
            f"<td><button data-run='{run.number}' aria-label='{tr('load run {number}', number=run.number)}'>"
            f"{escape(tr('{run} (yours)', run=name) if own else name)}</button></td>{errors}"
            f"<td>{format_seconds(run.seconds)}</td></tr>{details}</tbody>")


def other_runs_note(runs: Sequence[NumberedRun], problem: str) -> str:
    """Returns a note on how many of a visitor's runs are of another problem than the one on the stage; "" for none."""
    hidden = [run for run in runs if run.row["problem"] != problem and run.source != SHIPPED]
    if not hidden:
        return ""
    name = escape(tr(PROBLEMS[hidden[0].row["problem"]].scene.TITLE))
    return trn("And {count} run of the {problem}: shown when that problem is chosen; the CSV file has all.",
               "And {count} runs of the {problem}: shown when that problem is chosen; the CSV file has all.",
               len(hidden), problem=name)


def job_progress_text(status: CostJobStatus) -> str:
    """Returns how many runs a running job has done, as text."""
    if not status.total:
        return tr(STARTING[status.kind])
    said = ON_THE_WAY if status.done < status.total else DONE
    return tr(said[status.kind], done=status.done, total=status.total)


def job_status_text(status: CostJobStatus) -> str:
    """Returns the progress of a job or how it ended, as text; "" before the first job."""
    if status.running:
        if status.kind == SWEEP or status.task is None:
            return job_progress_text(status)
        run = scene_summary(status.task.scene())
        if status.done < status.total:
            return tr("Search, run {number} of at least {total}: {run}.", number=status.done + 1, total=status.total,
                      run=run)
        return tr("Search, run {number}: {run}.", number=status.done + 1, run=run)
    if status.cancelled:
        kept = [tr("The {n} runs that were done are kept.", n=status.done)] if status.done else []
        return " ".join([tr(CANCELLED[status.kind]), *kept])
    if status.trouble:
        return status.trouble if status.trouble.endswith(".") else tr(ENDED[status.kind], trouble=status.trouble)
    if status.advice:
        known = trn("{count} of them had been made by an earlier search on this server.",
                    "{count} of them had been made by earlier searches on this server.", status.known)
        advice = advice_text(status.advice, status.quantity)
        return f"{advice} {known}" if status.known else advice
    return tr("The sweep is done: {n} runs.", n=status.done) if status.kind == SWEEP else ""


def timing_note(paused: bool, playing: bool, others: bool) -> str:
    """Returns a warning if the own stage (``paused`` or ``playing``) or ``others`` distort measured times, else ""."""
    own = tr("Your stage is paused meanwhile, so that the times are accurate.") if paused else \
        tr("Your stage is running: times are too long. Press Pause for accurate ones.") if playing else ""
    theirs = tr("Other visitors use this server too: measured times may be longer.") if others else ""
    return f"{own} {theirs}".strip()


def advice_text(advice: dict, quantity: str) -> str:
    """Returns the recommendation of a search by a quantity's error as text, from the outcome that its process sends as
    ``advice``."""
    scene = Task(**advice["task"]).scene()
    error = tr("no usable error") if advice["error"] is None else tr(
        "an error of {size}, {share} of {whole}", size=with_unit(advice["error"], QUANTITIES[quantity].unit),
        share=format_percent(advice["error"] / scene.size_of(quantity)), whole=reference_size_name(scene, quantity))
    known = tr("by its own estimate") if advice["measured"] else tr("expected, not run")
    run = tr("{run}: {error} ({known}), {seconds} for the bare run", run=scene_summary(scene), error=error, known=known,
             seconds=format_seconds(advice["seconds"]))
    runner_up = tr("Runner-up: {why}.", why=reword_for_page(advice["why"])) if advice["why"] else ""
    taken = tr("Take {run}.", run=run) if advice["met"] else \
        tr("No run within the limits meets this. The closest is {run}.", run=run)
    return f"{taken} {runner_up} {tr('{n} runs were tried.', n=advice['looks'])}"
