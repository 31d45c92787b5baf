"""The commands of ``mpm-lab``, one file each.

A command is a frozen dataclass: its fields are its flags, its docstring is its help; ``execute()`` does the work and
returns the exit status. One that takes a scene is made for each problem (``scene_flags``). A new one is listed here."""

from collections.abc import Callable
from functools import cache, partial

from app.commands.bench.command import Bench
from app.commands.body import BodyList, BodyShow, RunBody
from app.commands.check.contradiction_check import ContradictionCheck
from app.commands.export import Export
from app.commands.judge.command import Judge
from app.commands.judge.problem import ProblemCommand
from app.commands.lenient_flag_types import Switch
from app.commands.lesson import LessonCheck, LessonGrade, LessonList, LessonScriptsCopy, LessonTeacherGuide
from app.commands.run.budget_command import Budget
from app.commands.run.command import Run, RunFromSceneText
from app.commands.scene_flags import command_of_problem, with_scene_flags
from app.commands.serve import Serve
from app.commands.study.advise import Advise, search_flags
from app.commands.study.body_sweep import BodySweep
from app.commands.study.coverage import CantileverCoverage, Coverage
from app.commands.study.paper_tables import PaperTables
from app.commands.study.stability_map import StabilityMap, map_flags
from app.commands.study.sweep import Sweep
from solvers.problems import PROBLEMS
from solvers.scene.scene import Scene

#: What ``mpm-lab`` does when no command is given.
DEFAULT_COMMAND = ("serve",)
#: What stands for any word that ends in .toml in the names of commands: a file of a body.
BODY_FILE = "FILE.toml"


@cache
def commands() -> dict[tuple[str, ...], type]:
    """Returns the class of each command by the words of its name, ("run", "bar"), in the order of the help."""
    def for_problems(word: str, make: Callable[[type[Scene]], type]) -> dict[tuple[str, ...], type]:
        return {(word, name): make(problem.scene) for name, problem in PROBLEMS.items()}

    return {("serve",): Serve, **for_problems("run", partial(command_of_problem, Run)),
            ("run", "--scene"): RunFromSceneText, ("run", BODY_FILE): RunBody,
            ("body", "list"): BodyList, ("body", "show"): BodyShow,
            **for_problems("budget", partial(command_of_problem, Budget)),
            **for_problems("sweep", partial(command_of_problem, Sweep, linearity_preserving=Switch)),
            ("sweep", BODY_FILE): BodySweep, **for_problems("problem", partial(command_of_problem, ProblemCommand)),
            **for_problems("judge", partial(command_of_problem, Judge)),
            ("check",): ContradictionCheck, ("tables",): PaperTables,
            **for_problems("advise", lambda scene: with_scene_flags(Advise, scene, **search_flags(scene))),
            **for_problems("stability", lambda scene: with_scene_flags(StabilityMap, scene, **map_flags(scene))),
            **for_problems("coverage", partial(with_scene_flags, Coverage)), ("coverage", "body"): CantileverCoverage,
            ("lesson", "list"): LessonList, ("lesson", "check"): LessonCheck, ("lesson", "guide"): LessonTeacherGuide,
            ("lesson", "grade"): LessonGrade, ("lesson", "scripts"): LessonScriptsCopy,
            ("export",): Export, ("bench",): Bench}
