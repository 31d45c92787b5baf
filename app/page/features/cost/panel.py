"""The Cost tab: what accuracy costs in time, out of a visitor's own runs."""

import html
from collections.abc import Callable

import viser

from app.page.features.cost import words
from app.page.features.cost.jobs import Jobs, JobStatus, QuietStage, question, search, small_sweep, timings
from app.page.features.cost.picture import picture
from app.page.features.cost.runs import LIVE, LiveRows, Runs, csv_bytes
from app.page.visit.history import History
from app.page.visit.limits import too_many
from app.page.visit.notice import Notice
from app.page.visit.session import Session
from app.words import command_line
from solvers.engine.messages import FrameReport
from solvers.scene.scene import Scene
from solvers.study.grid import Task

FILE_NAME = "mpm-lab-runs.csv"
#: Put before the text field through which a click arrives: the style hides that field.
PICKED = "<i class='lab-picked'></i>"
# A drawing has no callbacks. One handler finds what was clicked and types its number into the hidden field, as a
# visitor would; the time makes every click another text.
_PICK = ("const d=event.target.closest('[data-run]');if(d&&(event.type=='click'||event.key=='Enter')){"
         "const i=document.querySelector('[data-lab~=lab-picked] + div input');"
         "Object.getOwnPropertyDescriptor(HTMLInputElement.prototype,'value').set.call(i,d.dataset.run+' '+Date.now());"
         "i.dispatchEvent(new Event('input',{bubbles:true}))}")


class CostTab:
    """Made inside its tab; ``load`` puts a scene on the stage. One thread calls :meth:`refresh`."""

    def __init__(self, client: viser.ClientHandle, session: Session, load: Callable[[Scene], None]):
        self._client, self._session, self._load = client, session, load
        self.runs = Runs()
        self.jobs = Jobs(self.runs)
        self._live, self._quiet = LiveRows(), QuietStage(session)
        self._shown: tuple | None = None
        self._asked: tuple | None = None  # what the last search was asked
        self._remark = ""
        self._remarked_on: tuple | None = None
        self._build(client.gui)

    def follow(self, report: FrameReport, history: History) -> None:
        """A frame has come: take its run's row when it is complete."""
        if row := self._live.follow(report, history):
            self.runs.add(row, LIVE)

    def refresh(self) -> None:
        status = self.jobs.status  # once: a job that begins meanwhile must not give way to a stage yet to be paused
        self._quiet.follow(status.running)
        self._drop_what_is_old()
        problem, stage = self._session.scene.problem, self._stage_word(status)
        shown = (self.runs.version, problem, status, self._remark, stage)
        if shown != self._shown:
            self._shown = shown
            self._show_runs(problem)
            self._show_status(status, stage)

    def notice(self) -> Notice | None:
        """Why the stage stands still, if that is for a job's sake."""
        return Notice("wait", words.pause(self.jobs.status.kind)) if self._quiet.paused else None

    def _stage_word(self, status: JobStatus) -> str:
        """What disturbs the job that runs, which gives way to every stage that moves."""
        if not status.running:
            return ""
        others = self.jobs.others or self._session.others_playing
        if others or self._session.playing:
            self.jobs.give_way()
        return words.stage(self._quiet.paused, self._session.playing, others)

    def _drop_what_is_old(self) -> None:
        """An advice and a remark hold for the input that they were given on; a search for another is of no use."""
        if self._remark and self._remarked_on != self._input():
            self._remark = ""
        if self._asked is None or self._asked == (asked := self._question()):
            return
        if self.jobs.status.running:
            self._asked = asked
            self.jobs.cancel()
            self._say("What it was to find has changed.")
        else:
            self._asked = None
            self.jobs.forget()

    def _input(self) -> tuple:
        return self._tolerance.value, self._budget.value, self._session.scene

    def _question(self) -> tuple:
        return self._tolerance.value, self._budget.value, question(self._session.scene)

    def _say(self, remark: str) -> None:
        self._remarked_on, self._remark = self._input(), remark

    def _build(self, gui: viser.GuiApi) -> None:
        gui.add_html(PICKED)
        picked = gui.add_text("Run to load", "")
        picked.on_update(lambda event: self._pick(event.target.value))
        self._picture = gui.add_html("")
        self._sweep = gui.add_button("Small sweep", icon=viser.Icon.CHART_DOTS, hint="the problem on the stage on four "
                                     "grids with each of its methods, timed in the background")
        self._sweep.on_click(lambda _: self._start_sweep(small_sweep(self._session.scene)))
        self._time = gui.add_button("Time my runs alone", icon=viser.Icon.CLOCK, visible=False, hint="hollow dots "
                                    "are timed on the stage, in small pieces and with every effect; this runs them "
                                    "bare and in one go, in the background")
        self._time.on_click(lambda _: self._start_sweep(timings(self.runs.all())))
        self._tolerance = gui.add_text("Tolerance / A", "1e-3", hint="largest RMS error of x that is allowed at any "
                                       "time of one period, as a part of the amplitude A")
        self._budget = gui.add_text("Longest run, s", "10", hint="longest bare run that may be recommended")
        self._search = gui.add_button("Find the cheapest run", icon=viser.Icon.TARGET_ARROW, hint="tries methods, "
                                      "cells, particles per cell and steps in the background, on estimates alone")
        self._search.on_click(lambda _: self._start_search())
        self._bar = gui.add_progress_bar(0.0, visible=False, animated=True)
        self._sentence = gui.add_html("")
        self._cancel = gui.add_button("Cancel", icon=viser.Icon.X, color="gray", visible=False, hint="end the sweep or "
                                      "search; what it has found so far stays")
        self._cancel.on_click(lambda _: self.jobs.cancel())
        self._take = gui.add_button("Load this scene", icon=viser.Icon.PLAYER_PLAY, visible=False, hint="put the "
                                    "run that was found on the stage")
        self._take.on_click(lambda _: self._load_advice())
        self._table = gui.add_html("")
        self._download = gui.add_button("Download CSV", icon=viser.Icon.DOWNLOAD, disabled=True, hint="all these runs, "
                                        "a row each, for a spreadsheet")
        self._download.on_click(lambda _: self._client.send_file_download(
            FILE_NAME, csv_bytes(self.runs.all()), save_immediately=True))

    def _show_runs(self, problem: str) -> None:
        runs = self.runs.all()
        of_problem = [run for run in runs if run.row["problem"] == problem]
        drawing = picture(of_problem) or f"<p>{words.empty(problem, len(small_sweep(self._session.scene)))}</p>"
        hidden = words.others(runs, problem)
        self._picture.content = _clickable(drawing + (f"<p>{hidden}</p>" if hidden else ""))
        self._table.content = _clickable(words.table(of_problem))
        self._download.disabled = not runs
        self._time.visible = bool(timings(runs))

    def _show_status(self, status: JobStatus, stage: str) -> None:
        self._sweep.disabled = self._time.disabled = self._search.disabled = status.running
        self._cancel.visible = self._bar.visible = status.running
        if status.running:
            share = status.done / status.total if status.total else 0.0
            self._bar.value = min(100.0, 100.0 * share)  # type: ignore[misc]
        self._take.visible = bool(status.advice) and not status.running
        texts = [f"<p>{html.escape(text)}</p>" for text in (words.going(status), stage, self._remark) if text]
        self._sentence.content = f"<div class='lab-cost' role='status'>{''.join(texts)}</div>" if texts else ""

    def _pick(self, text: str) -> None:
        number = text.partition(" ")[0]
        run = self.runs.find(int(number)) if number.isdecimal() else None
        if run:
            self._put(run.scene, f"Run {run.number}")

    def _start_sweep(self, tasks: list[Task]) -> None:
        self._remark, self._asked = "", None
        self.jobs.sweep(tasks)
        self._quiet.follow(self.jobs.status.running)  # at once: else the first times are disturbed

    def _start_search(self) -> None:
        if not self._session.scene.swings:
            self._say(words.NOTHING_TO_FIND)
            return
        try:
            job = search(self._session.scene, words.typed("Tolerance", self._tolerance.value),
                         words.typed("Longest run", self._budget.value, words.LONGEST_BUDGET))
        except words.NoNumber as refusal:
            self._say(str(refusal))
            return
        self._remark, self._asked = "", self._question()
        self.jobs.search(job)
        self._quiet.follow(self.jobs.status.running)  # at once: else the first times are disturbed

    def _load_advice(self) -> None:
        if advice := self.jobs.status.advice:
            self._put(Task(**advice["task"]).scene(), "The advice")

    def _put(self, scene: Scene, name: str) -> None:
        """Put a scene on the stage if a browser can show it."""
        if refusal := too_many(scene):
            self._say(f"{refusal}. Run it in a terminal: {command_line(scene)}")
            return
        self._load(scene)
        self._say(f"{name} is on the stage.")


def _clickable(content: str) -> str:
    return f"<div class='lab-cost' onclick=\"{_PICK}\" onkeydown=\"{_PICK}\">{content}</div>" if content else ""
