"""The panel for a particle file of one's own code: upload, its frames on the stage, and the way back."""

import contextlib
import threading
from html import escape
from pathlib import Path
from time import monotonic

import numpy as np
import viser

from app.frame.error_view_captions import NO_INDEX
from app.frame.headline import HeadlineWithFacts
from app.language.translation import lazy, tr, with_language
from app.names_and_units import reword_for_page
from app.page.controls import OF_FILES
from app.page.feature import Feature
from app.page.features.frame_player import FramePlayer
from app.page.features.upload import uploaded_run
from app.page.features.upload.judging_process import FIRST, FileProblemButtons, JudgeJob, question_sentence
from app.page.features.upload.uploaded_run import JUDGE, UploadedRun, file_readout, loaded_notice, page_scene_for_file
from app.page.page_context import PageContext
from app.page.panels.time_axis import TimelineState
from app.page.readout_panel import ReadoutContent
from app.page.stage.worst_region import WorstRegions
from app.page.stage_source import StageContent, StageFrame, ViewChoice
from app.page.visit.first_scene import first_scene
from app.page.visit.status_message import Notice
from app.viewer.upload import LARGEST, TOO_LARGE, VisitorUploads
from solvers.engine.engine_messages import FrameReport
from solvers.judging.particle_readers import PACKED, UPLOADED, kind_of
from solvers.judging.uploaded_file_worker import FileSummary
from solvers.study.parameter_grid import Task

TO_BE_READ = 30.0  # seconds that a refusal is shown; it stays beside the button
BODY_KIND = ".toml"  # ending of the file of a body
FRAME_SECONDS = (0.12, 0.6)  # least and most seconds that a frame is shown
BACK, BACK_HINT = lazy("Back to our run"), lazy("go back to what was on the stage before")
BUSY, ONE = lazy("A file is still on its way; wait until it is here."), lazy("Give one file at a time.")
WHAT = lazy("Drop a file of particles anywhere on this page, or choose it ({kinds}; at most {most:g} MB): from any "
            "code, for the problem and settings above, or from mpm-lab, with its scene. The page judges it and shows "
            "it on the stage. <code>mpm-lab problem</code> writes all that a code needs. A body of your own "
            "(<code>.toml</code>) is run here.")


class UploadPanel(Feature):
    """Upload panel of one visitor. While a file is :attr:`shown_frame`, in a colour scale common to all its times, the
    run pauses; that ends when something advances the run."""

    def __init__(self, page: PageContext):
        self._page, gui, self._controls = page, page.gui, page.controls
        self._session, self._on_view, self._on_begin = page.session, page.stage.draw, page.show_run_on_stage
        self.source = self
        self._lock = threading.RLock()
        self._judging: JudgeJob | None = None
        self._run: UploadedRun | None = None
        self._player, self._resumes = FramePlayer(page.session, self._frame_seconds, self._show_frame), False
        self._moves: tuple = ()  # of the run, which pauses meanwhile
        self._news: tuple[float, Notice] | None = None
        large, busy, one = (escape(tr(text), quote=True) for text in (TOO_LARGE, BUSY, ONE))
        gui.add_html(f"<i class='lab-upload' data-largest='{LARGEST}' data-too-large='{large}.' data-busy='{busy}' "
                     f"data-one='{one}'></i>")
        button = gui.add_upload_button(tr("file of particles"), mime_type=",".join((*UPLOADED, PACKED, BODY_KIND)))
        self._upload = VisitorUploads(gui, button, with_language(self._on_file),
                                      with_language(lambda text: self._refuse(tr(text))))
        self._mark = gui.add_html("")  # for the style, while a file is on the stage
        with page.tabs["explore"]:
            self._build_folds(gui, page.own_data)

    def _build_folds(self, gui: viser.GuiApi, own_data: viser.GuiFolderHandle) -> None:
        """Builds the widgets in their tab, those that begin with a file in the folder ``own_data``."""
        with own_data:
            what = tr(WHAT, kinds=", ".join((*UPLOADED, PACKED)), most=LARGEST / 1e6)
            gui.add_html(f"<div class='lab-own'>{what}</div>")
            gui.add_html("<i class='lab-choose'></i>")
            gui.add_button(tr("Choose a file"), icon=viser.Icon.UPLOAD,
                           hint=tr("of particles, as any code may write them"))
            self._text = gui.add_html("")
        self._question = FileProblemButtons(gui, self._on_problem_chosen)
        self._folder = gui.add_folder(tr("Your file on the stage"), order=FIRST, visible=False)
        with self._folder:
            gui.add_html("<i class='lab-frames'></i>")
            self._slider = gui.add_slider(tr("Frame"), 1, 2, 1, 1,
                                          hint=tr("the times in the file, one after the other"))
            gui.add_html("<i class='lab-back'></i>")
            back = gui.add_button(tr(BACK), icon=viser.Icon.ARROW_BACK_UP, hint=tr(BACK_HINT))
        self._slider.on_update(
            lambda event: self._player.go_to(round(event.target.value) - 1) if event.client else None)
        back.on_click(lambda _: self.leave())
        self._upload.open()

    @property
    def shown_frame(self) -> tuple[UploadedRun, int] | None:
        """The file on the stage and the index of its frame shown, from 0; None if no file is there."""
        run = self._run
        return None if run is None else (run, self._player.frame)

    def on_frame(self, report: FrameReport) -> None:
        """Shows the run again instead of a file, if the visitor has advanced the run."""
        with self._lock:
            if self._run is not None and self._session.playback_request_key != self._moves:
                self._resumes = False
                self.leave()

    def notice(self) -> Notice | None:
        """Returns a message about an upload, judgement or refusal, if there is one."""
        judging, news = self._judging, self._news
        if coming := self._upload.progress_text:
            return Notice("wait", f"{coming}.")
        if judging is not None and self._run is None and not self._question.is_open:
            return Notice("wait", tr("The file {file} is being read and judged.", file=judging.name))
        if news is None or (age := monotonic() - news[0]) > TO_BE_READ or self._session.idle_seconds < age:
            return None  # the visitor has done something since, which has its own message
        return news[1]

    def leave(self) -> None:
        """Takes the file off the stage and returns to the run as it was."""
        with self._lock:
            if self._run is None:
                return
            self._drop_run()
            self._folder.visible, self._mark.content = False, ""
            self._show_sentence("")
            if self._resumes:
                self._session.play(True)
        self._controls.show_for_own(None)
        self._on_view()

    def leave_stage(self) -> None:
        self.leave()

    def close(self) -> None:
        """Ends upload and judging when the visitor leaves."""
        self._upload.close()  # first, and without the lock, for which an arriving file may wait
        with self._lock:
            self._drop_run()
        self._upload.delete_files()

    def _drop_run(self) -> None:
        self._cancel_judging()
        self._run = None
        self._player.play(False)

    def _cancel_judging(self) -> None:
        """Cancels the judging; the table of a file on the stage stays while it is shown."""
        if self._judging is not None:
            self._judging.cancel()
            with contextlib.suppress(OSError):
                self._judging.table.unlink()
        self._judging = None

    def _on_file(self, name: str, file: Path) -> None:
        """Starts to judge a new ``file``, which the visitor calls ``name``, instead of one before; runs that of a
        body."""
        if kind_of(name) == BODY_KIND and self._page.body:
            self._news = None
            return self._page.body.open_file(name, file)
        with self._lock:
            self._cancel_judging()
            self._question.hide()
            self._news = None
            self._judging = JudgeJob(name, file, self._session.scene, self._on_message)
            self._show_sentence(tr("The file {file} is being read and judged …", file=self._judging.name))

    def _on_message(self, judging: JudgeJob, message: dict) -> None:
        """Handles a ``message`` of a judging process (``solvers.judging.uploaded_file_worker``)."""
        if "frames" in message and judging is self._judging:
            # A file of another problem switches the page to that problem.
            own = Task(**FileSummary(**message["frames"]).task).scene()
            if own.problem != self._session.scene.problem:
                self._controls.load(page_scene_for_file(own, first_scene(own.problem)))
        with self._lock:
            if judging is not self._judging:
                return
            if sentence := message.get("refused"):
                self._refuse(sentence)
                if self._run is not None and self._run.table == judging.table:
                    self._run.trouble = reword_for_page(sentence)
                else:
                    self._cancel_judging()
            elif asks := message.get("asks"):
                self._ask_problem(judging.name, asks["reason"], tuple(asks["problems"]))
            elif "frames" in message:
                self._show(UploadedRun(judging.name, FileSummary(**message["frames"]), judging.table))
            elif self._run is not None and "estimate" in message:
                self._run.add_estimate(message["estimate"])
            elif self._run is not None:
                self._run.verdict = message["verdict"]
        self._on_view()

    def _ask_problem(self, name: str, reason: str, problems: tuple[str, ...]) -> None:
        """Asks for the problem of a file that does not fit the one on the stage."""
        said = question_sentence(name, reason, problems)
        self._news = monotonic(), Notice("refused", tr("{question} Select it at the top of Explore.", question=said))
        self._question.ask(said, problems)
        self._show_sentence(said)

    def _on_problem_chosen(self, problem: str | None) -> None:
        """Judges the waiting file for the problem of this key; discards it for None."""
        with self._lock:
            waiting, self._news = self._judging, None
            self._question.hide()
            self._show_sentence("")
            self._cancel_judging()
            if waiting is None or problem is None:
                return
        self._controls.load(first_scene(problem))  # its controls show the settings of the judgement
        with self._lock:
            self._judging = JudgeJob(waiting.name, waiting.file, self._session.scene, self._on_message, chosen=True)

    def _show(self, run: UploadedRun) -> None:
        """Puts a file on the stage and plays it."""
        if self._run is None:
            self._on_begin()
            self._resumes = self._session.playing
            self._session.play(False)
            self._moves = self._session.playback_request_key
        self._run = run
        self._show_sentence(loaded_notice(run, self._session.scene))
        self._slider.max, self._slider.value = max(2, len(run)), 1  # type: ignore[misc]
        self._slider.disabled = len(run) < 2
        self._folder.visible, self._mark.content = True, "<i class='lab-file-shown'></i>"
        self._controls.show_for_own(self._player.play, OF_FILES)
        self._player.begin(len(run))

    def _refuse(self, sentence: str) -> None:
        sentence = reword_for_page(sentence).rstrip(".") + "."
        self._news = monotonic(), Notice("refused", sentence)
        self._show_sentence(sentence)

    def _show_sentence(self, sentence: str) -> None:
        self._text.content = f"<div class='lab-own' role='status'><p>{escape(sentence)}</p></div>" if sentence else ""

    def _show_frame(self) -> None:
        self._slider.value = self._player.frame + 1  # type: ignore[misc]
        self._on_view()

    def _frame_seconds(self) -> float:
        """Returns the seconds until a file's next frame: at the page's speed, within limits for the eye."""
        least, most = FRAME_SECONDS
        if (shown := self.shown_frame) is None:
            return most
        run, k = shown
        ahead = run.times[min(k + 1, len(run) - 1)] - run.times[k]
        return float(min(most, max(least, ahead / (self._session.speed * run.scene.period))))

    @property
    def is_on(self) -> bool:
        return self.shown_frame is not None

    @property
    def needs_immediate_headline(self) -> bool:
        return not self._player.playing

    def seek(self, time: float) -> None:
        if shown := self.shown_frame:
            self._player.go_to(int(np.argmin(np.abs(shown[0].times - time))))

    def stage_content(self, choice: ViewChoice) -> StageContent | None:
        if (shown := self.shown_frame) is None:
            return None
        run, k = shown
        report, arrays = run.frame(k, choice.quantity, self._player.playing)
        picture = StageFrame(report, arrays, run.view(arrays, choice.quantity, choice.difference), foreign=True)
        return StageContent(picture, run.largest_errors(choice.quantity), (run.name, choice.quantity))

    def numbers(self, choice: ViewChoice, picture: StageFrame | None, probed: str | None) -> ReadoutContent | None:
        if (shown := self.shown_frame) is None:
            return None
        (run, k), playing = shown, self._player.playing
        return ReadoutContent(file_readout(run, k, choice.quantity, probed), None if run.estimate is None else run,
                              (JUDGE,), (JUDGE,), JUDGE, TimelineState(run.times[k], 2 * (run.times[k],), playing),
                              "" if run.true is not None else tr(NO_INDEX))

    def sentence(self, choice: ViewChoice, picture: StageFrame) -> HeadlineWithFacts:
        shown = self.shown_frame
        if shown is None or not picture.foreign or picture.report.scene != shown[0].scene:
            return HeadlineWithFacts()
        worst = WorstRegions()  # of this frame: at another time a file may have other particles
        worst.find(picture.report, picture.arrays, picture.view, choice.quantity)
        return uploaded_run.file_headline(*shown, picture.view, worst, choice.quantity)
