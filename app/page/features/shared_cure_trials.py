"""Trials of what may help a broken run on the stage, for all visitors in one background process."""

from collections.abc import Callable
from dataclasses import asdict, replace
from typing import Any

from app.page.features.shared_answers import SharedAnswers
from solvers.engine.engine_messages import FrameReport
from solvers.scene.scene import Scene
from solvers.study.parameter_grid import Task

ENOUGH = 2  # cures that are offered
SECONDS = 30.0  # for trials, beside a stage that goes on


class SharedCureTrials(SharedAnswers):
    """Cures (``solvers.running.cures.Cure``, as dicts) that held, by the scene of a broken run."""

    def __init__(self) -> None:
        super().__init__(f"{__name__}:try_scene")

    def usable(self, answer: dict[str, Any]) -> list[dict[str, Any]]:
        return answer.get("held", [])


def scene_to_try(report: FrameReport) -> Scene:
    """Returns the scene of a broken run on the stage, to its own end, or twice as long as the run if it broke later."""
    scene, broke = report.scene, report.since or report.time
    return scene if broke < scene.end_time else replace(scene, t_end=None, periods=2 * broke / scene.period)


def try_scene(question: dict[str, Any], tell: Callable[[dict[str, Any]], object]) -> None:
    """Runs the scene of {"task": ...} in a worker process, tries what may help, and passes {"held": cures} to
    ``tell``; an earlier end, which the stage does not have, is none."""
    from solvers.running.cure_trials import try_cures
    from solvers.running.run import run

    result = run(Task(**question["task"]).scene(), mid_run=False)
    endless = tuple(cure for cure in result.advice if "periods" not in cure.change)
    tried = try_cures(replace(result, advice=endless), SECONDS, ENOUGH)
    tell({"held": [asdict(cure) for cure in tried.advice if cure.held]})


SHARED = SharedCureTrials()
