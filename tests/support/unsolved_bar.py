"""A bar that is treated as if no exact solution were built in, as none is for a ring under two tones."""

from dataclasses import fields

from solvers.problems.bar.scene import BarScene


class UnsolvedBarScene(BarScene):
    """Bar without a known exact solution."""

    solution_known = False


def unsolved(scene: BarScene) -> UnsolvedBarScene:
    """The same bar as if nobody had solved it."""
    return UnsolvedBarScene(**{one.name: getattr(scene, one.name) for one in fields(scene)})
