"""``mpm-lab problem PROBLEM --out DIR``: everything that another code needs to set up the problem."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, ClassVar

import numpy as np

from app.commands.lenient_flag_types import BadInput, NamesFlag, PathFlag, default_hint, parse_times
from app.commands.output import OutputFolder, json_text, print_message
from app.commands.scene_flags import SceneFlags
from app.names_and_units import per_cell
from app.templates import render_template
from solvers.judging.quantity_names import output_column_names
from solvers.problems import PROBLEMS
from solvers.problems.judging_reference import METHOD_FIELDS, ProblemDescription
from solvers.scene.scene import Scene
from solvers.scene.validation import field_key
from solvers.untrusted.size_limits import LIMITS

PAGE = Path(__file__).parent / "problem.md"
TABLE_POINTS, TABLE_TIMES = 41, 81  # of the table of the body force
FIRST_STEP = 0.1  # of the time in which a wave crosses a cell
QUARTERS = 4  # times of the exact solution per period by default


@dataclass(frozen=True, kw_only=True)
class ProblemCommand(SceneFlags):
    """Command ``mpm-lab problem``: flags of the scene, the directory, and times of the exact solution."""

    HELP: ClassVar[str] = """Write all that another code needs to run the {title}.

    {setting} The directory gets the initial particles (CSV and VTU), the body force as a table in space and time, the
    exact solution at the times asked for, in the form that `mpm-lab judge` reads, and a page of text with the formulas.
    Exit status: 0 ok, 1 could not write, 2 bad input."""
    EXAMPLE: ClassVar[str] = "mpm-lab problem {problem} --cells 40 --out handout"
    LEFT_OUT: ClassVar[frozenset[str]] = METHOD_FIELDS

    out: Annotated[PathFlag, default_hint("none, it must be given")] = None
    """Directory for the files; it must be new or empty."""
    times: Annotated[NamesFlag, default_hint("each quarter of a period up to the end")] = ()
    """Times of the exact solution, s."""

    def execute(self) -> int:
        scene = self.scene()
        quarters = max(1, min(LIMITS.times, round(QUARTERS * scene.end_time / scene.period)))
        times = sorted(set(parse_times(self.times, "times"))) or \
            [k * scene.period / QUARTERS for k in range(1, quarters + 1)]
        if len(times) > LIMITS.times or len(times) * scene.particles > LIMITS.rows:
            raise BadInput("times", f"{len(times)} times", f"make {len(times) * scene.particles:,} rows; at most "
                           f"{LIMITS.rows:,} are allowed, of at most {LIMITS.times:,} times")
        folder = OutputFolder(self.out)
        for name, content in _handout_files(scene, times).items():
            folder.write_file(name, content)
        print_message(f"{folder.text}: begin with problem.md")
        return 0


def _handout_files(scene: Scene, times: list[float]) -> dict[str, bytes]:
    """Returns the contents of the files for another code, by name; ``times`` of the exact solution are in s."""
    from solvers.judging import particle_writers, problem_handout  # here: bad input must not wait for them
    start, first = problem_handout.start(scene), problem_handout.initial_frame(scene)
    more = {"volume": start.volume, "mass": problem_handout.particle_masses(scene), **start.more}
    force = problem_handout.body_force_table(scene, TABLE_POINTS, TABLE_TIMES)
    said: dict[str, Any] = {"problem": scene.problem, "cells": scene.cells, "ppc": scene.ppc}
    data = {"id": first.number, "material_position": _pad_to_3d(first.material_position),
            "velocity": _pad_to_3d(np.asarray(first.velocity)), **more}
    solution = [problem_handout.exact_frame(scene, t) for t in times] if scene.solution_known else \
        problem_handout.companion_frames(scene, times)
    numbers, name = problem_handout.problem_parameters(scene), "exact" if scene.solution_known else "companion"
    return {
        "particles.csv": particle_writers.csv_text(particle_writers.frame_columns([first], more), {**said, "t": 0.0}),
        "particles.vtu": particle_writers.vtu_bytes(first.position, data, 0.0),
        "body_force.csv": particle_writers.csv_text(force, {"problem": scene.problem}),
        f"{name}.csv": particle_writers.csv_text(particle_writers.frame_columns(solution), said),
        "problem.json": json_text({"schema": problem_handout.SCHEMA, **numbers}, lines=True).encode(),
        "problem.md": problem_page(scene, PROBLEMS[scene.problem].reference.texts(scene), times, name).encode()}


def _pad_to_3d(vectors: np.ndarray) -> np.ndarray:
    """Pads vectors (P, D) to three components, for VTK."""
    return np.pad(vectors, ((0, 0), (0, 3 - vectors.shape[1])))


def problem_page(scene: Scene, texts: ProblemDescription, times: Sequence[float], solution: str) -> str:
    """Returns a Markdown page on the problem, its files (the ``solution``'s at ``times``, s), and judging."""
    columns = {key: ", ".join(f"`{name}`" for name in output_column_names(key, scene.DIMENSIONS))
               for key in ("X", "x", "v", "F", "sigma")}
    period = "A period of the motion is" if scene.swings else f"Times are counted in periods of the {scene.TITLE},"
    known = "the exact solution" if scene.solution_known else \
        "a spectral-element solution of the same problem (companion), for none is known exactly,"
    # The flags of the problem for the judge: all inputs except those of methods and of the end.
    flags = (f"--{key.replace('_', '-')} {f'{value:.15g}' if isinstance(value, float) else value}"
             for key, value in scene.to_dict().items() if value is not None
             and key not in {"problem", "t_end", "periods", *map(field_key, METHOD_FIELDS)})
    return render_template(
        PAGE, **vars(texts), **columns, title=scene.title, problem=scene.problem, flags=" ".join(flags),
        solution=solution, known=known, times=len(times), cells=scene.cells, h=f"{scene.spacing:.6g}",
        per_cell=per_cell(scene.problem, scene.ppc), period_is=period, period=f"{scene.period:.15g}",
        wave_speed=f"{scene.wave_speed:.15g}", crossing=f"{scene.spacing / scene.wave_speed:.4g}",
        first_step=f"{FIRST_STEP * scene.spacing / scene.wave_speed:.4g}")
