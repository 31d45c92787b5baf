"""Usual scenes, the likeliest first, which are compiled before visitors request them.

After the opening and each problem's first scene come scenes one click away, those of the lessons, and those two clicks
or a folder away. Two changes at once that no lesson makes are too many, and are compiled on request."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from typing import Any

from app import shareable_state
from app.lessons.lesson import Lesson, fill_numbers
from app.page.features.budget.panel import EFFECT
from app.page.features.opening_tour import BAR, BESIDE
from app.page.visit.first_scene import first_scene
from app.problems.views import VIEWS
from solvers.problems import PROBLEMS
from solvers.scene.scene import Scene
from solvers.scene.validation import SceneError


def usual_scenes(lessons: Mapping[str, Lesson], opened: str = "") -> list[Scene]:
    """Returns scenes to compile, likeliest first: of every problem and of ``lessons`` (by name), early those of the
    lesson ``opened`` for everyone ("" for none)."""
    firsts = [first_scene(problem) for problem in PROBLEMS]
    taught = {name: list(_lesson_scenes(lesson)) for name, lesson in lessons.items()}

    def of_each(change: Callable[[Scene], Iterator[Scene]]) -> list[Scene]:
        return [scene for first in firsts for scene in change(first)]

    asked = [scene for one in (BAR, BESIDE) for scene in _budget_scene(one)]
    return [BAR, BESIDE, *firsts, *taught.get(opened, ()), *asked, *of_each(_scenes_one_click_away),
            *(scene for some in taught.values() for scene in some), *of_each(_single_estimator_scenes),
            *of_each(_detail_scenes), *of_each(_scenes_without_one_effect)]


def _scenes_one_click_away(first: Scene) -> Iterator[Scene]:
    """Yields changes of a scene: an estimator more or fewer, another method or motion, the budget of each method."""
    names = first.choices("estimators")
    for name in names:
        yield from _changed_scene(first, estimators=tuple(e for e in names if (e in first.estimators) != (e == name)))
    methods = [scene for method in first.choices("method") for scene in _changed_scene(first, method=method)]
    yield from methods
    for scene in methods:
        yield from _budget_scene(scene)
    if motion := VIEWS[first.problem].motion:
        for choice in first.choices("motion"):
            yield motion.change_motion(first, choice, first.estimators)


def _budget_scene(scene: Scene) -> Iterator[Scene]:
    """Yields the scene with the error budget switched on; nothing if that is not possible or it is on already."""
    if EFFECT in scene.OWN_EFFECTS and EFFECT not in scene.effects:
        yield from _changed_scene(scene, effects=(*scene.effects, EFFECT))


def _lesson_scenes(lesson: Lesson) -> Iterator[Scene]:
    """Yields the scenes of a lesson, also pinned ones; its variants differ in numbers only, which compile nothing."""
    for step in lesson.steps:
        if step.stage:
            shown = shareable_state.parse_state(fill_numbers(step.stage, lesson.variants[0]))
            yield shown.scene
            if shown.pinned is not None:
                yield shown.pinned


def _single_estimator_scenes(first: Scene) -> Iterator[Scene]:
    """Yields a scene without estimators, and with each alone."""
    for chosen in ((), *((name,) for name in first.choices("estimators"))):
        yield from _changed_scene(first, estimators=chosen)


def _detail_scenes(first: Scene) -> Iterator[Scene]:
    """Yields variants of a scene with one other choice in the folder of details and remedies."""
    for remedy in first.choices("remedies"):
        yield from _changed_scene(first, remedies=(remedy,))
    for field in ("velocity", "body_force"):
        for choice in first.choices(field):
            yield from _changed_scene(first, **{field: choice})
    yield from _changed_scene(first, linearity_preserving=True)


def _scenes_without_one_effect(first: Scene) -> Iterator[Scene]:
    """Yields variants of a scene with one effect switched off; compiled last, since no lesson does that."""
    for effect in first.effects:
        yield from _changed_scene(first, effects=tuple(e for e in first.effects if e != effect))


def _changed_scene(first: Scene, **changes: Any) -> Iterator[Scene]:
    with suppress(SceneError):  # invalid combinations are skipped
        yield replace(first, **changes)
