"""The scene that the page shows first of each problem."""

from solvers.problems import PROBLEMS
from solvers.scene.scene import Scene


def first_scene(problem: str) -> Scene:
    """Returns the scene that the page shows first of a problem ("bar"): its defaults, for one period at most."""
    kind = PROBLEMS[problem].scene
    return kind(periods=min(1, kind.DEFAULT_PERIODS))
