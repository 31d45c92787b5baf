"""The lesson player: one step at a time beside the stage, a prediction before what it is about runs."""

import threading
from collections.abc import Callable
from time import monotonic

import viser

from app import state
from app.lessons import progress as kept
from app.lessons import shelf
from app.lessons.lesson import EXPLAIN, PREDICT, TEXT, Lesson, Numbers, Step, drawn, filled
from app.lessons.marks import LONGEST, TOLD_AFTER, AnswerMark, shown, trouble
from app.page.features.lesson import acts, core
from app.page.features.lesson import html as page
from app.page.features.lesson.answer import AnswerWidgets
from app.page.features.lesson.hands import Hands
from app.page.features.lesson.marking import Classroom, Marker, asked_since
from app.page.panels.browser_store import BrowserStore
from app.page.panels.head import BESIDE
from app.viewer.widgets import allow, is_removed

FIRST = -1e9  # in the order of what stands in the tab: a step, and then the controls that it needs
BESIDE_MAIN = "<i class='lab-beside lab-main'></i>"
MAIN, LINK = "<i class='lab-main'></i>", "<i class='lab-link'></i>"  # the button that is meant, and one that is less
KEPT = "Your answers stay in this browser."
FIRST_PREDICT = f"You predict first: Next opens when your answer is recorded. {KEPT}"


class Player:
    """One visitor's, in a ``tab``, where the ``controls`` that a lesson needs stand below its text; ``on_change`` is
    called when what the browser should keep has changed. What it says through its ``store`` may be anything."""

    def __init__(self, client: viser.ClientHandle, tab: viser.GuiTabHandle, classroom: Classroom, controls: Hands,
                 store: BrowserStore, on_change: Callable[[], None]):
        self._client, self._gui, self._tab, self._room = client, client.gui, tab, classroom
        self._controls, self._on_change = controls, on_change
        self._lock = threading.RLock()
        self._marker = Marker(classroom.outcomes)
        self._lesson: Lesson | None = None
        self._progress = kept.Progress("", "")  # of the lesson that is open
        self._restored = False  # whether the browser has said what it keeps of this lesson
        self._shown_at = monotonic()
        self._answer: AnswerWidgets | None = None  # of the question that is shown
        self._acts: list[acts.Act] = []  # that the step's text has buttons for
        self._widgets = self._gui.add_folder(None, order=FIRST)
        self._below = self._gui.add_folder(None)  # the controls' own: only one thread may put into a place at a time
        self._build()
        store.heard |= {"open": lambda name: self.open(name) if isinstance(name, str) else None,
                        "choice": self._choose, "do": self._act}

    @property
    def name(self) -> str:
        """Of the lesson that is open, or ""."""
        return self._lesson.name if self._lesson else ""

    @property
    def answers(self) -> str:
        """What the browser should keep of it; "" until it has said what it keeps."""
        with self._lock:
            return self._progress.text() if self._lesson and self._restored else ""

    def close(self) -> None:
        """The visitor has gone."""
        self._marker.close()

    def open(self, name: str) -> None:
        """Begin a lesson; one that is not there changes nothing."""
        lesson = shelf.lessons().get(name)
        if lesson is None or lesson is self._lesson:
            return
        with self._lock:
            self._lesson, self._restored, self._progress = lesson, False, self._room.begun(lesson)
            self._marker.forget()
        self._controls.offer(lesson.controls, self._below)
        self._rebuild()
        self._on_change()

    def refresh(self) -> None:
        """Call now and then: what a question says of the stage follows it."""
        with self._lock:
            if self._answer is not None:
                self._answer.refresh()

    def restore(self, name: str, text: str) -> None:
        """The browser has said what it keeps of a lesson, perhaps nothing."""
        with self._lock:
            lesson = self._lesson
            if lesson is None or name != lesson.name or self._restored:
                return
            self._restored = True
            if not text:
                return
            try:
                found = kept.read(text, shelf.lessons().get)
            except kept.NotAnswers:
                return
            if found.fingerprint != lesson.fingerprint:
                return  # the lesson has been changed since: its questions may mean something else
            self._progress = found
            self._marker.forget()
        self._rebuild()

    def _leave(self) -> None:
        with self._lock:
            self._lesson = None
        self._controls.offer(())
        self._rebuild()
        self._on_change()

    def _go(self, by: int) -> None:
        with self._lock:
            if self._lesson is None:
                return
            self._progress.step = self._lesson.beside(self._progress.step, by, self._progress.core)
        self._on_change()  # first: a step that is seen is one to come back to
        self._rebuild()

    def _rebuild(self) -> None:
        with self._lock:
            self._widgets.remove()
            with self._tab:
                self._widgets = self._gui.add_folder(None, order=FIRST)
                self._build()

    def _build(self) -> None:
        self._shown_at, self._answer, self._acts = monotonic(), None, []
        with self._widgets:
            if self._lesson is None:
                self._gui.add_html(page.shelf_html(shelf.lessons()))
            else:
                head = self._gui.add_html(page.head_html(self._lesson, self._progress))
                at, steps = self._progress.step, self._lesson.steps
                if at == 0:
                    self._build_intro(self._lesson, head)
                elif at <= len(steps):
                    self._build_step(self._lesson, steps[at - 1])
                else:
                    self._build_end(self._lesson)

    def _build_intro(self, lesson: Lesson, head: viser.GuiHtmlHandle) -> None:
        self._gui.add_html(page.intro_html(lesson, self._numbers, self._room.teacher))
        hint = "for your own numbers in this lesson, and on the file that you hand in; it is sent to nobody"
        name = self._gui.add_text("Your name", self._progress.name, hint=hint)
        name.on_update(lambda _: self._call(name.value))
        if lesson.deeper:
            core.add_choice(self._gui, lesson, self._progress.core, lambda only: self._choose_core(lesson, only, head))
        self._buttons(back=False, onward=True)

    def _choose_core(self, lesson: Lesson, only: bool, head: viser.GuiHtmlHandle) -> None:
        with self._lock:
            self._progress.core = only
        self._on_change()
        self._show(head, lambda: page.head_html(lesson, self._progress))

    def _turn(self, only: bool, step: int) -> None:
        """Take the core alone from now on, or all again, and go on with the step of this number."""
        with self._lock:
            self._progress.core, self._progress.step = only, step
        self._on_change()
        self._rebuild()

    def _call(self, name: str) -> None:
        with self._lock:
            if not self._progress.answers:
                self._progress.name = name.strip()[:kept.LONGEST_NAME]
                self._marker.forget()
        self._on_change()

    def _build_step(self, lesson: Lesson, step: Step) -> None:
        text = self._gui.add_html(self._explained(lesson, step))
        if step.kind != PREDICT:  # when it is run, so that marks are there when it is explained
            self._mark_all(lesson, step, text)
        self._acts = acts.found(page.text_html(step.text, self._numbers))
        if step.question is None:
            self._buttons(back=True, onward=True)
            return
        self._ask(lesson, step)

    def _ask(self, lesson: Lesson, step: Step) -> None:
        answered = self._progress.answers.get(step.key)
        fixed = step.kind == PREDICT and answered is not None  # what one has predicted stays
        widgets = AnswerWidgets(self._gui, step, self._numbers, answered.last if answered else None, fixed,
                                lambda: self._controls.state.scene)
        self._answer = None if fixed else widgets
        for text in widgets.texts:
            allow(text, LONGEST)
        said = self._gui.add_html("" if answered is None else self._taken(step, None))
        self._gui.add_html(MAIN)
        record = self._gui.add_button("Record my prediction" if step.kind == PREDICT else "Check my answer",
                                      disabled=fixed)
        onward = self._buttons(back=True, onward=answered is not None, main=answered is not None)

        def take(_: viser.GuiEvent) -> None:
            answer = widgets.value
            if why := trouble(step.asked, answer):
                trouble_said = f"<div class='lab-lesson lab-recorded' role='alert'>Please {why}.</div>"
                return self._show(said, lambda: trouble_said)
            with self._lock:
                self._progress.answer(step.key, answer, monotonic() - self._shown_at)
                self._shown_at = monotonic()
            self._on_change()
            if step.kind == PREDICT:
                self._rebuild()
            else:
                self._check(lesson, step, said, onward)

        record.on_click(take)

    def _choose(self, option: object) -> None:
        """The visitor has chosen one of the answers: that of a question, and its number."""
        with self._lock:
            if self._answer is not None and isinstance(option, list) and len(option) == 2 \
                    and self._step is not None and option[0] == self._step.key:
                self._answer.choose(option[1])

    def _act(self, said: object) -> None:
        """The visitor has pressed what a step's text tells him to do: a step's number, and that of the act."""
        with self._lock:
            act, step = acts.pressed(said, self._progress.step, self._acts), self._step
            stage = filled(step.stage, self._numbers) if step and act == acts.STAGE else ""
        if stage:
            self._controls.show(state.read(stage))
        elif isinstance(act, acts.Act):
            acts.do(act, self._controls)

    @property
    def _step(self) -> Step | None:
        """That is shown."""
        at = self._progress.step
        return self._lesson.steps[at - 1] if self._lesson and 0 < at <= len(self._lesson.steps) else None

    def _taken(self, step: Step, found: AnswerMark | str | None) -> str:
        """What is said of the answer that the step has."""
        answer = self._progress.answers[step.key]
        said = filled(shown(step.asked, answer.last), self._numbers)
        if step.kind == PREDICT:
            return page.recorded_html(said, "It is recorded; now see what happens.", None)
        if found is None or isinstance(found, str):
            return page.recorded_html(said, found or "", None)
        if found.right is not False:
            return page.recorded_html(said, "", found.right)
        told = answer.attempts >= TOLD_AFTER
        return page.recorded_html(said, f"It is {found.expected}." if told else "Look again, and try once more.", False)

    def _check(self, lesson: Lesson, step: Step, said: viser.GuiHtmlHandle, onward: viser.GuiButtonHandle) -> None:
        """Mark the answer, which may need a run, and say so; the way on is free, and may have been taken already."""
        with self._lock:
            if is_removed(said):
                return
            onward.disabled = False
            said.content = self._taken(step, "" if step.asked.kind == TEXT else "Being checked against the run …")
        self._marker.check(lesson, step, self._progress, lambda found: self._show(
            said, lambda: self._taken(step, found)))

    def _explained(self, lesson: Lesson, step: Step) -> str:
        """The step's text; where it explains, below what was said and what came out."""
        before = page.compared_html(asked_since(lesson, step), self._progress.answers, self._marker.marks,
                                    self._numbers) if step.kind == EXPLAIN else ""
        return page.step_html(step, self._progress.step, self._numbers, before, self._room.teacher)

    def _mark_all(self, lesson: Lesson, step: Step | None, text: viser.GuiHtmlHandle) -> None:
        """Mark what a step looks back on, or everything at the end, and show it there."""
        steps = asked_since(lesson, step) if step else list(lesson.questions.values())
        self._marker.mark_first(lesson, steps, self._progress, lambda: self._show(
            text, lambda: self._explained(lesson, step) if step else self._end(lesson)))

    def _show(self, text: viser.GuiHtmlHandle, content: Callable[[], str]) -> None:
        """Put what has been worked out into a text, unless the visitor has gone on meanwhile."""
        with self._lock:
            if not is_removed(text) and text.content != (new := content()):  # the browser would make it anew
                text.content = new

    def _build_end(self, lesson: Lesson) -> None:
        text = self._gui.add_html(self._end(lesson))
        self._mark_all(lesson, None, text)
        following = shelf.after(lesson)
        if following:
            self._gui.add_html(MAIN)
            onward = self._gui.add_button(f"Next lesson: {following.title}")
            onward.on_click(lambda _: self.open(following.name))
        if self._progress.core:
            self._gui.add_button(core.GO_DEEPER).on_click(lambda _: self._turn(False, core.deeper_from(lesson)))
        hand_in = self._gui.add_button("Hand in", icon=viser.Icon.DOWNLOAD, hint="save your answers as a file")
        hand_in.on_click(lambda _: self._hand_in())
        self._buttons(back=True, onward=False)

    def _end(self, lesson: Lesson) -> str:
        given, asked = self._progress.answers, [step for step in lesson.walk(self._progress.core) if step.question]
        table = page.compared_html(list(lesson.questions.values()), given, self._marker.marks, self._numbers)
        missing = sum(step.key not in given for step in asked)
        return page.end_html(table, missing, core.left(lesson) if self._progress.core else "")

    def _hand_in(self) -> None:
        with self._lock:
            self._client.send_file_download(self._progress.file_name, self._progress.text().encode(),
                                            save_immediately=True)

    def _buttons(self, back: bool, onward: bool, main: bool = True) -> viser.GuiButtonHandle:
        """Back, next and leave; returns the one for next, which is the ``main`` one where no answer is asked for."""
        self._gui.add_html(BESIDE)
        self._gui.add_button("Back", icon=viser.Icon.ARROW_LEFT, disabled=not back).on_click(lambda _: self._go(-1))
        self._gui.add_html(BESIDE_MAIN if main else BESIDE)
        following = self._gui.add_button("Next", icon=viser.Icon.CHEVRON_RIGHT, disabled=not onward)
        following.on_click(lambda _: self._go(1))
        first = self._step is not None and self._step.kind == PREDICT and not onward
        self._gui.add_html(f"<p class='lab-lesson lab-kept-here'>{FIRST_PREDICT if first else KEPT}</p>")
        if self._lesson and self._step and not self._step.core:
            self._gui.add_html(LINK)
            after = self._lesson.beside(self._progress.step, 1, core=True)
            self._gui.add_button(core.SKIP).on_click(lambda _: self._turn(True, after))
        self._gui.add_html(LINK)
        leave = self._gui.add_button("Close the lesson")
        leave.on_click(lambda _: self._leave())
        return following

    @property
    def _numbers(self) -> Numbers:
        """The visitor's own."""
        return drawn(self._lesson, self._progress.name) if self._lesson else {}
