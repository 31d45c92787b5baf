"""The Cost tab: what accuracy costs in time, from shipped runs and a visitor's own."""

import math
from collections.abc import Callable
from html import escape
from threading import Lock
from time import monotonic

import viser

from app.language.translation import tr
from app.names_and_units import command_line, format_number
from app.page.feature import Feature, VisiblePageState
from app.page.features.cost import cost_texts, visitor_run_list
from app.page.features.cost.cost_answer import (
    CostAnswer,
    answer_box,
    answer_headline,
    find_answer,
    own_run,
    tolerance_line,
)
from app.page.features.cost.cost_chart import draw_runs
from app.page.features.cost.cost_texts import format_percent
from app.page.features.cost.jobs import CostJobs, CostJobStatus, StagePauser, search_job, sweep_tasks
from app.page.features.cost.log_axes import Axes, axes_for
from app.page.features.cost.shipped_runs import shipped_rows
from app.page.features.cost.visitor_run_list import (
    LIVE,
    SHIPPED,
    LiveRunRecorder,
    VisitorRunList,
    advice_key,
    comparable_runs,
    runs_in_chart,
)
from app.page.page_context import PageContext
from app.page.panels.page_header import BESIDE
from app.page.visit.engine_links import scene_size_refusal
from app.page.visit.run_session import RunSession
from app.page.visit.status_message import Notice
from solvers.engine.engine_messages import FrameReport
from solvers.scene.scene import Scene
from solvers.study.parameter_grid import Task
from solvers.untrusted import number_parsing

FILE_NAME = "mpm-lab-runs.csv"
TOLERANCE, BUDGET = "0.1 %", "10"  # initial values: of the tolerance, and seconds of the longest run
STREAM_SECONDS = 0.5  # between two updates of the chart while a job runs
#: Marks of the text fields that receive a click on a run and the line's tolerance (``js/cost.js``).
PICKED, WANTED = "<i class='lab-picked'></i>", "<i class='lab-wanted'></i>"


class CostTab(Feature):
    """The Cost tab of one visitor with its chart; ``load`` puts a scene on the stage. Thread-safe."""

    def __init__(self, client: viser.ClientHandle, session: RunSession, load: Callable[[Scene], None]):
        self._client, self._session, self._load = client, session, load
        self.runs = VisitorRunList()
        self.jobs = CostJobs(self.runs)
        self.messages = {"cost": self.open}
        self._live, self._quiet = LiveRunRecorder(), StagePauser(session)
        self._refreshing = Lock()
        self._chart_key: tuple | None = None  # the runs and the scene at the last refresh,
        self._chartable: tuple | None = None  # what the chart depends on of those,
        self._charted: tuple | None = None  # and the same when it was drawn
        self._written: tuple | None = None
        self._axes: dict[tuple[str, str], Axes] = {}  # by problem that has runs, and quantity
        self._inside: Axes | None = None  # those of the chart that is drawn
        self._next = 0.0  # time of the next chart while a job runs
        self._last_query: tuple | None = None  # input of the last search
        self._remark = ""
        self._remarked_on: tuple | None = None
        self._filled: set[str] | None = None  # problems whose shipped runs are in the list; None until the tab opens
        self._followed = TOLERANCE  # the tolerance as this class has set it, to the own run's error
        self._build(client.gui)

    @classmethod
    def build(cls, page: PageContext) -> "CostTab":
        with page.tabs["cost"]:
            return cls(page.client, page.session, page.controls.load)

    def close(self) -> None:
        self.jobs.close()

    def on_frame(self, report: FrameReport) -> None:
        """Adds the row of the run on the stage when a frame completes it."""
        if row := self._live.take_row(report, self._session.history):
            self.runs.add(row, LIVE)

    def open(self, _: object) -> None:
        """Handles the opening of the tab: shows runs from now on, shipped ones too, and prepares a process for a
        search."""
        self._filled = self._filled or set()
        self.refresh()
        scene = self._session.scene
        if scene.swings:
            self.jobs.prepare(search_job(scene, self.runs.quantity, cost_texts.parse_tolerance(TOLERANCE),
                                         float(BUDGET)), self._is_alone())

    def _is_alone(self) -> bool:
        """Whether nothing of other visitors, jobs or stages, runs on this server."""
        return not (self.jobs.others_busy or self._session.others_playing)

    def refresh(self, view: VisiblePageState | None = None) -> None:
        """Refreshes chart and texts if they have changed, and cancels a search whose goal has; nothing before the tab
        has been open."""
        with self._refreshing:
            if view is not None:
                self.runs.count_errors_of(view.choice.quantity)
            if self._filled is None:
                return
            status = self.jobs.status  # read once: a job may start before its stage is paused
            self._quiet.set_job_running(status.running)
            self._discard_outdated_search()
            scene, stage = self._session.scene, self._disturbance_note(status)
            if scene.problem not in self._filled:
                self._filled.add(scene.problem)
                for row in shipped_rows(scene.problem):
                    self.runs.add(row, SHIPPED)
            if self._chart_key != (self.runs.version, scene):  # rarely: for many runs it takes a millisecond
                self._chart_key = self.runs.version, scene
                self._chartable = (self.runs.version, advice_key(scene),
                                   visitor_run_list.run_of_scene(self.runs.all(), scene))
            charted = self._chartable
            if charted != self._charted and (not status.running or monotonic() >= self._next):
                self._charted, self._next = charted, monotonic() + STREAM_SECONDS
                self._follow_own_error(scene)
                self._show_runs(scene)
            told = (charted, self._tolerance.value, status, self._remark, stage, self._is_past_end)
            if told != self._written:
                self._written = told
                self._show_answer(scene, status, stage)
                self._show_status(status, stage)

    def _follow_own_error(self, scene: Scene) -> None:
        """Sets the tolerance to the error of the run on the stage, unless the visitor has set another."""
        own = own_run(comparable_runs(self.runs.all(), scene), scene)
        if own and self._tolerance.value == self._followed != (text := format_percent(own.error_or_estimate)):
            self._followed = text
            self._tolerance.value = text  # type: ignore[misc]

    def notice(self) -> Notice | None:
        """Returns the reason why the stage is paused, if that is for a job."""
        return Notice("wait", tr(cost_texts.PAUSED[self.jobs.status.kind])) if self._quiet.paused else None

    @property
    def _is_past_end(self) -> bool:
        """Whether the run on the stage has gone on beyond the end of its scene."""
        report = self._session.report
        return report is not None and report.step > report.scene.steps

    def _disturbance_note(self, status: CostJobStatus) -> str:
        """Returns a note on what disturbs a running job, "" without; lowers its priority if a stage runs."""
        if not status.running:
            return ""
        others = self.jobs.others_busy or self._session.others_playing > 0
        if others or self._session.playing:
            self.jobs.share_cpu()
        return cost_texts.timing_note(self._quiet.paused, self._session.playing, others)

    def _discard_outdated_search(self) -> None:
        """Removes a remark, and cancels a search, whose input has changed."""
        if self._remark and self._remarked_on != self._entered_values():
            self._remark = ""
        if self._last_query is None or self._last_query == (asked := self._search_question()):
            return
        if self.jobs.status.running:
            self._last_query = asked
            self.jobs.cancel()
            self._set_remark(tr("The goal of the search has changed."))
        else:
            self._last_query = None
            self.jobs.discard_status()

    def _entered_values(self) -> tuple:
        return self._tolerance.value, self._budget.value, self._session.scene

    def _search_question(self) -> tuple:
        return self._tolerance.value, self._budget.value, self.runs.quantity, advice_key(self._session.scene)

    def _set_remark(self, remark: str) -> None:
        self._remarked_on, self._remark = self._entered_values(), remark

    def _build(self, gui: viser.GuiApi) -> None:
        self._chart, self._line = gui.add_html(""), gui.add_html("")
        gui.add_html(PICKED)
        picked = gui.add_text(tr("Run to load"), "")
        picked.on_update(lambda event: self._load_picked_run(event.target.value))
        gui.add_html(f"<h2 class='lab-h2'>{tr('How accurate must it be?')}</h2>")
        self._box = gui.add_html("")
        gui.add_html(WANTED)
        self._tolerance = gui.add_text(tr("Tolerance"), TOLERANCE, hint=tr(
            "largest RMS error that is allowed until the end of the run, in % of the largest exact value"))
        self._tolerance.on_update(lambda event: None if event.client is None else self.refresh())
        self._budget = gui.add_text(tr("Longest run, s"), BUDGET, hint=tr("longest bare run that may be recommended"))
        gui.add_html("<i class='lab-primary'></i>")
        self._search = gui.add_button(tr("Find the cheapest run"), icon=viser.Icon.TARGET_ARROW, hint=tr(
            "tries methods, cells, particles per cell and steps in the background, on estimates alone"))
        self._search.on_click(lambda _: self._start_search())
        self._bar = gui.add_progress_bar(0.0, visible=False, animated=True)
        self._sentence = gui.add_html("")
        self._cancel = gui.add_button(tr("Cancel"), icon=viser.Icon.X, color="gray", visible=False,
                                      hint=tr("end the sweep or search; its results so far are kept"))
        self._cancel.on_click(lambda _: self.jobs.cancel())
        self._take = gui.add_button(tr("Load this scene"), icon=viser.Icon.PLAYER_PLAY, visible=False,
                                    hint=tr("put the run that was found on the stage"))
        self._take.on_click(lambda _: self._load_advised_scene())
        gui.add_html(f"<h2 class='lab-h2'>{tr('Runs in the chart')}</h2>")
        self._table = gui.add_html("")
        gui.add_html(BESIDE)
        self._sweep = gui.add_button(tr("Measure here"), icon=viser.Icon.CHART_DOTS, hint=tr(
            "measures the run on the stage, and the same on several grids with each method, on this machine, in the "
            "background"))
        self._sweep.on_click(lambda _: self._start_sweep())
        gui.add_html(BESIDE)
        self._download = gui.add_button(tr("Download CSV"), icon=viser.Icon.DOWNLOAD, disabled=True,
                                        hint=tr("all these runs, a row each, for a spreadsheet"))
        self._download.on_click(lambda _: self._client.send_file_download(
            FILE_NAME, visitor_run_list.csv_bytes(self.runs.all()), save_immediately=True))

    def _show_runs(self, scene: Scene) -> None:
        """Updates the chart of the runs of the scene's problem."""
        of_problem, quantity = runs_in_chart(self.runs.with_corrected(), scene), self.runs.quantity
        inside = axes_for(of_problem, self._find_answer(scene)[0].tolerance,
                          self._axes.get((scene.problem, quantity)))
        self._inside = inside
        if of_problem:  # an empty chart's axes are not kept
            self._axes[scene.problem, quantity] = inside
        drawing = draw_runs(of_problem, comparable_runs(of_problem, scene), scene, quantity, inside)
        self._chart.content = f"<template class='lab-cost-chart'>{drawing}</template>"
        self._download.disabled = not self.runs.all()

    def _show_answer(self, scene: Scene, status: CostJobStatus, stage: str) -> None:
        """Updates the headline above the chart, the tolerance's line, the answer and the table in the panel, and what a
        job does (``stage`` is added)."""
        runs, (answer, trouble) = runs_in_chart(self.runs.with_corrected(), scene), self._find_answer(scene)
        like = comparable_runs(runs, scene)
        if axes_for(like, answer.tolerance, self._inside) != self._inside:
            self._show_runs(scene)
        says, more = answer_headline(answer, runs, like, scene, trouble, status.running)
        if status.running:
            more = escape(f"{cost_texts.job_progress_text(status)} {stage}")
        elif status.advice:
            end = tr("The search has ended. A clearly cheaper run is unlikely, but "
                     "possible.") if status.advice["met"] else tr("The search has ended.")
            more = f"{more} {escape(end)}"
        elif self._is_past_end:
            gone = tr("The chart counts until t = {time} s, the end of the scene; the stage has gone on.",
                      time=format_number(scene.end_time))
            more = f"{more} {gone}"
        self._line.content = (f"<template class='lab-cost-says'><h2>{says}</h2><p>{more}</p></template>"
                              f"{tolerance_line(answer, self._inside)}")
        self._box.content = f"<div class='lab-cost'>{answer_box(answer)}</div>"
        marked = [run for run in (answer.cheaper, answer.more_accurate) if run]
        others = cost_texts.other_runs_note(self.runs.all(), scene.problem)
        self._table.content = f"<div class='lab-cost'>{cost_texts.runs_table(runs, marked, answer.own)}" \
            f"<p>{others}</p></div>"

    def _find_answer(self, scene: Scene) -> tuple[CostAnswer, str]:
        """Returns the answer for the tolerance typed, and "" or an error message about that."""
        tolerance, trouble = math.nan, ""
        try:
            tolerance = cost_texts.parse_tolerance(self._tolerance.value)
        except cost_texts.InvalidNumber as refusal:
            trouble = str(refusal)
        follows = self._tolerance.value == self._followed
        return find_answer(comparable_runs(self.runs.with_corrected(), scene), scene, tolerance, follows), trouble

    def _show_status(self, status: CostJobStatus, stage: str) -> None:
        self._sweep.disabled = self._search.disabled = status.running
        self._cancel.visible = self._bar.visible = status.running
        if status.running:
            share = status.done / status.total if status.total else 0.0
            self._bar.value = min(100.0, 100.0 * share)  # type: ignore[misc]
        self._take.visible = bool(status.advice) and not status.running
        found = " class='lab-found'" * (bool(status.advice) and not status.running)
        texts = [f"<p{look}>{escape(text)}</p>" for text, look in (
            (cost_texts.job_status_text(status), found), (stage, ""), (self._remark, "")) if text]
        self._sentence.content = f"<div class='lab-cost' role='status'>{''.join(texts)}</div>" if texts else ""

    def _load_picked_run(self, text: str) -> None:
        number = number_parsing.parse_count(text.partition(" ")[0])
        run = None if number is None else self.runs.find(number)
        if run:
            self._load_scene(run.scene, tr("Run {number} is on the stage.", number=run.number))

    def _start_sweep(self) -> None:
        self._remark, self._last_query = "", None
        self.jobs.start_sweep(sweep_tasks(self._session.scene))
        self._quiet.set_job_running(self.jobs.status.running)  # at once: else the first times are disturbed

    def _start_search(self) -> None:
        if not self._session.scene.swings:
            self._set_remark(tr(cost_texts.NOTHING_TO_FIND))
            return
        try:
            job = search_job(self._session.scene, self.runs.quantity,
                             cost_texts.parse_tolerance(self._tolerance.value),
                             cost_texts.parse_positive(tr("Longest run"), self._budget.value,
                                                       cost_texts.LONGEST_BUDGET))
        except cost_texts.InvalidNumber as refusal:
            self._set_remark(str(refusal))
            return
        self._remark, self._last_query = "", self._search_question()
        self.jobs.start_search(job, undisturbed=self._is_alone())
        self._quiet.set_job_running(self.jobs.status.running)  # at once: else the first times are disturbed

    def _load_advised_scene(self) -> None:
        if advice := self.jobs.status.advice:
            self._load_scene(Task(**advice["task"]).scene(), tr("The advice is on the stage."))

    def _load_scene(self, scene: Scene, remark: str) -> None:
        """Puts a scene on the stage and shows ``remark``, or why no browser can show the scene."""
        if refusal := scene_size_refusal(scene):
            self._set_remark(tr("{refusal}. Run it in a terminal: {command}", refusal=refusal,
                                command=command_line(scene)))
            return
        self._load(scene)
        self._set_remark(remark)
