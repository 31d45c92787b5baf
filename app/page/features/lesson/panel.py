"""The lesson player: one step at a time beside the stage, with a prediction before the run it is about."""

import threading
from collections.abc import Callable
from time import monotonic

import viser

from app.classroom.class_board_state import VisitorBoardSeat
from app.frame.headline import HeadlineWithFacts
from app.language.translation import tr, with_language
from app.lessons import catalogue
from app.lessons import student_progress as kept
from app.lessons.answer_marking import LONGEST, AnswerMark, why_invalid
from app.lessons.lesson import EXPLAIN, PREDICT, TEXT, Lesson, Numbers, Step, draw_numbers
from app.page.feature import Feature, VisiblePageState
from app.page.features.lesson import answer_marking_queue, instruction_buttons, progress_and_navigation, step_html
from app.page.features.lesson.answer_widgets import AnswerWidgets
from app.page.features.lesson.lesson_stage import LessonStage
from app.page.features.lesson.progress_and_navigation import KEPT, MAIN, PACED, StepNavigation
from app.page.page_context import PageContext
from app.page.visit.recent_frames import Frame
from app.viewer.widget_validation import is_removed, set_max_length

FIRST = -1e9  # order within the tab: a step, and then the controls that it needs


class LessonPlayer(Feature):
    """One visitor's lessons, in a tab, above the controls that a lesson needs."""

    def __init__(self, page: PageContext):
        page.lesson, self._client, self._gui, self._classroom = self, page.client, page.gui, page.classroom
        self._tab, self._on_change = page.tabs["lessons"], page.store_state
        self._controls: instruction_buttons.LessonControls = page.controls
        self._lock = threading.RLock()
        self._stage = LessonStage(page, self._rebuild)
        self.messages = {"open": self.open, "choice": self._choose_option, "do": self._stage.perform}
        self._marker = answer_marking_queue.AnswerMarkingQueue(page.classroom.outcomes)
        self._lesson: Lesson | None = None
        self._progress = kept.StudentProgress("", "")  # in the open lesson
        self._restored = False  # whether the browser has sent its stored answers
        self._answer: AnswerWidgets | None = None  # for the question that is shown
        self._navigation: StepNavigation | None = None  # from the step that is shown
        if self._classroom.seat:
            self._classroom.seat.watch_open_steps(with_language(self._on_lecturer_opens_step))
        with self._tab:
            self._widgets = self._gui.add_folder(None, order=FIRST)
            self._below = self._gui.add_folder(None)  # for the controls: only one thread may fill a container at a time
            self._build()

    @property
    def name(self) -> str:
        """The name of the open lesson, or ""."""
        return self._lesson.name if self._lesson else ""

    @property
    def stored_progress(self) -> str:
        """The progress as text, for the browser to store; "" until the browser has sent what it had stored."""
        with self._lock:
            return self._progress.text() if self._lesson and self._restored else ""

    def close(self) -> None:
        """Leaves the class and stops the marker when the visitor leaves."""
        if self._classroom.seat:
            self._classroom.seat.leave()
        self._marker.close()

    def open(self, name: object) -> None:
        """Opens the lesson of this name; an unknown name, or that of the open one, changes nothing."""
        lesson = catalogue.load_lessons().get(name) if isinstance(name, str) else None
        if lesson is None or lesson is self._lesson:
            return
        with self._lock:
            self._lesson, self._restored, self._progress = lesson, False, self._classroom.start_progress(lesson)
            self._marker.discard_marks()
        self._controls.show_only(lesson.controls, self._below)
        self._rebuild()
        self._on_change()

    def headline(self, frame: Frame | None) -> HeadlineWithFacts:
        """Returns the headline while the curtain before the stage is closed."""
        return self._stage.headline

    def refresh(self, view: VisiblePageState) -> None:
        """Updates the curtain before the stage, and the text on the stage's value in the question shown."""
        self._stage.refresh()
        with self._lock:
            if self._answer is not None:
                self._answer.refresh()

    def restore(self, name: str, text: str) -> None:
        """Restores the progress that the browser has stored as ``text`` for the lesson of this name."""
        with self._lock:
            lesson = self._lesson
            if lesson is None or name != lesson.name or self._restored or self._paced_seat:
                return
            self._restored = True
            if (found := kept.parse_lesson_progress(text, lesson)) is None:
                return
            self._progress = found
            self._marker.discard_marks()
        self._rebuild()

    def _leave(self) -> None:
        with self._lock:
            self._lesson = None
        self._controls.show_only(())
        self._rebuild()
        self._on_change()

    def _move_by(self, by: int) -> None:
        """Goes ``by`` steps forward, or back if negative, as far as the lecturer has opened them."""
        with self._lock:
            if self._lesson is None:
                return
            at = self._lesson.neighbour_step(self._progress.step, by, self._progress.core)
            self._progress.step = min(at, self._paced_seat.last_open_step) if self._paced_seat else at
        self._on_change()  # first, so that a visible step is stored
        self._rebuild()

    def _rebuild(self) -> None:
        with self._lock:
            self._widgets.remove()
            with self._tab:
                self._widgets = self._gui.add_folder(None, order=FIRST)
                self._build()

    def _build(self) -> None:
        self._shown_at, self._answer, self._navigation = monotonic(), None, None
        if self._paced_seat:
            self._paced_seat.report_step(self._progress.step)
        self._stage.show_step(self._lesson, self._progress.step, self._numbers)
        with self._widgets:
            if self._lesson is None:
                self._gui.add_html(step_html.lesson_list_html(catalogue.load_lessons()))
                return
            head = self._gui.add_html(step_html.head_html(self._lesson, self._progress))
            if (step := self._step) is not None:
                self._build_step(self._lesson, step)
            elif self._progress.step == 0:
                self._build_intro(self._lesson, head)
            else:
                self._build_end(self._lesson)

    def _build_intro(self, lesson: Lesson, head: viser.GuiHtmlHandle) -> None:
        self._gui.add_html(step_html.intro_html(lesson, self._numbers, self._classroom.teacher))
        if not self._paced_seat:  # in a class all have the same numbers, and the same steps
            hint = tr("for your own numbers in this lesson, and on the file that you hand in; it is sent to nobody")
            name = self._gui.add_text(tr("Your name"), self._progress.name, hint=hint)
            name.on_update(lambda _: self._set_student_name(name.value))
            if lesson.optional_steps:
                only = progress_and_navigation.core_checkbox(self._gui, lesson, self._progress.core)
                only.on_update(lambda _: self._choose_core(lesson, only.value, head))
        self._build_navigation(back=False, onward=True)

    def _choose_core(self, lesson: Lesson, core_only: bool, head: viser.GuiHtmlHandle) -> None:
        self._progress.core = core_only
        self._on_change()
        self._show(head, lambda: step_html.head_html(lesson, self._progress))

    def go_to_step(self, core_only: bool, step: int) -> None:
        """Goes to the step of this number (from 1), in a lesson restricted to its core if ``core_only``."""
        with self._lock:
            self._progress.core, self._progress.step = core_only, step
        self._on_change()
        self._rebuild()

    def _set_student_name(self, name: str) -> None:
        with self._lock:
            if not self._progress.answers:
                self._progress.name = name.strip()[:kept.LONGEST_NAME]
                self._marker.discard_marks()
        self._on_change()

    def _build_step(self, lesson: Lesson, step: Step) -> None:
        text = self._gui.add_html(self._text_html(lesson, step))
        if step.kind != PREDICT:  # early, so that marks are ready at the explanation
            self._mark_all(lesson, step, text)
        if (ahead := answer_marking_queue.upcoming_bets_step(lesson, step)) is not None:
            self._marker.compute_bets(lesson, ahead, self._progress,
                                      lambda: self._show(text, lambda: self._text_html(lesson, step)))
        if step.question is not None:
            return self._build_question(lesson, step)
        self._build_navigation(back=True, onward=True)

    def _build_question(self, lesson: Lesson, step: Step) -> None:
        answered = self._progress.answers.get(step.key)
        fixed = step.kind == PREDICT and answered is not None  # a prediction stays
        widgets = AnswerWidgets(self._gui, step, self._numbers, answered.last if answered else None, fixed,
                                lambda: self._controls.state.scene, step_html.lang_attribute(lesson))
        self._answer = None if fixed else widgets
        for text in widgets.texts:
            set_max_length(text, LONGEST)
        said = self._gui.add_html("" if answered is None else self._reply_html(step, None))
        self._gui.add_html(MAIN)
        does = tr("Record my prediction") if step.kind == PREDICT else tr("Check my answer")
        record = self._gui.add_button(does, disabled=fixed)
        self._build_navigation(back=True, onward=answered is not None, main=answered is not None)

        def take(_: viser.GuiEvent) -> None:
            if why := why_invalid(step.asked_question, answer := widgets.value):
                return self._show(said, lambda: f"<div class='lab-lesson lab-recorded' role='alert'>{why}</div>")
            with self._lock:
                if step.kind != PREDICT or step.key not in self._progress.answers:  # not meanwhile on another page
                    self._progress.record(step.key, answer, monotonic() - self._shown_at)
                    if self._paced_seat:
                        self._paced_seat.report_answer(step, answer)
                self._shown_at = monotonic()
            self._on_change()
            if step.kind == PREDICT:
                self._rebuild()
            else:
                self._check(lesson, step, said)

        record.on_click(take)

    def _choose_option(self, option: object) -> None:
        """Selects an answer for the browser's message: [the question's key, the option's number from 1]."""
        with self._lock:
            if self._answer is not None and isinstance(option, list) and len(option) == 2 \
                    and self._step is not None and option[0] == self._step.key:
                self._answer.choose(option[1])

    @property
    def _step(self) -> Step | None:
        """The step that is shown; None at the beginning and the end, and without a lesson."""
        return dict(enumerate(self._lesson.steps if self._lesson else (), 1)).get(self._progress.step)

    def _reply_html(self, step: Step, mark: AnswerMark | str | None) -> str:
        """Returns the recorded answer to a step, with a comment on its mark, as html."""
        assert self._lesson is not None
        answer = self._progress.answers[step.key]
        return step_html.recorded_answer_html(self._lesson, step, answer, self._numbers,
                                              *answer_marking_queue.answer_comment(step, answer, mark))

    def _check(self, lesson: Lesson, step: Step, reply: viser.GuiHtmlHandle) -> None:
        """Marks the last answer, which may need a run, and shows the result in ``reply``; enables Next at once."""
        with self._lock:
            if is_removed(reply):
                return
            if self._navigation is not None:
                self._navigation.mark_answered()
            waiting = "" if step.asked_question.kind == TEXT else tr("Being checked against the run …")
            reply.content = self._reply_html(step, waiting)
        self._marker.mark_last_answer(lesson, step, self._progress,
                                      lambda found: self._show(reply, lambda: self._reply_html(step, found)))

    def _text_html(self, lesson: Lesson, step: Step) -> str:
        """Returns the step's text as html; an explanation is preceded by the answers and results so far."""
        before, answers = "", self._progress.answers
        if step.kind == EXPLAIN:
            steps = answer_marking_queue.question_steps_of_round(lesson, step)
            before = step_html.answers_table_html(lesson, steps, answers, self._marker.marks, self._numbers)
        before += step_html.bets_html(self._marker.bets.get(step.key, step_html.WAITED_FOR)) if step.bets else ""
        return step_html.step_html(lesson, step, self._numbers, before, self._classroom.teacher,
                                   self._stage.has_shown_phase_of(step))

    def _mark_all(self, lesson: Lesson, step: Step | None, text: viser.GuiHtmlHandle) -> None:
        """Marks the answers that a step looks back on, all at the end (None), and shows marks in ``text``."""
        steps = answer_marking_queue.question_steps_of_round(lesson, step) if step else list(lesson.questions.values())
        self._marker.mark_first_answers(lesson, steps, self._progress, lambda: self._show(
            text, lambda: self._text_html(lesson, step) if step else self._end_html(lesson)))

    def _show(self, text: viser.GuiHtmlHandle, content: Callable[[], str]) -> None:
        """Sets the html in ``text`` to what ``content`` returns, unless the widget was removed meanwhile."""
        with self._lock:
            if not is_removed(text):
                text.content = content()

    def _build_end(self, lesson: Lesson) -> None:
        text = self._gui.add_html(self._end_html(lesson))
        self._mark_all(lesson, None, text)
        if following := catalogue.next_lesson(lesson):
            self._gui.add_html(MAIN)
            onward = self._gui.add_button(tr("Next lesson: {title}", title=following.title))
            onward.on_click(lambda _: self.open(following.name))
        if self._progress.core and not self._paced_seat:
            self._gui.add_button(tr(progress_and_navigation.GO_DEEPER)).on_click(
                lambda _: self.go_to_step(False, lesson.steps.index(lesson.optional_steps[0]) + 1))
        hint = tr("save your answers as a file")
        self._gui.add_button(tr("Hand in"), icon=viser.Icon.DOWNLOAD, hint=hint).on_click(lambda _: self._hand_in())
        self._build_navigation(back=True, onward=False)

    def _end_html(self, lesson: Lesson) -> str:
        return step_html.end_html(lesson, self._progress, self._marker.marks, self._numbers, bool(self._paced_seat))

    def _hand_in(self) -> None:
        with self._lock:
            name, text = self._progress.file_name, self._progress.text().encode()
        self._client.send_file_download(name, text, save_immediately=True)

    def _build_navigation(self, back: bool, onward: bool, main: bool = True) -> None:
        """Adds Back, Next and Close; Next is ``main`` if it is to be pressed now, usable if ``onward``."""
        lesson, step, at, paced = self._lesson, self._step, self._progress.step, self._paced_seat
        assert lesson is not None
        self._navigation = StepNavigation(
            self._gui, back, onward, main, step is not None and step.kind == PREDICT,
            lambda: paced is not None and paced.last_open_step <= at <= len(lesson.steps),
            tr(PACED if paced else KEPT), self._move_by, self._leave,
            lambda: self.go_to_step(True, lesson.neighbour_step(at, 1, core=True)),
            step is not None and not step.core and not paced)

    def _on_lecturer_opens_step(self) -> None:
        """Updates Next when the lecturer opens another step; everything else stays as it is."""
        with self._lock:
            if self._navigation is not None:
                self._navigation.refresh()

    @property
    def _paced_seat(self) -> VisitorBoardSeat | None:
        """The visitor's seat in the class, while the open lesson is the one that the board paces."""
        return self._classroom.seat if self._classroom.seat and self._classroom.seat.lesson == self.name else None

    @property
    def _numbers(self) -> Numbers:
        """The visitor's own numbers in the lesson."""
        return draw_numbers(self._lesson, self._progress.name) if self._lesson else {}
