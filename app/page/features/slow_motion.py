"""Slow motion of one step: the panel that walks through its phases, and the thread that animates the picture."""

import logging
import threading
from dataclasses import replace
from html import escape
from typing import Any

import viser

from app.frame.headline import HeadlineWithFacts
from app.frame.layout import Rectangle
from app.frame.primitives import StageMetrics
from app.frame.slow_motion.stage import DIGITS, SlowMotionStage
from app.frame.slow_motion.step_phases import PHASES, format_scaled
from app.language.translation import lazy, tr, with_language
from app.page.feature import Feature, VisiblePageState
from app.page.page_context import PageContext
from app.page.panels.page_header import BARE, widget_marker_html
from app.page.stage_source import StageContent, StageFrame, ViewChoice
from app.page.visitor_run_source import VisitorRunSource
from app.problems.views import VIEWS
from solvers.engine.engine_messages import FrameReport
from solvers.scene.scene import Scene
from solvers.solver.particle_step_breakdown import ParticleStepBreakdown
from solvers.solver.soundness import UNSTABLE

NO_BREAK = "\N{NO-BREAK SPACE}"
TICK = 0.06  # seconds between two pictures
SECONDS = (1.0, 10.0, 3.0)  # of a phase: least, most, initial
MOVING = 0.7  # share of them with motion, before a rest for reading
LAST = len(PHASES) - 1
SLOW, NOT_SLOW = lazy("Slow motion"), lazy("Normal speed")
NO_STEP = lazy("An unstable run takes no more steps, so there is none to show in slow motion: press Reset, and switch "
               "it on before the run breaks.")


class SlowMotion(Feature):
    """Slow motion of one visitor: while ``on`` the run pauses, and soon a time step is on the stage, phase by phase."""

    def __init__(self, page: PageContext):
        self._client, self._canvas, self._session, self._on_view = (
            page.client, page.canvas, page.session, page.stage.draw)
        self.source = SlowMotionSource(self, page.run)
        self.shortcuts = {"phase": self.go_forward, "phase back": self.go_back}
        self._lock = threading.RLock()
        self._over = threading.Event()  # stops the thread that draws while the mode is on
        self._stages: dict[str, SlowMotionStage] = {}  # made when they are first needed
        self._step: tuple[Scene, ParticleStepBreakdown] | None = None
        self.on = self._walking = False
        self.sentence = HeadlineWithFacts()  # describes the stage while the mode is on
        self._phase, self._s, self._seconds, self._asked = 0, 0.0, SECONDS[2], 0
        self._first = 0  # phase that the next step on the stage begins with
        self._drawn: tuple[int, float, StageMetrics] | None = None  # phase, progress in it, and bounds
        page.show_phase = self.show_phase

        mark = page.gui.add_html("<i class='lab-at-slow'></i>")
        self._button = page.gui.add_button(tr(SLOW), hint=tr("pause, and walk through one time step phase by phase"))
        self._button.on_click(lambda _: self.leave_stage() if self.on else self.go_forward())
        page.controls.add_extension("slow-motion", lambda: self._build_fold(page.gui, bool(page.lesson_name)), mark,
                                    self._button)

    @property
    def is_showing(self) -> bool:
        """Whether a step is on the stage."""
        return self._step is not None

    @property
    def stage_rectangle(self) -> Rectangle | None:
        """The rectangle of the stage that the time step shown covers, or None."""
        step = self._step  # without the lock: the drawing thread reads it, and holders of the lock wait for that thread
        return None if step is None else self._stages[step[0].problem].rectangle

    def _build_fold(self, gui: viser.GuiApi, in_lesson: bool) -> None:
        """Builds the widgets among the controls, for the session's present scene; a lesson shows them before they are
        needed."""
        self._in_lesson, shown = in_lesson, self.on or in_lesson
        mark = gui.add_html(widget_marker_html("lab-slow-fold", words=tr("phase by phase")), visible=shown)
        fold = gui.add_folder(tr("One step in slow motion"), expand_by_default=False, visible=shown)
        self._fold: tuple[Any, ...] = mark, fold
        least, most, _ = SECONDS
        with self._lock, fold:
            self._box = gui.add_checkbox(tr("Slow motion"), self.on, hint=tr(
                "pause, take one time step and show its phases on the stage, around one particle; every number is the "
                "solver's own"))
            acts = {tr("Back"): self.go_back, tr("Forward"): self.go_forward,
                    tr("Walk"): lambda: self._set_walking(True), tr("Hold"): lambda: self._set_walking(False)}
            gui.add_html(BARE)
            buttons = gui.add_button_group(tr("Phase"), tuple(acts))
            seconds = gui.add_slider(tr("Seconds a phase"), least, most, 0.5, self._seconds,
                                     hint=tr("how long Walk shows each phase, before it goes on by itself"))
            particles = self._session.scene.particles
            self._particle = gui.add_number(tr("Particle"), particles // 3, min=0, max=particles - 1, step=1,
                                            hint=tr("the one in front of the others"))
            self._text = gui.add_html("")
        self._box.on_update(lambda event: self._switch(event.target.value) if event.client else None)
        buttons.on_click(lambda event: acts[event.target.value]())
        seconds.on_update(lambda event: setattr(self, "_seconds", event.target.value))
        self._particle.on_update(lambda event: self._change_particle() if event.client else None)

    def on_frame(self, report: FrameReport) -> None:
        """Shows the time step that a frame of the run contains; leaves slow motion if the run has gone on."""
        with self._lock:
            if not self.on or report.number < self._asked:
                return
            if report.breakdown is not None:
                problem = report.scene.problem
                if problem not in self._stages:
                    surface = self._canvas.add_surface(f"/slow-{problem}")
                    self._stages[problem] = VIEWS[problem].slow_motion_stage(surface)
                before, self._step, self._drawn = self._step, (report.scene, report.breakdown), None
                if before is None or (before[0], before[1].step) != (report.scene, report.step):
                    self._phase, self._s, self._first = self._first, 0.0, 0
                if before is None:
                    self._on_view()
            elif report.fresh and not report.playing:  # another scene, or a restart
                self._request_breakdown()
            else:
                self._leave()
                if report.status == UNSTABLE:
                    self._session.announce(tr(NO_STEP))

    def show_phase(self, particle: int, phase: int) -> None:
        """Takes the run's next time step apart around a particle, and shows it from its ``phase`` (from 1) on."""
        with self._lock:
            if self.on:
                self._leave()
            self._particle.value, self._first = particle, phase - 1  # type: ignore[misc]
            self._enter()

    def go_forward(self) -> None:
        """Shows the step's next phase, or the next time step; enters slow motion if it is off."""
        with self._lock:
            if not self.on:
                self._enter()
            elif self._phase < LAST:
                self._phase, self._s = self._phase + 1, 0.0
            elif self._step is not None:
                self._request_breakdown()

    def go_back(self) -> None:
        """Shows the phase before as it ended, and stops walking."""
        with self._lock:
            self._walking = False
            if self._phase > 0:
                self._phase, self._s = self._phase - 1, 1.0

    def leave_stage(self) -> None:
        self._switch(False)

    def refresh(self, view: VisiblePageState) -> None:
        self._button.label = tr(NOT_SLOW if self.on else SLOW)

    def close(self) -> None:
        """Ends the drawing thread when the visitor leaves."""
        self._over.set()

    def _switch(self, on: bool) -> None:
        with self._lock:
            if on and not self.on:
                self._enter()
            elif not on and self.on:
                self._leave()

    def _set_walking(self, walking: bool) -> None:
        with self._lock:
            self._walking = walking
            if walking and not self.on:
                self._enter()

    def _change_particle(self) -> None:
        """Takes the time step shown apart around another particle, the one entered."""
        with self._lock:
            if self.on:
                self._request_breakdown(step=self._step is None)

    def _show_fold(self) -> None:
        for part in self._fold:
            part.visible = self.on or self._in_lesson

    def _enter(self) -> None:
        self.on, self._box.value, self._over = True, True, threading.Event()  # type: ignore[misc]
        self._show_fold()
        self._request_breakdown()
        threading.Thread(target=with_language(self._draw_loop), args=(self._over,), name="slow-motion",
                         daemon=True).start()

    def _leave(self) -> None:
        self.on = self._walking = self._box.value = False  # type: ignore[misc]
        self._show_fold()
        self._over.set()
        self._text.content, self.sentence = "", HeadlineWithFacts()
        self._step = self._drawn = None
        for stage in self._stages.values():
            stage.sheet.visible = False
        self._session.break_down(None)
        self._on_view()

    def _request_breakdown(self, step: bool = True) -> None:
        """Requests the next time ``step`` by phases, or the last one again; the present one stays until then."""
        particle = max(0, min(int(self._particle.value), self._session.scene.particles - 1))
        self._asked = self._session.break_down(particle, step)

    def _draw_loop(self, over: threading.Event) -> None:
        while not over.wait(TICK):
            try:
                with self._lock:
                    if not over.is_set() and self._step is not None:
                        self._draw_next_tick(*self._step)
            except Exception:  # one bad picture must not end the mode
                logging.getLogger(__name__).exception("the step could not be drawn")

    def _draw_next_tick(self, scene: Scene, step: ParticleStepBreakdown) -> None:
        """Draws the time ``step`` in its present phase, and goes on by a tick of 0.06 s."""
        stage = self._stages[scene.problem]
        now = self._phase, self._s, stage.sheet.stage_metrics
        if now != self._drawn:
            if self._drawn is None or self._phase != self._drawn[0]:
                self._text.content = _phase_table_html(scene, step, self._phase)
                phase = PHASES[self._phase]  # for the text above the stage
                self.sentence = HeadlineWithFacts.from_template(tr("{n} of {all}: {title}.", n=self._phase + 1,
                                                                   all=len(PHASES), title=tr(phase.title)),
                                                                phase.words(scene))
            along = min(1.0, self._s / MOVING)
            with self._client.atomic():
                stage.draw(scene, step, self._phase, along * along * (3 - 2 * along))
                for problem, other in self._stages.items():
                    other.sheet.visible = problem == scene.problem
            self._canvas.lettering.send()
            self._client.flush()
            self._drawn = now
        if self._s < 1:
            self._s = min(1.0, self._s + TICK / self._seconds)
        elif self._walking and (report := self._session.report) is not None and self._asked <= report.number:
            self.go_forward()


class SlowMotionSource:
    """Source for the stage: the step in slow motion, with the numbers of the paused run, whose source is ``run``."""

    def __init__(self, slow: SlowMotion, run: VisitorRunSource):
        self._slow, self._run = slow, run
        self.numbers, self.notice = run.numbers, run.notice

    @property
    def is_on(self) -> bool:
        return self._slow.is_showing

    @property
    def needs_immediate_headline(self) -> bool:
        return bool(self._slow.sentence)

    def seek(self, time: float) -> None:
        """Does nothing: the run is at the step shown."""

    def stage_content(self, choice: ViewChoice) -> StageContent | None:
        sight = self._run.stage_content(choice)
        return sight and replace(sight, hidden=self._slow.stage_rectangle)

    def sentence(self, choice: ViewChoice, picture: StageFrame) -> HeadlineWithFacts:
        said = self._run.sentence(choice, picture)
        return said and (self._slow.sentence or said)


def _phase_table_html(scene: Scene, step: ParticleStepBreakdown, phase: int) -> str:
    """Returns the numbers of a step's phase (from 0) as html: equation, the particle's, and a table of the nodes'."""
    what = PHASES[phase]
    names = [tr("node at, m")]
    rows = [[", ".join(f"{x:.4g}".replace("-", "−") for x in place) for place in step.nodes]]
    for column in what.columns:
        texts, unit = format_scaled(column.scale * column.values(step), column.unit, DIGITS[step.nodes.shape[1]])
        name = tr(column.name)
        names.append(f"{name}, {unit.replace(' ', NO_BREAK)}" if unit else name)
        rows.append(texts)
    head = "".join(f"<th>{escape(name)}</th>" for name in names)
    body = "".join("<tr>" + "".join(f"<td>{escape(text)}</td>" for text in row) + "</tr>"
                   for row in zip(*rows, strict=True))
    front = "<br>".join(map(escape, what.front(scene, step)))
    kind = "lab-slow lab-plane" if step.nodes.shape[1] > 1 else "lab-slow"
    title = tr("Step {step}, phase {n} of {all}: {title}", step=step.step, n=phase + 1, all=len(PHASES),
               title=escape(tr(what.title)))
    return (f"<div class='{kind}'><b>{title}</b>"
            f"<p>{tr('Particle {particle}: {numbers}', particle=step.particle, numbers=front)}</p>"
            f"<table><tr>{head}</tr>{body}</table></div>")
