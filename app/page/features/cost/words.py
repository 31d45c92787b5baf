"""Runs, jobs and advice in words: sentences and the table of the Cost tab."""

import math
from collections.abc import Sequence
from html import escape

from app.page.features.cost.jobs import CostStatus
from app.page.features.cost.runs import MOST_RUNS, NumberedRun
from app.words import NOTHING, method_name, moving, on_page, particles_per_cell, per_cell, power_text, with_unit
from solvers.outside import numerals, quoting
from solvers.problems import PROBLEMS
from solvers.scene.remedies import REMEDIES
from solvers.scene.scene import Scene
from solvers.solver.soundness import BROKEN
from solvers.study.grid import Task
from solvers.study.row import FAILED

LONGEST_BUDGET = 60.0
TOGETHER = "\N{NO-BREAK SPACE}"  # between a number and its unit: they stand in sentences
LEAST_PLAIN, MOST_PLAIN = -5, 3  # powers of ten of a percentage that are written out
MOST_LINES = 40  # of the table: it is made anew with every run
NOTHING_TO_FIND = ("There is nothing to find in a patch test: its error is round-off, or does not fall with the cells. "
                   "Compare methods and particles per cell instead.")


class NoNumber(ValueError):
    """What was typed cannot be used; the message says why."""


def typed(name: str, text: str, most: float = math.inf) -> float:
    """A positive number that a visitor typed."""
    try:
        value = numerals.real(text.strip())
    except ValueError:
        value = math.nan
    if not 0 < value <= most:
        allowed = f"above 0 and up to {most:g}" if math.isfinite(most) else "above 0, such as 1e-3"
        raise NoNumber(f"{name} '{quoting.quoted(text.strip(), 20)}': give a number {allowed}.")
    return value


def setting(scene: Scene) -> str:
    """A scene in short."""
    preserving = "linearity-preserving " * scene.linearity_preserving
    called = " and ".join(REMEDIES[name].label for name in scene.remedies)
    remedies = f" with {called}" * bool(called)
    return (f"{preserving}{method_name(scene.method)}{remedies}, {scene.cells} cells, "
            f"{particles_per_cell(scene.problem, scene.ppc)}, CFL {scene.courant_number:.3g}")


def sentence(run: NumberedRun) -> str:
    """A run in short, one fact after the other."""
    scene = run.scene
    parts = [f"run {run.number}: {called(run)}", details(run), f"{moving(scene)}, E {with_unit(scene.modulus, 'Pa')}"]
    if run.status in (*BROKEN, FAILED):
        return "; ".join([*parts, f"{run.status}: {run.row['reason']}"])
    of = whole(scene)
    if run.error is not None:
        parts.append(f"true error of x {percent(run.error)} of {of}")
    if run.estimate is not None:
        parts.append(f"{percent(run.estimate)} of {of} as {run.estimator} estimates")
    return "; ".join([*parts, f"{seconds(run.seconds)} {'alone' if run.alone else 'on the stage'}"])


def called(run: NumberedRun) -> str:
    """Its method and cells."""
    return f"{method_name(run.method)} on {run.scene.cells} cells"


def details(run: NumberedRun) -> str:
    """What else was chosen, and how many steps that makes."""
    scene = run.scene
    remedies = "".join(f", {REMEDIES[name].label}" for name in scene.remedies)
    return (f"{per_cell(scene.problem, scene.ppc)} per cell, CFL {scene.courant_number:.3g}, {scene.steps:,} steps"
            f"{', linearity-preserving' * scene.linearity_preserving}{remedies}")


def whole(scene: Scene) -> str:
    """What an error is a part of."""
    moved = "amplitude" in scene.moved_by and scene.size_of("x") == scene.amplitude
    return "A" if moved else "the largest displacement"


def percent(value: float | None) -> str:
    """A part as a percentage of two digits: 12 %, 0.5 %, 3.1 × 10⁻⁶ %."""
    if value is None:
        return NOTHING
    digits, _, power = f"{100 * value:.1e}".partition("e")
    if not LEAST_PLAIN <= int(power) <= MOST_PLAIN:
        return f"{digits} × {power_text(int(power)).strip()}{TOGETHER}%"
    plain = f"{float(f'{digits}e{power}'):.{max(0, 1 - int(power))}f}"
    return (plain.rstrip("0").rstrip(".") if "." in plain else plain) + f"{TOGETHER}%"


def seconds(value: float | None) -> str:
    """A time of two digits, with the prefix that keeps it short."""
    if value is None or not math.isfinite(value):
        return NOTHING
    return (f"{value:.0f} s" if value >= 99.5 else with_unit(value, "s", 2)).replace(" ", TOGETHER)


def table(runs: Sequence[NumberedRun]) -> str:
    """The newest runs as a table, the newest first; their numbers are buttons."""
    if not runs:
        return ""
    more = f" {len(runs) - MOST_LINES} more are on the chart and in the file." * (len(runs) > MOST_LINES)
    lines = "".join(_line(run) for run in list(reversed(runs))[:MOST_LINES])
    heads = "<tr><th>run</th><th>method, cells</th><th>error</th><th>time</th></tr>"
    return (f"<table class='lab-runs'><thead>{heads}</thead>{lines}</table><p>Errors of x in % of "
            f"{whole(runs[-1].scene)}: the RMS, largest over time.{more} The newest {MOST_RUNS} runs are kept.</p>")


def _line(run: NumberedRun) -> str:
    small = [details(run)]
    if run.status in (*BROKEN, FAILED):
        error = f"<td class='lab-bad'>{run.status}</td>"
    else:
        error = f"<td>{f'est. {percent(run.estimate)}' if run.error is None else percent(run.error)}</td>"
        small += [f"{run.estimator}: {percent(run.estimate)}"] * (run.estimate is not None)
    small += ["timed on the stage"] * (not run.alone)
    return (f"<tbody title='{escape(sentence(run), quote=True)}'><tr><td rowspan=2><button data-run='{run.number}' "
            f"aria-label='load run {run.number}'>{run.number}</button></td><td>{escape(method_name(run.method))}, "
            f"{run.scene.cells}</td>{error}<td>{seconds(run.seconds)}</td></tr>"
            f"<tr><td colspan=3 class='lab-details'>{escape('; '.join(small))}</td></tr></tbody>")


def others(runs: Sequence[NumberedRun], problem: str) -> str:
    """That there are runs of another problem than the one on the stage, if so."""
    hidden = [run for run in runs if run.row["problem"] != problem]
    if not hidden:
        return ""
    name = PROBLEMS[hidden[0].row["problem"]].scene.TITLE
    count = f"{len(hidden)} runs" if len(hidden) > 1 else "1 run"
    return f"And {count} of the {name}: shown when that problem is chosen; the CSV file has all."


def counted(status: CostStatus) -> str:
    """How far a job has come that runs."""
    name = status.kind.capitalize()
    if not status.total:
        return f"{name}: starting."
    if status.done < status.total:
        return f"{name}: {status.done} of {status.total} runs{' on coarse grids' * (status.kind == 'search')}."
    return f"{name}: {status.done} runs."


def going(status: CostStatus) -> str:
    """How a job goes, or how it ended."""
    if status.running:
        if status.kind == "sweep" or status.task is None:
            return counted(status)
        coarse = f" of {status.total} on coarse grids" if status.done < status.total else ""
        return f"Search, run {status.done + 1}{coarse}: {setting(status.task.scene())}."
    if status.cancelled:
        kept = f" The {status.done} runs that were done are kept." if status.done else ""
        return f"The {status.kind} was cancelled.{kept}"
    if status.trouble:
        return status.trouble if status.trouble.endswith(".") else f"The {status.kind} ended: {status.trouble}."
    if status.advice:
        return found(status.advice)
    return f"The sweep is done: {status.done} runs." if status.kind == "sweep" else ""


def stage(paused: bool, playing: bool, others: bool) -> str:
    """What the stages do to the times while a job runs: the visitor's own and those of ``others``."""
    own = "Your stage is paused meanwhile, so that it does not disturb the times." if paused else \
        "Your stage runs beside it: times come out longer. Pause makes them true." if playing else ""
    theirs = "Other visitors use this server at the same time: times may come out longer." if others else ""
    return f"{own} {theirs}".strip()


def pause(kind: str) -> str:
    """On a stage that has been paused."""
    return f"The stage is paused while your {kind} takes times, and goes on by itself. Play lets it go on now."


def found(advice: dict) -> str:
    """The recommendation."""
    scene = Task(**advice["task"]).scene()
    size = scene.size_of("x")
    error = "no usable error" if advice["error"] is None else \
        f"an error of {with_unit(advice['error'], 'm')}, {percent(advice['error'] / size)} of {whole(scene)}"
    known = "by its own estimate" if advice["measured"] else "expected, not run"
    run = f"{setting(scene)}: {error} ({known}), {seconds(advice['seconds'])} for the bare run"
    runner_up = f"Runner-up: {on_page(advice['why'])}." if advice["why"] else ""
    start = "Take" if advice["met"] else "Nothing within reach meets that. The closest is"
    return f"{start} {run}. {runner_up} {advice['looks']} runs were tried."
