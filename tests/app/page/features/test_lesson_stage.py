"""The curtain before the stage of a lesson: closed while the stage has another run than the step that is shown."""

from types import SimpleNamespace

from app import shareable_state
from app.lessons import catalogue
from app.page.features.lesson.lesson_stage import LessonStage
from tests.app.page.panel import Gui

RUN, AFTER, AGAIN, FORCES = 2, 3, 6, 10  # steps of the first lesson; AGAIN has the same run as RUN


class Page:
    """Remembers what a lesson does with the stage."""

    def __init__(self):
        self.gui, self.done = Gui(), []
        self.session = SimpleNamespace(play=lambda on: self.done.append(("play", on)), scene=None, report=None)
        self.controls = SimpleNamespace(state=shareable_state.parse_state("bar"), show=self.show)
        self.show_run_on_stage = lambda: self.done.append("run")
        self.show_phase = lambda *phase: self.done.append(phase)

    def show(self, state):
        self.controls.state, self.session.scene = state, state.scene
        self.done.append(state.scene.cells)


def test_a_step_closes_the_stage_until_its_run_is_there():
    page, lesson = Page(), catalogue.load_lesson("01-one-step")
    stage = LessonStage(page, lambda: show(RUN) and page.done.append("rebuilt"))

    def show(number):
        stage.show_step(lesson, number, {})
        assert bool(stage.headline) == ("lab-curtain" in page.gui.said)
        return bool(stage.headline)

    assert not show(1) and page.done == []
    assert show(RUN) and page.done == ["run", ("play", False)]
    assert "Show phase 2 of particle 10" in page.gui.said and f"data-step='{RUN}'" in page.gui.said
    stage.perform([RUN, "phase"])
    stage.refresh()
    assert page.done[2:] == [8, (10, 2), "rebuilt"] and stage.headline  # the run is being compiled
    page.session.report = SimpleNamespace(scene=page.session.scene)
    stage.refresh()
    assert not stage.headline and stage.has_shown_phase_of(lesson.steps[RUN - 1])
    assert not show(RUN) and not show(AFTER) and not show(AGAIN)
    assert show(FORCES) and "On the stage" in page.gui.said
    stage.perform([FORCES, "stage"])
    page.session.report = SimpleNamespace(scene=page.session.scene)
    stage.refresh()
    assert not stage.headline and not show(FORCES) and show(RUN)
    stage.show_step(None, 0, {})
    assert not stage.headline and "lab-curtain" not in page.gui.said


def test_messages_of_another_step_do_nothing():
    page = Page()
    stage = LessonStage(page, lambda: None)
    for message in ([RUN, "stage"], [0, "phase"], "stage", [RUN, []], None):
        stage.perform(message)
    assert page.done == []
