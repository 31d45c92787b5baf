"""The commands of ``mpm-lab``, one file each.

A command is a frozen dataclass: its fields are its flags, its docstring is its help, and ``execute()`` does
the work and returns the exit status. One that takes a scene is made for each problem (``scene_flags``). To add one,
write the dataclass and list it here."""

import functools

from app.commands.bench.command import Bench
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
from app.commands.study.coverage import Coverage
from app.commands.study.paper_tables import PaperTables
from app.commands.study.stability_map import StabilityMap, map_flags
from app.commands.study.sweep import Sweep
from solvers.problems import PROBLEMS

#: What ``mpm-lab`` does when no command is given.
DEFAULT_COMMAND = ("serve",)


@functools.cache
def commands() -> dict[tuple[str, ...], type]:
    """Returns the class of each command by the words of its name, ("run", "bar"), in the order of the help."""
    scenes = {name: problem.scene for name, problem in PROBLEMS.items()}
    found: dict[tuple[str, ...], type] = {("serve",): Serve}
    found |= {("run", name): command_of_problem(Run, scene) for name, scene in scenes.items()}
    found |= {("run", "--scene"): RunFromSceneText}
    found |= {("budget", name): command_of_problem(Budget, scene) for name, scene in scenes.items()}
    found |= {("sweep", name): command_of_problem(Sweep, scene, linearity_preserving=Switch) for name,
              scene in scenes.items()}
    found |= {("problem", name): command_of_problem(ProblemCommand, scene) for name, scene in scenes.items()}
    found |= {("judge", name): command_of_problem(Judge, scene) for name, scene in scenes.items()}
    found |= {("check",): ContradictionCheck, ("tables",): PaperTables}
    found |= {("advise", name): with_scene_flags(Advise, scene, **search_flags(scene)) for name,
              scene in scenes.items()}
    found |= {("stability", name): with_scene_flags(StabilityMap, scene, **map_flags(scene)) for name,
              scene in scenes.items()}
    found |= {("coverage", name): with_scene_flags(Coverage, scene) for name, scene in scenes.items()}
    found |= {("lesson", "list"): LessonList, ("lesson", "check"): LessonCheck, ("lesson", "guide"): LessonTeacherGuide,
              ("lesson", "grade"): LessonGrade, ("lesson", "scripts"): LessonScriptsCopy}
    return found | {("export",): Export, ("bench",): Bench}
