"""``mpm-lab stability PROBLEM``: how long runs of each method stay accurate, with and without remedies."""

from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

from app import __version__
from app.commands import lenient_flag_types
from app.commands.lenient_flag_types import ProcessesFlag, choices_of, default_hint, parse_number_or_text, several_of
from app.commands.output import json_text
from app.commands.study.study_command import StudyFlags
from app.names_and_units import unit_of
from solvers.scene.scene import Scene
from solvers.scene.validation import require_choice
from solvers.study.csv_and_markdown_summary import csv_text
from solvers.study.parameter_grid import Task, combinations
from solvers.study.stability_map import TREATMENTS, as_dict, as_markdown, map_tasks, measure_prices, offered_treatments

DEFAULT_CFL = (0.1, 0.3, 0.5, 0.7)


@dataclass(frozen=True, kw_only=True)
class StabilityMap(StudyFlags):
    """Command ``mpm-lab stability``: flags of the map; all valid combinations of their values are run."""

    HELP: ClassVar[str] = """Map how many periods each method of the {title} survives.

    A run counts until its error of x exceeds a tenth of the amplitude or it breaks. Tables and a picture follow at the
    end, with each remedy's price per step and the life that FLIP's drift predicts.
    Exit status: 0 every row is there, 1 could not run or write, 2 bad input, 130 stopped by Ctrl-C (rows are kept)."""
    EXAMPLE: ClassVar[str] = "mpm-lab stability {problem} --periods 20 --out map"
    SCENE: ClassVar[type[Scene]]
    TIMED = False

    method: Any = ()
    treatment: Annotated[Any, several_of(TREATMENTS), default_hint("all that the problem has")] = ()
    """What is called for: remedies, linearity preservation (lp), domains whose corners move with the grid (tiled)."""
    amplitude: Any = ()
    cfl: Any = ()
    cells: Any = None
    ppc: Any = None
    periods: lenient_flag_types.RealFlag = 50.0
    """Longest life that is looked for, in periods."""
    workers: ProcessesFlag = None
    """Processes on this machine that run rows side by side; what a step costs is timed alone, at the end."""

    def measurement_tasks(self) -> list[Task]:
        inputs = combinations(self.axes())
        for treatment in self.treatment:
            require_choice("treatment", treatment, offered_treatments(self.SCENE))
        self.check_study_flags(len(inputs) * len(TREATMENTS))
        return map_tasks(self.SCENE.problem, inputs, self.treatment or offered_treatments(self.SCENE), __version__)

    def write_tables(self, rows: list[dict]) -> int:
        from app.pictures.study_parts import stability_map_figure
        values = as_dict(self.SCENE.problem, rows, measure_prices(self.SCENE, rows))
        return self.write({"stability": stability_map_figure}, rows, lambda _: {
            "stability.csv": csv_text(rows), "stability.json": json_text(values, lines=True),
            "stability.md": as_markdown(values)}, printed="stability.md")

    def axes(self) -> dict[str, list]:
        """Returns all values of each input of the map's scenes, by the name of its flag; raises SceneError."""
        for method in self.method:
            require_choice("method", method, self.SCENE.choices("method"))
        amplitudes, cfls = ([parse_number_or_text([word]) for word in words] for words in (self.amplitude, self.cfl))
        axes = {"method": list(self.method or self.SCENE.choices("method")),
                **{name: [getattr(self, name)] for name in ("cells", "ppc", "periods")},
                "amplitude": amplitudes or list(self.SCENE.HARD_AMPLITUDES), "cfl": cfls or list(DEFAULT_CFL)}
        for name, values in axes.items():
            for value in values:
                self.SCENE(**{name: value})  # validates it
        return axes


def map_flags(scene: type[Scene]) -> dict[str, Any]:
    """Returns the types of the map's flags, by field, that take several values instead of one."""
    return {"method": choices_of(scene.choices("method"), "all", "Methods to map."),
            "amplitude": choices_of(("X",), " ".join(f"{a:g}" for a in scene.HARD_AMPLITUDES),
                                    f"Amplitudes, {unit_of(scene, 'amplitude')}."),
            "cfl": choices_of(("X",), " ".join(map(str, DEFAULT_CFL)), "Lengths of the time step, dt c/h."),
            "periods": lenient_flag_types.RealFlag}
