"""A visitor's file as a run: frames for the stage, norms for plots, headline and readout."""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import fields, replace
from html import escape
from pathlib import Path

import numpy as np

from app.frame.error_view_captions import TRUE, UNKNOWN, FrameErrorView, error_view_of_sizes
from app.frame.headline import HeadlineWithFacts, InstantErrors, error_headline_templates, format_error_headline
from app.language.translation import lazy, tr, translate_message
from app.names_and_units import (
    NOTHING,
    QUANTITIES,
    difference_text,
    format_coordinates,
    format_number,
    format_ratio,
    with_unit,
)
from app.page.panels.readout_tables import DRAG, ReadoutTables, name_with_line_sample, row_html, table_html
from app.page.stage.worst_region import WorstRegions
from app.page.visit.history import RunSeries
from solvers.engine.engine_messages import FrameReport
from solvers.engine.shared_frames import FrameArrays, FrameOptions
from solvers.judging.particle_data_types import list_names
from solvers.judging.scene_metadata import NOT_OF_THE_PROBLEM
from solvers.judging.uploaded_file_worker import FileSummary, open_table, table_columns
from solvers.scene.scene import Scene
from solvers.scene.validation import SceneError
from solvers.solver.error_series import RunningEffectivityIndex
from solvers.solver.rounding import largest_rounding_error
from solvers.solver.samples import QUANTITIES as KEYS
from solvers.study.parameter_grid import Task

JUDGE = "companion"  # the estimator of a file's errors
COMING = lazy("the companion is being solved")
NO_ACCELERATION = lazy("a file is not judged by its acceleration")


class UploadedRun(RunSeries):
    """A particle file of T frames, in ``table`` on disk; later with its ``estimate``, norms (T,) by quantity, and its
    ``verdict``, the judge's report. ``shown`` summarises it, ``name`` is its owner's."""

    def __init__(self, name: str, shown: FileSummary, table: Path):
        self.scene = Task(**shown.task).scene()
        super().__init__(self.scene.period)
        self.table = table
        self.name, self.times, self.missing = name, np.array(shown.times), shown.missing
        self._crossed = np.array(shown.crossed)
        self._starts = np.cumsum([0, *shown.counts])
        self._columns = table_columns(self.scene.DIMENSIONS)
        self._rows = open_table(table, shown.counts, self.scene.DIMENSIONS)
        self.true = None if shown.norms is None else _norm_arrays(shown.norms)
        self.estimate: dict[str, np.ndarray] | None = None
        self._tops: dict[tuple[str, bool], tuple[np.ndarray, np.ndarray]] = {}
        self.verdict: dict | None = None
        self.trouble = ""  # the reason why there will be no verdict

    def __len__(self) -> int:
        return len(self.times)

    def add_estimate(self, norms: Mapping[str, Sequence[float | None]]) -> None:
        """Adds the norms over time of the companion's estimate, by quantity; the table has the estimate, too."""
        estimate, none = _norm_arrays(norms), np.full(len(self), np.nan)
        new = {"time": self.times}
        for q in KEYS:
            new[f"error_{q}"] = none if self.true is None else self.true.get(q, none)
            new[f"{JUDGE}/estimate_{q}"] = estimate.get(q, none)
            rounding = largest_rounding_error(self.scene, q, self.scene.steps)
            new[f"{JUDGE}/index_{q}"] = RunningEffectivityIndex().extend(
                new[f"{JUDGE}/estimate_{q}"], new[f"error_{q}"], rounding)
        self.append(new)
        self.estimate = estimate

    def particle_count(self, k: int) -> int:
        return int(self._starts[k + 1] - self._starts[k])

    def frame(self, k: int, quantity: str, playing: bool) -> tuple[FrameReport, FrameArrays]:
        """Returns frame ``k`` (from 0) as report and arrays, with the field of a quantity by its key."""
        rows = np.array(self._rows[self._starts[k]:self._starts[k + 1]])
        part = {name: rows[:, which] for name, which in self._columns.items()}
        P, q = len(rows), KEYS.index(quantity)
        arrays = FrameArrays(part["position"], part["displacement"], np.zeros((P, 0), np.float32),
                             part["crossed"][:, 0] - 1, part["error"], {JUDGE: part["estimate"]},
                             {JUDGE: part["difference"]}, part["field"][:, 2 * q:2 * q + 2])
        report = FrameReport(0, 0, "", self.scene, False, playing, P, k, float(self.times[k]), np.empty((0, 0)), None,
                             0.0, None, "", holds=FrameOptions(plotted=quantity))
        return report, arrays

    def view(self, arrays: FrameArrays, quantity: str, difference: bool) -> FrameErrorView:
        """Returns the errors that the two halves of the stage show, of a frame's ``arrays``, or why they do not."""
        column = KEYS.index(quantity)
        lacks = tr(NO_ACCELERATION) if quantity == "a" else \
            tr("the file has no {quantity}", quantity=QUANTITIES[quantity].noun) if quantity in self.missing else ""
        no_truth = lacks or (tr(UNKNOWN) if self.true is None else "")
        no_estimate = lacks or (tr(COMING) if self.estimate is None else "")
        true = None if no_truth else arrays.error[:, column]
        estimated = None if no_estimate else arrays.estimate[JUDGE][:, column]
        return error_view_of_sizes(quantity, JUDGE, estimated, true, no_estimate, no_truth, difference,
                                   arrays.difference[JUDGE][:, column])

    def largest_errors(self, quantity: str) -> tuple[np.ndarray, np.ndarray]:
        """Returns the largest estimated and true error over all times in SI, (1,) each, for a colour scale."""
        known = quantity, self.estimate is not None
        if known not in self._tops:
            columns = (self._columns[name].start + KEYS.index(quantity) for name in ("estimate", "error"))
            estimated, true = (np.fmax.reduce(self._rows[:, column], initial=0.0) for column in columns)
            self._tops[known] = np.array([estimated]), np.array([true])
        return self._tops[known]

    def crossings_per_second(self, series: dict[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        """Returns times (T - 1,) in s and crossings per s, at least: a particle may cross twice between times."""
        return self.times[1:], self._crossed[1:] / np.diff(self.times)


def _norm_arrays(norms: Mapping[str, Sequence[float | None]]) -> dict[str, np.ndarray]:
    """Returns norms by quantity as arrays (T,), NaN where they are None."""
    return {q: np.array([np.nan if value is None else value for value in values]) for q, values in norms.items()}


HINTS = {lazy("now"): lazy("root of the mean square over the particles, at the time that is shown"),
         lazy("largest"): lazy("of all times in the file after the start"),
         lazy("index"): lazy("estimated over true error, summed over the times; 1 is perfect")}


def file_headline(run: UploadedRun, k: int, view: FrameErrorView, worst: WorstRegions,
                  quantity: str) -> HeadlineWithFacts:
    """Returns the headline on frame ``k`` of a file for a quantity: both errors, and the worst region."""
    true, estimated = (_norm_at_frame(norms, k, quantity) for norms in (run.true, run.estimate))
    words = error_headline_templates(run.scene, quantity, JUDGE, view.left.silence if estimated is None else "",
                                     view.right.silence if true is None else "")
    wrong, says = (np.nan if norm is None else norm for norm in (true, estimated))
    said = format_error_headline(words, QUANTITIES[quantity].unit, InstantErrors(wrong, says),
                                 tr("at t = {time} s in {file} ", time=format_number(run.times[k]), file=run.name))
    region = worst.by_truth or worst.by_estimate
    return replace(said, facts=(*said.facts, tr("worst at {region}", region=region.name)) if region else said.facts)


def page_scene_for_file(own: Scene, page: Scene) -> Scene:
    """Returns a ``page``'s scene with what matters to the judge in the scene ``own`` of a file, if valid together."""
    with suppress(SceneError):  # may be invalid with the page's method
        return replace(page, **{f.name: getattr(own, f.name) for f in fields(page) if f.name not in NOT_OF_THE_PROBLEM})
    return page


def loaded_notice(run: UploadedRun, page: Scene) -> str:
    """Returns the message that a file is on the stage, with its settings if they differ from the ``page``'s scene."""
    said = difference_text(page_scene_for_file(run.scene, page), page) if run.scene.problem == page.problem else ""
    return tr("The file {file} is on the stage, judged with {settings}.", file=run.name, settings=said) if said else \
        tr("The file {file} is on the stage.", file=run.name)


def file_readout(run: UploadedRun, k: int, quantity: str, probed: str | None) -> ReadoutTables:
    """Returns tables on frame ``k`` of a file: a quantity's errors, verdict, run; ``probed`` is the region chosen."""
    verdict = run.verdict or {}
    rows = [(tr("file"), f"<b>{escape(run.name)}</b>"),
            (tr("frame"), tr("{n} of {all}", n=k + 1, all=len(run))),
            (tr("time"), tr("{time:.4g} s = {periods:.2f} periods", time=run.times[k],
                            periods=run.times[k] / run.scene.period)),
            (tr("grid"), tr("{cells} cells, h = {spacing}", cells=run.scene.cells,
                            spacing=with_unit(run.scene.spacing, "m"))),
            (tr("particles"), f"{run.particle_count(k):,}"),
            *([(tr("crossings"), tr("{n:,} at least", n=verdict["crossings_at_least"]))] if verdict else []),
            (tr("region"), escape(probed or tr(DRAG)))]
    run_of = table_html("".join(f"<tr><td>{name}</td>\n<td>{text}</td></tr>\n" for name, text in rows))
    found = "".join(f"<p>{escape(text)}</p>" for text in _verdict_lines(run, quantity))
    return ReadoutTables(f"{_errors_table_html(run, k, quantity)}<div class='lab-own'>{found}</div>", run_of)


def _errors_table_html(run: UploadedRun, k: int, quantity: str) -> str:
    """Returns a table of a quantity's true and estimated error in frame ``k``, and at their largest, as html."""
    words = QUANTITIES[quantity]
    heads = (f"<span title=\"{escape(tr(hint))}\">{tr(head)}</span>" for head, hint in HINTS.items())
    rows = [row_html("head", tr("error of {symbol}", symbol=words.symbol), *heads)]
    if quantity in run.missing or quantity == "a":
        return table_html("".join([*rows, row_html("", name_with_line_sample(TRUE), tr("not in the file"))]),
                          "lab-numbers lab-estimates")
    for name, norms in ((TRUE, run.true), (JUDGE, run.estimate)):
        last = run.series.get(f"{JUDGE}/index_{quantity}", np.zeros(0))[-1:]
        index = "" if name != JUDGE else format_ratio(float(last[0])) if np.isfinite(last).any() else NOTHING
        values = np.zeros(0) if norms is None or quantity not in norms else \
            norms[quantity][run.times > 0 if (run.times > 0).any() else ...]
        largest = float(values.max()) if len(values) and np.isfinite(values).all() else None
        sizes = (NOTHING if value is None else with_unit(value, words.unit, 2)
                 for value in (_norm_at_frame(norms, k, quantity), largest))
        rows.append(row_html("", name_with_line_sample(name), *sizes, index))
    return table_html("".join(rows), "lab-numbers lab-estimates")


def _verdict_lines(run: UploadedRun, quantity: str) -> list[str]:
    """Returns the judge's findings on a file, or why there are none yet, a sentence each."""
    if run.verdict is None:
        return [tr("There is no verdict: {reason}", reason=run.trouble) if run.trouble else
                tr("The judge is still at work.")]
    found, worst = [], run.verdict["worst"].get(quantity)
    if worst:
        size = with_unit(worst["size"], QUANTITIES[quantity].unit)
        found.append(tr("Worst of all: {size}, particle {particle} at {place}, t = {time} s.", size=size,
                        particle=worst["particle"], place=_format_position(worst["X"]), time=format_number(worst["t"])))
    if gap := run.verdict["neighbour_gap"]:
        found.append(tr("{count:,} particles ({share:.2g} %) are not where their neighbours are, by up to {apart:.2g} "
                        "h, at t = {time} s: the farthest is particle {particle} at {place}.", count=gap["count"],
                        share=100 * gap["share"], apart=gap["farthest_over_h"], time=format_number(gap["t"]),
                        particle=gap["particle"], place=_format_position(gap["X"])))
    unread = run.verdict["not_read"]
    notes = [*map(translate_message, run.verdict["notes"]),
             *([tr("columns that were not read: {names}", names=list_names(unread))] if unread else [])]
    return [*found, *(f"{note[:1].upper()}{note[1:]}." for note in notes)]


def _format_position(X: list[float]) -> str:
    place = format_coordinates(X)
    return f"X = ({place}) m" if len(X) > 1 else f"X = {place} m"


def _norm_at_frame(norms: dict[str, np.ndarray] | None, k: int, quantity: str) -> float | None:
    """Returns a norm at frame ``k``; None if unknown or not finite."""
    value = np.nan if norms is None or quantity not in norms else norms[quantity][k]
    return float(value) if np.isfinite(value) else None
