"""What visitors usually ask for, the likeliest first: compiled before they do."""

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from itertools import combinations
from typing import Any

from app.page.session import first_scene
from app.problems.views import VIEWS
from solvers.problems import PROBLEMS
from solvers.rules import SceneError
from solvers.scene import Scene


def usual_scenes() -> list[Scene]:
    """Of every problem the page's first scene, then what one change makes of it, then what two do."""
    firsts = [first_scene(problem) for problem in PROBLEMS]
    rounds = ([_estimators(scene) for scene in firsts] + [_methods(scene) for scene in firsts]
              + [_single_changes(scene) for scene in firsts])
    return [scene for changes in rounds for scene in changes]


def _estimators(first: Scene) -> Iterator[Scene]:
    """One estimator or two, with the first method."""
    names = first.choices("estimators")
    for chosen in (*((name,) for name in names), (), *combinations(names, 2)):
        yield from _with(first, estimators=chosen)


def _methods(first: Scene) -> Iterator[Scene]:
    """The other methods, with the first estimators and with each alone."""
    for chosen in (first.estimators, *((name,) for name in first.choices("estimators"))):
        for method in first.choices("method"):
            yield from _with(first, method=method, estimators=chosen)


def _single_changes(first: Scene) -> Iterator[Scene]:
    """One box or one choice among the motions, the details, the remedies and the effects."""
    if motion := VIEWS[first.problem].motion:
        for choice in first.choices("motion"):
            yield motion.change(first, choice, first.estimators)
    for remedy in first.choices("remedies"):
        yield from _with(first, remedies=(remedy,))
    for effect in first.effects:
        yield from _with(first, effects=tuple(e for e in first.effects if e != effect))
    for field in ("velocity", "body_force"):
        for choice in first.choices(field):
            yield from _with(first, **{field: choice})
    yield from _with(first, linearity_preserving=True)


def _with(first: Scene, **changes: Any) -> Iterator[Scene]:
    with suppress(SceneError):  # not everything goes together
        yield replace(first, **changes)
