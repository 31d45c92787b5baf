"""What visitors usually ask for, the likeliest first: compiled before they do.

A visitor begins with the opening, goes on to a problem as it is at first, and clicks: what one click among the open
controls makes of that comes first, in each problem; then what the lessons put on the stage, for there it is known; then
what takes two clicks or an open folder. Two changes at once that no lesson makes are not usual: they are many, and
compiled when asked for.
"""

from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from typing import Any

from app import state
from app.lessons.lesson import Lesson, fill_numbers
from app.page.features.budget.panel import EFFECT
from app.page.features.opening_tour import OPENING
from app.page.visit.session import first_scene
from app.problems.views import VIEWS
from solvers.problems import PROBLEMS
from solvers.scene.scene import Scene
from solvers.scene.validation import SceneError


def usual_scenes(lessons: Mapping[str, Lesson], opened: str = "") -> list[Scene]:
    """Returns scenes of every problem and of the ``lessons``; those of the one ``opened`` for all come early."""
    firsts = [first_scene(problem) for problem in PROBLEMS]
    taught = {name: list(_stages(lesson)) for name, lesson in lessons.items()}

    def of_each(change: Callable[[Scene], Iterator[Scene]]) -> list[Scene]:
        return [scene for first in firsts for scene in change(first)]

    opening = [scene for scene in (OPENING.scene, OPENING.pinned) if scene]
    asked = [scene for one in opening for scene in _divided(one)]
    return [*opening, *firsts, *taught.get(opened, ()), *asked, *of_each(_clicks),
            *(scene for some in taught.values() for scene in some), *of_each(_alone), *of_each(_details),
            *of_each(_effects)]


def _clicks(first: Scene) -> Iterator[Scene]:
    """One estimator more or fewer, another method or another motion; and who made the error of each method."""
    names = first.choices("estimators")
    for name in names:
        yield from _with(first, estimators=tuple(e for e in names if (e in first.estimators) != (e == name)))
    methods = [scene for method in first.choices("method") for scene in _with(first, method=method)]
    yield from methods
    for scene in methods:
        yield from _divided(scene)
    if motion := VIEWS[first.problem].motion:
        for choice in first.choices("motion"):
            yield motion.change(first, choice, first.estimators)


def _divided(scene: Scene) -> Iterator[Scene]:
    """The scene when the visitor has asked who made its error."""
    if EFFECT in scene.OWN_EFFECTS and EFFECT not in scene.effects:
        yield from _with(scene, effects=(*scene.effects, EFFECT))


def _stages(lesson: Lesson) -> Iterator[Scene]:
    """What a lesson puts on the stage, pinned runs too: its variants differ in numbers, which compile nothing."""
    for step in lesson.steps:
        if step.stage:
            shown = state.parse_state(fill_numbers(step.stage, lesson.variants[0]))
            yield shown.scene
            if shown.pinned is not None:
                yield shown.pinned


def _alone(first: Scene) -> Iterator[Scene]:
    """No estimator, and each by itself."""
    for chosen in ((), *((name,) for name in first.choices("estimators"))):
        yield from _with(first, estimators=chosen)


def _details(first: Scene) -> Iterator[Scene]:
    """One choice in the folder of details and remedies."""
    for remedy in first.choices("remedies"):
        yield from _with(first, remedies=(remedy,))
    for field in ("velocity", "body_force"):
        for choice in first.choices(field):
            yield from _with(first, **{field: choice})
    yield from _with(first, linearity_preserving=True)


def _effects(first: Scene) -> Iterator[Scene]:
    """One box of the folder of effects unticked: no lesson does that, so they come last."""
    for effect in first.effects:
        yield from _with(first, effects=tuple(e for e in first.effects if e != effect))


def _with(first: Scene, **changes: Any) -> Iterator[Scene]:
    with suppress(SceneError):  # not everything goes together
        yield replace(first, **changes)
