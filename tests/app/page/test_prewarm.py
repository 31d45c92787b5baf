"""What is compiled before anybody asks for it: what is likely, and in that order."""

from dataclasses import replace

import pytest

from app import shareable_state
from app.lessons import catalogue
from app.lessons.lesson import fill_numbers
from app.page.features.opening_tour import BAR, BESIDE
from app.page.precompiled_scenes import usual_scenes
from app.page.visit.first_scene import first_scene
from solvers.problems import PROBLEMS
from solvers.scene.kernel_options import kernel_key


@pytest.fixture(scope="module")
def lessons():
    return catalogue.load_lessons()


def taught(lesson):
    """The combinations that a lesson puts on the stage, for every variant."""
    stages = [shareable_state.parse_state(fill_numbers(step.stage, numbers)) for step in lesson.steps if step.stage
              for numbers in lesson.variants]
    return {kernel_key(scene) for shown in stages for scene in (shown.scene, shown.pinned) if scene is not None}


def test_every_scene_of_a_lesson_is_usual(lessons):
    """Whoever opens a lesson knows nothing of compilers; its variants differ in numbers, which compile nothing."""
    usual = set(map(kernel_key, usual_scenes(lessons)))
    for name, lesson in lessons.items():
        assert taught(lesson) <= usual, name


def test_the_likeliest_come_first(lessons):
    """The opening, each problem as it is at first, then one click, and last what no lesson does; the lesson that a
    class is opened on comes before any click."""
    first = [first_scene(problem) for problem in PROBLEMS]
    usual = usual_scenes(lessons)
    assert usual[:2 + len(first)] == [BAR, BESIDE, *first]
    places = {kernel_key(scene): k for k, scene in reversed(list(enumerate(usual)))}
    click, box = replace(first[0], method="mpm"), replace(first[0], effects=first[0].effects[1:])
    assert places[kernel_key(click)] < places[kernel_key(first[0].__class__(estimators=("recovered",)))] \
        < places[kernel_key(box)]
    asked = replace(click, effects=(*click.effects, "budget"))
    assert places[kernel_key(click)] < places[kernel_key(asked)] < places[kernel_key(box)], "who made the error"
    name = list(lessons)[-1]
    opened = usual_scenes(lessons, name)
    some = 2 + len(first) + 2 * len(lessons[name].steps)
    assert taught(lessons[name]) <= set(map(kernel_key, opened[:some]))


@pytest.mark.parametrize("problem", PROBLEMS)
def test_the_order_of_estimators_compiles_nothing(problem):
    """They run in one order, whichever they are asked for in; what is shown first is still what was asked for first."""
    scene = replace(PROBLEMS[problem].scene(), estimators=("companion", "transport"))
    other = replace(scene, estimators=("transport", "companion"))
    assert kernel_key(scene) == kernel_key(other) and scene.active_estimators == other.active_estimators
    assert scene.estimators[0] == "companion"
