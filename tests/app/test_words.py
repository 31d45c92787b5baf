"""Words about a scene come from the scene: what does not swing is not the patch test of the bar."""

from __future__ import annotations

from dataclasses import dataclass, replace

from app import words
from solvers.problems.bar.patch import PATCH
from solvers.problems.bar.scene import BarScene


@dataclass(frozen=True)
class SlidingScene(BarScene):
    """A bar that slides through the grid."""

    TITLE = "sliding bar"
    swings = False
    moved_by = ("initial_velocity",)


def test_what_does_not_swing_has_its_own_title_and_motion():
    scene = SlidingScene()
    assert scene.title == "sliding bar" and words.moving(scene) == "v = 1 m/s"
    assert words.in_a_line(scene).startswith("Sliding bar: ") and "patch" not in words.in_a_line(scene)


def test_a_patch_test_says_so():
    scene = BarScene(motion=PATCH, cells=8, ppc=2.5)
    assert scene.title == "patch test of the bar" and words.moving(scene) == "patch test, F = 1.02, v = 1 m/s"
    assert words.in_a_line(scene).lower().count("patch test") == 1
    assert "--motion patch" in words.command_line(scene) and "--body-force" not in words.command_line(scene)
    assert words.moving(replace(BarScene(), amplitude=0.025)) == "A = 25 mm"
