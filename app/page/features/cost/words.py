"""Runs, jobs and advice in words: sentences and the table of the Cost tab."""

import html
import math
from collections.abc import Sequence

from app.page.features.cost.jobs import JobStatus
from app.page.features.cost.runs import MOST_RUNS, NumberedRun
from app.words import NOTHING, method_name, moving, number, on_page, per_cell
from solvers.problems import PROBLEMS
from solvers.scene.remedies import REMEDIES
from solvers.scene.scene import Scene
from solvers.solver.soundness import BROKEN
from solvers.study.grid import Task
from solvers.study.row import FAILED

LONGEST_BUDGET = 60.0
NOTHING_TO_FIND = ("There is nothing to find in a patch test: its error is round-off, or does not fall with the cells. "
                   "Compare methods and particles per cell instead.")


class NoNumber(ValueError):
    """What was typed cannot be used; the message says why."""


def typed(name: str, text: str, most: float = math.inf) -> float:
    """A positive number that a visitor typed."""
    try:
        value = float(text.strip())
    except ValueError:
        value = math.nan
    if not 0 < value <= most or math.isinf(value):
        allowed = f"above 0 and up to {most:g}" if math.isfinite(most) else "above 0, such as 1e-3"
        raise NoNumber(f"{name} {text.strip()[:20]!r}: give a number {allowed}.")
    return value


def setting(scene: Scene) -> str:
    """A scene in short."""
    preserving = "linearity-preserving " * scene.linearity_preserving
    called = " and ".join(REMEDIES[name].label for name in scene.remedies)
    remedies = f" with {called}" * bool(called)
    return (f"{preserving}{method_name(scene.method)}{remedies}, {scene.cells} cells, "
            f"{per_cell(scene.problem, scene.ppc)} particles per cell, CFL {scene.courant_number:.3g}")


def sentence(run: NumberedRun) -> str:
    """A run in a sentence."""
    scene = run.scene
    text = f"run {run.number}: {setting(scene)}, {moving(scene)}, E {scene.modulus:.3g} Pa; "
    if run.status in (*BROKEN, FAILED):
        return f"{text}{run.status}: {run.row['reason']}."
    return f"{text}error of x {relative(run.error)}, estimated {relative(run.estimate)} of A in {seconds(run.seconds)}."


def relative(value: float | None) -> str:
    return NOTHING if value is None else f"{value:.2e}".replace("e-0", "e-")


def seconds(value: float | None) -> str:
    if value is None or math.isnan(value):
        return NOTHING
    return f"{1e3 * value:.2g} ms" if value < 0.0995 else f"{value:.2g} s" if value < 99.5 else f"{value:.0f} s"


def table(runs: Sequence[NumberedRun]) -> str:
    """The runs as a table, the newest first; their numbers are buttons."""
    if not runs:
        return ""
    heads = "".join(f"<th>{head}</th>" for head in ("run", "method", "cells", "p/c", "CFL", "error", "estim.", "time"))
    return (f"<table class='lab-runs'><tr>{heads}</tr>{''.join(_line(run) for run in reversed(runs))}</table><p>Errors "
            f"of x over A, the RMS, largest over time. The newest {MOST_RUNS} runs are kept.</p>")


def _line(run: NumberedRun) -> str:
    scene, words = run.scene, html.escape(sentence(run), quote=True)
    method = method_name(scene.method) + "*" * scene.linearity_preserving
    cells = [method, scene.cells, scene.ppc, f"{scene.courant_number:.3g}"]
    if run.status in (*BROKEN, FAILED):
        end = f"<td colspan=2 class='lab-bad'>{run.status}</td><td>{seconds(run.seconds)}</td>"
    else:
        end = f"<td>{relative(run.error)}</td><td>{relative(run.estimate)}</td><td>{seconds(run.seconds)}</td>"
    return (f"<tr title='{words}'><td><button data-run='{run.number}' aria-label='load run {run.number}'>{run.number}"
            "</button></td>" + "".join(f"<td>{cell}</td>" for cell in cells) + f"{end}</tr>")


def empty(problem: str, sweep: int) -> str:
    """Why there is no picture yet."""
    return (f"No run of the {PROBLEMS[problem].scene.TITLE} yet. A run becomes a dot when it has gone through its one "
            f"period on the stage. A small sweep makes {sweep} dots at once.")


def others(runs: Sequence[NumberedRun], problem: str) -> str:
    """That there are runs of another problem than the one on the stage, if so."""
    hidden = [run for run in runs if run.row["problem"] != problem]
    if not hidden:
        return ""
    name = PROBLEMS[hidden[0].row["problem"]].scene.TITLE
    count = f"{len(hidden)} runs" if len(hidden) > 1 else "1 run"
    return f"And {count} of the {name}: shown when that problem is chosen; the CSV file has all."


def going(status: JobStatus) -> str:
    """How a job goes, or how it ended."""
    if status.running:
        if status.kind == "sweep":
            return f"Sweep: {status.done} of {status.total} runs." if status.done else "Sweep: starting."
        if status.task is None:
            return "Search: starting."
        coarse = f" of {status.total} on coarse grids" if status.done < status.total else ""
        return f"Search, run {status.done + 1}{coarse}: {setting(status.task.scene())}."
    if status.cancelled:
        kept = f" The {status.done} runs that were done are kept." if status.kind == "sweep" else ""
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
        f"error {number(advice['error'])} m, {number(advice['error'] / size)} of A"
    known = "by its own estimate" if advice["measured"] else "expected, not run"
    run = f"{setting(scene)}: {error} ({known}), {seconds(advice['seconds'])} for the bare run"
    runner_up = f"Runner-up: {on_page(advice['why'])}." if advice["why"] else ""
    start = "Take" if advice["met"] else "Nothing within reach meets that. The closest is"
    return f"{start} {run}. {runner_up} ({advice['looks']} runs were tried.)"
