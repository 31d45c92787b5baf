"""The numbers that were wanted of a run, as ``mpm-lab run`` prints them: each with a bar by every estimator."""

from collections.abc import Iterator, Mapping

from solvers.running.goals import SAFETY
from solvers.scene.scene import Scene
from solvers.study.coverage import track_record

NOTHING = "-"
WIDTH = 14
MEANING = (f"bar: {SAFETY:g} times the estimated error of the number; held: how often such a bar held the truth in "
           "runs of\nthis method that were drawn at random (mpm-lab coverage)")


def goal_table(scene: Scene, goals: Mapping[str, dict]) -> str:
    """A block for each goal, and what the bars are; nothing where none was wanted."""
    if not goals:
        return ""
    blocks = ["\n".join(_lines(scene, name, goal)) for name, goal in goals.items()]
    return "\n\n".join(["", *blocks, MEANING])


def _lines(scene: Scene, name: str, goal: Mapping) -> Iterator[str]:
    unit = goal["unit"]
    yield f"{name:<24}{_number(goal['value'], '.6g'):>{WIDTH}} {unit}"
    for estimator, bar in goal["bar"].items():
        counts = track_record.held(scene, name, estimator)
        often = f"   held {counts[0]} of {counts[1]}" if counts else ""
        yield f"  {'+- ' + estimator:<22}{_number(bar, '.2g'):>{WIDTH}} {unit}{often if bar is not None else ''}"
    if goal["true_error"] is not None:
        yield f"  {'true error':<22}{_number(goal['true_error'], '.2g'):>{WIDTH}} {unit}"


def _number(value: float | None, form: str) -> str:
    return NOTHING if value is None else format(value, form)
