"""``mpm-lab budget PROBLEM``: who made the error of a run, and what is left of it without one of the causes."""

from dataclasses import dataclass, replace
from typing import Annotated, Any, ClassVar

from app.commands.flags import BadInput, NumberFlag, PathFlag, Switch, default_hint, one_of
from app.commands.output import Target, json_target, put_result, say
from app.commands.progress import working
from app.commands.run.command import BROKEN, FAILED, OK
from app.commands.run.text import budget_table, take_away_table
from app.commands.scene_flags import SceneFlags
from solvers.problems import PROBLEMS
from solvers.scene.causes import CAUSES, FIELDS, NOTHING


@dataclass(frozen=True, kw_only=True)
class Budget(SceneFlags):
    """What is done with the budget of a scene."""

    HELP: ClassVar[str] = """Say which cause has made which part of the error of a run of the {title}.

    Causes are crossings (particles, or their boxes, counted whole where a part lies in the next cell), the coarse grid,
    the body force and the time step; their shares add up to 1. With --take-away the same scene runs again without a
    cause, and what is left stands beside what the budget predicts. {setting}
    Exit status: 0 ok, 1 could not run or write, 2 bad input, 3 a run went unstable or is lost.
    """
    EXAMPLE: ClassVar[str] = "mpm-lab budget {problem} --cells 40 --take-away crossings"

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
        target = json_target(self.json)
        picture = None if self.plot is None else Target("plot", self.plot, ending=".png")
        if target and picture and target.path == picture.path:
            raise BadInput("plot", self.plot, "is the file of --json too; give each its own")
        places = self._map_target(target, picture)
        with working(self.quiet) as show:
            from solvers.running.budget import run_budget  # here: bad input and --help must not wait for Taichi
            self._check(scene, bool(places))  # what is refused needs no warning
            for sentence in () if self.quiet else scene.warnings():
                say(f"warning: {sentence}")
            traced = places and self._error_map(scene, show)
            found = run_budget(scene, self.take_away, show)
        put_result(found.to_dict() | ({"map": traced.to_dict()} if traced else {}), target, _tables)
        if picture:
            from app.pictures.budget import budget_figure
            from app.pictures.run import png_bytes
            picture.write(png_bytes(budget_figure(found)))
        if traced and (refusal := traced.not_valid()):
            say(refusal)
            return FAILED
        if places and traced:
            from app.pictures.budget_map import budget_map_figure
            from app.pictures.run import png_bytes
            places.write(png_bytes(budget_map_figure(traced)))
        broken = [result for result in (found.result, found.again) if result and result.status != "ok"]
        for result in broken:
            say(result.reason)
        return BROKEN if broken else OK

    def _scene(self) -> Any:
        """The scene whose budget is found."""
        return self.scene()

    def _map_target(self, *others: Target | None) -> Target | None:
        """Where a map goes, tried now; None without one."""

    def _check(self, scene: Any, mapped: bool) -> None:
        """Refuse a scene that has no budget or, where that is to be ``mapped``, no map."""

    def _error_map(self, scene: Any, show: Any) -> Any:
        """The map, where there is one."""


@dataclass(frozen=True, kw_only=True)
class BudgetOfEffect(Budget):
    """The budget of a problem whose runs carry it with them, and the map of its error."""

    HELP: ClassVar[str] = Budget.HELP.replace("Exit status", """With --map the error of the end is traced back to
    where and when it was made, if it does not cancel on the way.
    Exit status""")

    map: Annotated[PathFlag, default_hint("no picture")] = None
    """File for a picture of where and when the error of the end was made, .png."""
    field: Annotated[Any, one_of(FIELDS), default_hint("x")] = None
    """Whose error the map is of."""
    particle: Annotated[NumberFlag, default_hint("all, RMS")] = None
    """Number of the particle, from 0, whose error the map is of."""

    def _scene(self) -> Any:
        """The scene with the budget switched on, whatever other effects it has."""
        asked = self.scene()
        scene = replace(asked, effects=tuple(dict.fromkeys((*asked.effects, "budget"))))
        if scene.has("budget"):
            return scene
        if "truth" in asked.effects:
            raise BadInput("body-force", scene.body_force, "has no exact solution to compare the bar with, so that a "
                           "budget needs the effect estimate and --estimator companion")
        raise BadInput("effects", " ".join(asked.effects) or "none", "a budget needs the effect truth and an exact "
                       "solution, or the effect estimate and --estimator companion")

    def _map_target(self, *others: Target | None) -> Target | None:
        """Where the map goes, tried now."""
        if self.map is None:
            for flag, value in (("field", self.field), ("particle", self.particle)):
                if value is not None:
                    raise BadInput(flag, value, "is said of a map; give --map FILE too, or leave it out")
            return None
        target = Target("map", self.map, ending=".png")
        if any(other and other.path == target.path for other in others):
            raise BadInput("map", self.map, "is the file of another flag too; give each its own")
        return target

    def _check(self, scene: Any, mapped: bool) -> None:
        if mapped:
            PROBLEMS[scene.problem].check_map(replace(scene, take_away=NOTHING), self._field, self.particle)

    def _error_map(self, scene: Any, show: Any) -> Any:
        return PROBLEMS[scene.problem].error_map(replace(scene, take_away=NOTHING), self._field, self.particle, show)

    @property
    def _field(self) -> str:
        return "x" if self.field is None else self.field


@dataclass(frozen=True, kw_only=True)
class BudgetOnDemand(Budget):
    """The budget of a problem whose runs do not carry it with them."""

    HELP: ClassVar[str] = Budget.HELP.replace("Exit status", """The run is taken a step at a time, against the exact
    solution; the body force acts at material points and makes no error.
    Exit status""")

    def _check(self, scene: Any, mapped: bool) -> None:
        found = PROBLEMS[scene.problem].budget
        assert found is not None  # else the command is that of an effect
        found.check(scene, self.take_away)


def _tables(values: dict) -> str:
    """The budget, and what was taken away, in words."""
    parts = [budget_table(values["budget"])]
    if values["take_away"]:
        parts.append(take_away_table(values["take_away"]))
    return "\n\n".join(parts)
