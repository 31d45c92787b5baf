"""``mpm-lab budget PROBLEM``: the error of a run by cause, and the error without one of the causes."""

from dataclasses import dataclass, replace
from typing import Annotated, Any, ClassVar

from app.commands.lenient_flag_types import BadInput, PathFlag, Switch, default_hint, one_of
from app.commands.output import json_and_plot_targets, print_message, put_result
from app.commands.progress import show_progress
from app.commands.run.command import BROKEN, OK
from app.commands.run.text_summary import budget_table, removed_cause_table
from app.commands.scene_flags import SceneFlags
from solvers.problems import PROBLEMS
from solvers.scene.error_causes import CAUSES, NOTHING

_MAP = "the map of where and when an error was made has gone; --plot draws what each cause made over time"


@dataclass(frozen=True, kw_only=True)
class Budget(SceneFlags):
    """Command ``mpm-lab budget``: flags of the scene, of the cause to take away, and of the output."""

    HELP: ClassVar[str] = """Say which cause has made which part of the error of a run of the {title}.

    Causes are crossings (particles, or their boxes, counted whole where a part lies in the next cell), the coarse grid,
    the body force and the time step; their shares add up to 1. With --take-away the same scene runs again without a
    cause, and what is left stands beside what the budget predicts. {setting} A run in the plane is taken a step at a
    time, against the exact solution; there the body force acts at material points and makes no error.
    Exit status: 0 ok, 1 could not run or write, 2 bad input, 3 a run went unstable or is lost.
    """
    EXAMPLE: ClassVar[str] = "mpm-lab budget {problem} --cells 40 --take-away crossings"
    GONE: ClassVar[dict[str, str]] = dict.fromkeys(("--map", "--field", "--particle"), _MAP)

    take_away: Annotated[Any, one_of((NOTHING, *CAUSES))] = NOTHING
    """Cause of error that is taken out of the run."""
    json: Annotated[PathFlag, default_hint("a table is printed instead")] = None
    """File for the budget as a JSON object; - is standard output."""
    plot: Annotated[PathFlag, default_hint("no picture")] = None
    """File for a picture of it over time, .png."""
    quiet: Annotated[Switch, default_hint("off")] = False
    """No progress bar, no warnings and no remarks on standard error."""

    def execute(self) -> int:
        scene = self._scene()
        target, picture = json_and_plot_targets(self.json, self.plot)
        with show_progress(self.quiet) as show:
            from solvers.running.budget_cause_removal import (
                run_budget,  # here: bad input and --help must not wait for Taichi
            )
            if (on_demand := PROBLEMS[scene.problem].budget) is not None:
                on_demand.require_budget(scene, self.take_away)  # rejects before warnings
            for sentence in () if self.quiet else scene.warnings():
                print_message(f"warning: {sentence}")
            found = run_budget(scene, self.take_away, show)
        put_result(found.to_dict(), target, _tables)
        if picture:
            from app.pictures.budget import budget_figure
            from app.pictures.run_errors import png_bytes
            picture.write(png_bytes(budget_figure(found)))
        broken = [result for result in (found.result, found.again) if result and result.status != "ok"]
        for result in broken:
            print_message(result.reason)
        return BROKEN if broken else OK

    def _scene(self) -> Any:
        """Returns the scene, with the effect budget if its problem has one; raises BadInput if that cannot be."""
        asked = self.scene()
        if "budget" not in asked.OWN_EFFECTS:
            return asked
        scene = replace(asked, effects=tuple(dict.fromkeys((*asked.effects, "budget"))))
        if scene.has("budget"):
            return scene
        raise BadInput("effects", " ".join(asked.effects) or "none", "a budget needs the effect truth, or the effect "
                       "estimate and --estimator companion")


def _tables(values: dict) -> str:
    """Returns the tables of the budget and of a removed cause, if any, as text, from the command's JSON object."""
    removed, crossed = values["take_away"], values["grid_crossings"] != 0
    return "\n\n".join([budget_table(values["budget"], crossed),
                        *([removed_cause_table(removed, crossed)] if removed else [])])
