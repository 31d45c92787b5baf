"""``mpm-lab run PROBLEM``: one run without a page, to JSON, a picture or a table."""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, ClassVar

import numpy as np
import tyro

from app import shareable_state
from app.commands.lenient_flag_types import BadInput, PathFlag, Switch, TextFlag, default_hint
from app.commands.output import OutputTarget, json_target, print_message, put_result
from app.commands.progress import show_progress
from app.commands.run.text_summary import goal_table, run_table
from app.commands.scene_flags import SceneFlags
from solvers.judging.particle_data_types import Frame
from solvers.running.quantities_of_interest import parse_goals
from solvers.running.result import Result
from solvers.scene.estimator_registry import require_corrector
from solvers.scene.scene import Scene
from solvers.solver.particle_snapshot import Snapshot
from solvers.untrusted.size_limits import LIMITS

OK, FAILED, BROKEN = 0, 1, 3
KINDS = (".npz", ".csv")  # suffixes of particle files
LETTERS = 21  # of a number in a .csv, with its separator


class ParticleWriter:
    """Writer of the file ``text`` of --particles for a scene's run, checked now; raises BadInput."""

    def __init__(self, text: str, scene: Scene):
        if Path(text).suffix.lower() not in KINDS:
            raise BadInput("particles", text, f"give a file that ends in {' or '.join(KINDS)}")
        samples = scene.steps // scene.sample_interval + 2
        # Columns of the judge's format: time, id, three vectors and a tensor.
        rows, width = scene.particles * samples, 2 + 3 * scene.DIMENSIONS + scene.DIMENSIONS**2
        in_bytes = LIMITS.bytes // (width * LETTERS) if text.lower().endswith(".csv") else LIMITS.rows
        most = min(LIMITS.rows, LIMITS.numbers // width, in_bytes)
        if rows > most or samples > LIMITS.times:
            raise BadInput("particles", text, f"would hold {rows:,} particles of {samples:,} samples; at most {most:,} "
                                              f"of {LIMITS.times:,} are allowed, as the judge reads them: sample more "
                                              "rarely with --sample-every")
        self._target, self._scene = OutputTarget("particles", text), scene
        self._frames: list[Frame] = []

    def add(self, shot: Snapshot) -> None:
        """Keeps the particles of a sample for the file, unless they have non-finite values."""
        from solvers.judging.reference_runs import frame_of_snapshot
        frame = frame_of_snapshot(shot, self._scene)
        if all(np.isfinite(v).all() for v in (shot.position, shot.velocity, shot.deformation_gradient)):
            self._frames.append(frame)

    def write(self, result: Result) -> None:
        """Writes the particles that were added, in a .npz with the result of their run."""
        from solvers.judging import particle_writers
        from solvers.running.scene_json_line import scene_line
        if self._target.path.lower().endswith(".npz"):
            content = particle_writers.npz_bytes(self._frames, self._scene, result.arrays())
        else:
            said = {"problem": self._scene.problem, "cells": self._scene.cells, "scene": scene_line(self._scene)}
            content = particle_writers.csv_text(particle_writers.frame_columns(self._frames), said)
        self._target.write(content)


@dataclass(frozen=True, kw_only=True)
class OutputFlags:
    """Flags for the output of a run, common to ``mpm-lab run PROBLEM`` and ``mpm-lab run --scene``."""

    json: Annotated[PathFlag, default_hint("a table is printed instead")] = None
    """File for the result as a JSON object; - is standard output."""
    plot: Annotated[PathFlag, default_hint("no picture")] = None
    """File for a picture of the result, .png."""
    particles: Annotated[PathFlag, default_hint("none")] = None
    """File for the particles at every sample, .npz or .csv, as mpm-lab judge reads them; .npz with the result."""
    goal: Annotated[tuple[str, ...], tyro.conf.UseAppendAction, tyro.conf.arg(
        metavar="NAME", help_behavior_hint="(default: none; may be given several times)")] = ()
    """A number of the end with its error bar: kinetic-energy, mean-stress, or displacement@X (displacement@X,Y in the
    plane) at the material point X, in m."""
    corrected: Annotated[TextFlag, tyro.conf.arg(metavar="NAME"), default_hint("none")] = ""
    """Estimator whose estimate is subtracted from the result: adds the error that is left of it. recovered, two-grid,
    or companion, whose result has no MPM left in it."""
    quiet: Annotated[Switch, default_hint("off")] = False
    """No progress bar, no warnings and no remarks on standard error."""

    def run_and_write(self, scene: Scene) -> int:
        """Runs a scene, writes the output and returns the exit status, 0, 1 or 3. Files are checked before the run."""
        if self.corrected:
            require_corrector(self.corrected, scene.choices("estimators"))
            if missing := [effect for effect in ("truth", "estimate") if effect not in scene.effects]:
                raise BadInput("corrected", self.corrected,
                               f"needs what --effects leaves out: {' and '.join(missing)}")
            scene = replace(scene, estimators=tuple(dict.fromkeys((*scene.estimators, self.corrected))))
        parse_goals(scene, self.goal)
        target = json_target(self.json)
        picture = None if self.plot is None else OutputTarget("plot", self.plot, ending=".png")
        if target and picture and target.path == picture.path:
            raise BadInput("plot", self.plot, "is the file of --json too; give each its own")
        writer = None if self.particles is None else ParticleWriter(self.particles, scene)
        for sentence in () if self.quiet else scene.warnings():
            print_message(f"warning: {sentence}")
        result = _run_and_try_cures(scene, self.quiet, writer, self.goal)
        if scene.arch == "gpu" and result.arch in ("x64", "arm64") and not self.quiet:
            why = "no GPU was found" if scene.prefers_gpu else f"the {scene.problem} is built for processors"
            print_message(f"{why}: this ran on the processor ({result.arch})")
        put_result(result.to_dict(), target, lambda values: run_table(values, self.corrected)
                   + goal_table(result))
        if writer:
            writer.write(result)
        drawn = picture is None or _draw(result, picture, self.corrected)
        if result.reason:
            print_message(result.reason)
        if result.status != "ok":
            return BROKEN
        return OK if drawn else FAILED


@dataclass(frozen=True, kw_only=True)
class Run(OutputFlags, SceneFlags):
    """Command ``mpm-lab run PROBLEM``: flags of the scene and of the output of its run."""

    HELP: ClassVar[str] = """Run the {title} once and report its true and estimated errors.

    {setting} Without --json a table goes to standard output.
    Exit status: 0 ok, 1 could not run or write, 2 bad input, 3 the run went unstable or is lost.
    """
    EXAMPLE: ClassVar[str] = "mpm-lab run {problem} --cells 80 --plot {problem}.png"

    def execute(self) -> int:
        return self.run_and_write(self.scene())


@dataclass(frozen=True, kw_only=True)
class RunFromSceneText(OutputFlags):
    """Run a scene that is given as a text, as a link to the page or a lesson has it.

    Such as "bar;method=mpm;cells=80"; what it says of the view and of a pinned run is left aside. Exit status: 0 ok,
    1 could not run or write, 2 bad input, 3 the run went unstable or is lost.
    """

    EXAMPLE: ClassVar[str] = 'mpm-lab run --scene "bar;method=mpm;cells=80"'

    text: Annotated[TextFlag, tyro.conf.Positional, tyro.conf.arg(metavar="TEXT")] = ""
    """The scene: a problem, and what differs from its defaults."""

    def execute(self) -> int:
        try:
            scene = shareable_state.parse_state(self.text.rpartition("#")[2]).scene  # a complete link is accepted too
        except shareable_state.StateError as error:
            raise BadInput("scene", self.text, str(error)) from None
        return self.run_and_write(scene)


def _run_and_try_cures(scene: Scene, quiet: bool, writer: ParticleWriter | None, goals: Sequence[str]) -> Result:
    """Returns the result of a scene's run; of a broken one after trials of what may help, which Ctrl-C ends."""
    with show_progress(quiet) as show:
        from solvers.running.cure_trials import try_cures
        from solvers.running.run import run  # here: bad input and --help must not wait for Taichi
        result = run(scene, on_progress=show, prices=True, on_sample=writer.add if writer else None, goals=goals)
    with suppress(KeyboardInterrupt), show_progress(quiet) as show:
        return try_cures(result, on_progress=lambda part, change: show(part, f"trying {change}"))
    return result


def _draw(result: Result, target: OutputTarget, corrected: str) -> bool:
    """Draws a run and writes it to the target as .png; prints a failure and returns False instead of raising it."""
    try:
        from app.pictures.run_errors import png_bytes, run_figure
        target.write(png_bytes(run_figure(result, corrected)))
    except Exception as error:
        print_message(f"--plot {target.text}: the picture failed ({type(error).__name__}: {error}); the run is fine")
        return False
    return True
