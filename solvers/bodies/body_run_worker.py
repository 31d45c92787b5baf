"""Runs of bodies for the page, in a process of its own: the page itself opens no file and runs no kernel.

The process sends, in this order::

    {"begins": {...}}     the body's run has begun: a :class:`BodyRunSummary`
    {"sample": {...}}     so often: a :class:`BodySample`, whose particles are in the table
    {"ends": {...}}       the result, as ``mpm-lab run FILE.toml --json`` gives it
    {"refused": sentence} there is no such run, and nothing more follows

The table is a memory-mapped file. A run whose table has been deleted ends: nobody wants it any more.
"""

from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from solvers.bodies.body import SAMPLES, Body
from solvers.bodies.body_file import read_body
from solvers.bodies.goal_values import GoalValue
from solvers.scene.validation import SceneError
from solvers.translatable_message import Message
from solvers.untrusted.quoting import FileError

FIELDS = 5  # of a particle in the table: x and y in m, and the sizes of the estimated errors of x, v and sigma
PARTS = (8, 4, 2)  # of the file's cells per metre, of which the finest that is allowed is the step of others


@dataclass(frozen=True)
class BodyRunRequest:
    """Request to run the body of a ``file`` (path) that its owner calls ``name``, with other values of its fields
    (``changes``): the path of an empty file for the ``table``, and the largest number of particles."""

    file: str
    name: str
    changes: dict
    table: str
    most: int


@dataclass(frozen=True)
class BodyRunSummary:
    """Summary of a run: the ``body`` as in JSON; its numbers of particles and of samples after the start; the ``width``
    in m of the largest particle at rest, as of a square; a number of cells per metre of which all multiples are
    allowed; sentences on what is doubtful from the start."""

    body: dict
    particles: int
    samples: int
    width: float
    cells_step: float
    warnings: list[str]


class BodySample(NamedTuple):
    """Sample of a run at a ``time`` in s: by name, each goal's ``values`` so far (value and bar in its unit, None where
    there is none), and at this time what it is about, with a bar (``now``); why there is no estimate from here or
    earlier on (``ended``), "" while there is one."""

    time: float
    values: dict[str, GoalValue]
    now: dict[str, tuple[float, float | None]]
    ended: str


def run_in_worker(question: dict, tell: Callable[[dict], None]) -> None:
    """Answers a :class:`BodyRunRequest` dict: writes its table, passes all else to ``tell``."""
    asked = BodyRunRequest(**question)
    if not Path(asked.table).exists():
        return
    try:
        body = read_body(asked.file)
        step = _cells_step(body)
        body = replace(body, **asked.changes)
        if body.particles > asked.most:
            raise FileError(asked.name, "has {count:,} particles, too many to watch; give at most {most:,}, or run it "
                            "with `mpm-lab run`", body.particles, asked.most)
        _run(body, step, asked, tell)
    except FileError as error:
        tell({"refused": Message("The file {name} {sentence}", asked.name, error.sentence)})
    except SceneError as error:
        tell({"refused": Message("The body {name} has no run: {error}", asked.name, error)})


def _run(body: Body, step: float, asked: BodyRunRequest, tell: Callable[[dict], None]) -> None:
    from solvers.bodies.run import BodyRun  # with Taichi, which the page's process never imports

    run = BodyRun(body)
    table = np.memmap(asked.table, np.float32, "r+", shape=(SAMPLES + 1, len(run.position), FIELDS))
    table[0, :, :2], table[0, :, 2:] = run.position, 0.0
    tell({"begins": asdict(BodyRunSummary(asdict(body), len(run.position), SAMPLES, run.largest_volume ** 0.5, step,
                                          body.warnings()))})
    while run.advance():
        if not Path(asked.table).exists():
            return
        k = len(run.times) - 1
        table[k, :, :2] = run.position + run.displacement
        table[k, :, 2:] = run.error_sizes
        now = {name: one.last_value_and_bar(run.has_bars) for name, one in run.goals.items()}
        tell({"sample": BodySample(run.times[-1], run.goal_values(), now, run.estimate.sentence)._asdict()})
    tell({"ends": run.result().to_dict()})


def _cells_step(body: Body) -> float:
    """Returns the smallest eighth, quarter or half of the cells per metre that a body may have, or else all of them:
    with any multiple held sides lie on lines of the grid, too, and whole particles tile the body."""
    for parts in PARTS:
        try:
            return replace(body, cells_per_metre=body.cells_per_metre / parts).cells_per_metre
        except SceneError:
            continue
    return body.cells_per_metre
