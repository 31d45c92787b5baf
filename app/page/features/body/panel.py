"""A body from a file on the stage, in place of the run: opened from the menu of problems, or dropped as a file."""

import threading
from dataclasses import replace
from pathlib import Path
from time import monotonic
from typing import Any

import numpy as np

from app.frame.body_drawing import BodyDrawing
from app.frame.body_sentences import body_headline
from app.frame.body_stage import BodyStage
from app.frame.colour_scale import ColourScale
from app.frame.headline import HeadlineWithFacts
from app.frame.shown_body import BodySource, ShownBody
from app.language.translation import tr, translate_message
from app.names_and_units import reword_for_page
from app.page.feature import Feature, VisiblePageState
from app.page.features.body.body_readout import body_readout
from app.page.features.body.body_runs import BodyRuns
from app.page.features.body.body_sliders import BodySliders
from app.page.features.frame_player import FramePlayer
from app.page.page_context import PageContext
from app.page.panels.body_titles import library_title
from app.page.panels.time_axis import TimelineState
from app.page.readout_panel import ReadoutContent
from app.page.stage_source import StageFrame, ViewChoice
from app.page.visit.status_message import Notice
from app.problems.views import VIEWS
from solvers.bodies.body_file import LIBRARY, library_names
from solvers.engine.engine_messages import FrameReport
from solvers.untrusted.quoting import file_name

OF_BODIES = ("problem", "quantity", "speed")  # controls, by their names in lessons
WHOLE_RUN = 6.0  # seconds in which a run is played at the usual speed
TO_BE_READ = 30.0  # seconds that a refusal is shown


class BodyPanel(Feature):
    """A visitor's body: while one ``is_on`` the stage the run pauses; that ends when something advances the run."""

    def __init__(self, page: PageContext):
        self._page, self._session = page, page.session
        self.source, page.body = self, self
        self.messages = {"body": self._on_chosen}
        self._lock = threading.RLock()
        self._shown: ShownBody | None = None
        self._asked: BodySource | None = None  # the last run asked for, until it begins
        self._coming: ShownBody | None = None  # the last run that has begun, on the stage from its first sample on
        self._refusal: tuple[float, Notice] | None = None
        self._resumes, self._moves = False, tuple[Any, ...]()
        self._runs = BodyRuns(self._on_message)
        self._player = FramePlayer(page.session, self._frame_seconds, page.stage.draw)
        self._scale = ColourScale()
        self._scale.absolute = True
        self._stage = BodyStage(page.canvas.add_surface("/body"), page.canvas.add_surface("/body-colours"), self._scale)
        self._stage.set_visible(False)
        self._mark = page.gui.add_html("")
        with page.tabs["explore"]:
            self._sliders = BodySliders(page.gui, page.controls.of_body, self._change, self._player.go_to,
                                        self.leave)

    @property
    def is_on(self) -> bool:
        return self._shown is not None

    def open_file(self, name: str, file: Path) -> None:
        """Runs the body of an uploaded ``file``, which the visitor calls ``name``."""
        self._begin(BodySource(self._runs.take_file(file), file_name(name)))

    def leave(self) -> None:
        """Takes the body off the stage, or the one off that is being prepared."""
        with self._lock:
            self._runs.cancel()
            self._asked = self._coming = None
        self.leave_stage()

    def leave_stage(self) -> None:
        """Takes the body off the stage and returns to the run as it was."""
        with self._lock:
            if self._shown is None:
                return
            self._runs.close()
            self._shown = self._coming = self._asked = None
            self._player.play(False)
            self._mark.content = ""
            self._stage.set_visible(False)
            self._sliders.hide()
            if self._resumes:
                self._session.play(True)
        self._page.controls.show_for_own(None)
        self._page.stage.draw()

    def on_frame(self, report: FrameReport) -> None:
        """Shows the run again instead of a body, if the visitor has advanced the run."""
        if self._shown is not None and self._session.playback_request_key != self._moves:
            self._resumes = False
            self.leave_stage()

    def refresh(self, view: VisiblePageState) -> None:
        self._sliders.show_frame(self._player.frame)

    def close(self) -> None:
        with self._lock:
            self._player.play(False)
            self._runs.close()

    def _on_chosen(self, name: object) -> None:
        """Runs a body that comes along, whose name the browser has sent."""
        if isinstance(name, str) and name in library_names():
            self._begin(BodySource(LIBRARY / f"{name}.toml", library_title(name)))

    def _change(self, **changes: float) -> None:
        """Runs the body on the stage again with other values of its fields."""
        with self._lock:
            if source := self._asked or (self._shown.source if self._shown else None):
                self._begin(replace(source, changes=source.changes | changes))

    def _begin(self, source: BodySource) -> None:
        with self._lock:
            self._asked, self._refusal = source, None
            self._runs.begin(source)

    def _on_message(self, source: BodySource, table: Path, message: dict) -> None:
        """Handles a ``message`` of the process that runs bodies (``solvers.bodies.body_run_worker``)."""
        if "sample" in message and self._shown is None:
            self._page.show_run_on_stage()  # without the lock, as others have locks of their own
        with self._lock:
            if sentence := message.get("refused"):
                self._refuse(sentence)
            elif "begins" in message:
                self._coming = ShownBody(source, table, message["begins"])
            elif self._coming is None:
                return
            elif "sample" in message:
                self._coming.add(message["sample"])
                if self._coming is not self._shown:
                    self._show(self._coming)
                self._player.count = len(self._coming.times)
            else:
                self._coming.result = message["ends"]
                self._player.coming = False
                if self._coming is not self._shown:  # it has no sample
                    self._refuse(tr("the run of {body} has ended: {reason}", body=source.name,
                                    reason=translate_message(message["ends"]["reason"])))
        self._page.stage.draw()

    def _refuse(self, sentence: str) -> None:
        self._asked = None
        self._refusal = monotonic(), Notice("refused", reword_for_page(sentence).rstrip(".") + ".")
        if self._shown is not None:
            self._sliders.show(self._shown)

    def _show(self, body: ShownBody) -> None:
        """Puts a body on the stage and plays it."""
        if self._shown is None:
            self._resumes = self._session.playing
            self._session.play(False)
            self._moves = self._session.playback_request_key
            self._mark.content = "<i class='lab-file-shown'></i>"
            self._page.controls.show_for_own(self._player.play, OF_BODIES)
        self._shown, self._asked = body, None
        self._scale.reset()
        self._sliders.show(body)
        self._player.begin(len(body.times), coming=True)

    def _frame_seconds(self) -> float:
        """Returns the seconds until the next frame, at the page's speed."""
        usual = VIEWS[self._session.scene.problem].speed
        samples = self._shown.samples if self._shown else 1
        return WHOLE_RUN / samples * usual / self._session.speed

    @property
    def needs_immediate_headline(self) -> bool:
        return not self._player.playing

    def notice(self) -> Notice | None:
        """Returns why a body was refused, or that one is being prepared."""
        if self._asked is not None and (self._shown is None or self._shown.source.file != self._asked.file):
            return Notice("wait", tr("The body {name} is being read.", name=self._asked.name))
        if self._refusal is None or (age := monotonic() - self._refusal[0]) > TO_BE_READ \
                or self._session.idle_seconds < age:
            return None
        return self._refusal[1]

    def seek(self, time: float) -> None:
        if body := self._shown:
            self._player.go_to(int(np.argmin(np.abs(np.array(body.times) - time))))

    def stage_content(self, choice: ViewChoice) -> BodyDrawing | None:
        body, k = self._shown, self._player.frame
        return None if body is None else BodyDrawing(self._stage, self._scale, body, k, choice.quantity,
                                                     self._player.playing)

    def numbers(self, choice: ViewChoice, picture: StageFrame | None, probed: str | None) -> ReadoutContent | None:
        body, k = self._shown, self._player.frame
        if body is None:
            return None
        now = TimelineState(body.times[k], (0.0, body.times[-1]), self._player.playing)
        name = next(iter(body.goals), None)
        return ReadoutContent(body_readout(body, k), None, (), (), None, now, "",
                              goal=None if name is None else body.curve(name))

    def sentence(self, choice: ViewChoice, picture: StageFrame) -> HeadlineWithFacts:
        body = self._shown
        return HeadlineWithFacts() if body is None else body_headline(body)
