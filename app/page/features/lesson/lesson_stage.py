"""What a lesson's step does with the stage: its buttons, and a curtain until the step's own run is there."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from app import shareable_state
from app.frame.headline import HeadlineWithFacts
from app.language.translation import tr, use_language
from app.lessons.lesson import RUN, Lesson, Numbers, Step, fill_numbers
from app.page.features.lesson import instruction_buttons, step_html
from app.page.page_context import PageContext


@dataclass(frozen=True)
class ShownStep:
    """The step of a lesson that is shown (None at the beginning and the end), by its number: the state of its run as
    text, and the instructions in its text that have buttons."""

    number: int = 0
    step: Step | None = None
    stage: str = ""
    acts: Sequence[instruction_buttons.Instruction] = ()


class LessonStage:
    """The stage of one visitor's lesson. A step with a run of its own covers the stage until the visitor puts that run
    there: the run of another step, which pauses meanwhile, may give the answer away. ``on_explored`` is called
    when a step's button has shown its phase."""

    def __init__(self, page: PageContext, on_explored: Callable[[], None]):
        self._page, self._curtain, self._on_explored = page, page.gui.add_html(""), on_explored
        self._shown = ShownStep()
        self._put, self._loading = "", False  # the state put on the stage last, as text; whether it is still to come
        self._explored: Step | None = None  # the step whose phase was shown last
        self.headline = HeadlineWithFacts()  # in place of that of the run behind the curtain; empty while open

    def show_step(self, lesson: Lesson | None, number: int, numbers: Numbers) -> None:
        """Prepares buttons and curtain for a lesson's step by its ``number``, at which there may be none; ``numbers``
        are the visitor's own."""
        step = dict(enumerate(lesson.steps if lesson else (), 1)).get(number)
        self._shown, stage = ShownStep(), ""
        if lesson and step:
            with use_language(lesson.language):
                acts = instruction_buttons.find_instructions(step_html.text_html(step.text, numbers))
            self._shown = ShownStep(number, step, stage := fill_numbers(step.stage, numbers), acts)
        if step is None or step.kind != RUN or not stage or self._is_on_stage(stage):
            if not self._loading:
                self._open()
            return
        self._loading = False
        self._page.show_run_on_stage()
        self._page.session.play(False)
        self.headline = HeadlineWithFacts.from_template(tr("Step {number}: its run is not loaded yet", number=number))
        self._curtain.content = step_html.curtain_html(step, number)

    def perform(self, message: object) -> None:
        """Carries out a button of the step that is shown: the browser's ``message`` is [step, instruction's index,
        "stage" or "phase"]."""
        shown = self._shown  # may change meanwhile
        act = instruction_buttons.parse_click(message, shown.number, shown.acts)
        if isinstance(act, instruction_buttons.Instruction):
            instruction_buttons.perform_instruction(act, self._page.controls)
        elif act and shown.step and shown.stage:
            self._put, self._explored, phase = shown.stage, None, shown.step.shown_phase
            self._page.controls.show(shareable_state.parse_state(shown.stage))
            self._loading = True
            self.headline = HeadlineWithFacts.from_template(tr("Step {number}: its run is being loaded",
                                                               number=shown.number))
            if act == instruction_buttons.PHASE and phase:
                self._explored = shown.step
                self._page.show_phase(phase.particle, phase.phase)
                self._on_explored()

    def refresh(self) -> None:
        """Opens the curtain when the run that was put on the stage is there: it may have to be compiled first."""
        session = self._page.session
        if self._loading and session.report is not None and session.report.scene == session.scene:
            self._loading = False
            self._open()

    def has_shown_phase_of(self, step: Step) -> bool:
        """Whether the phase that a step's button shows was shown, and no other run after it."""
        return step is self._explored

    def _open(self) -> None:
        self.headline, self._curtain.content = HeadlineWithFacts(), ""

    def _is_on_stage(self, stage: str) -> bool:
        return stage == self._put or shareable_state.parse_state(stage).scene == self._page.controls.state.scene
