"""``mpm-lab run bar``: one run without a page, to JSON, a picture or a table."""

from __future__ import annotations

import contextlib
import sys
import warnings
from dataclasses import dataclass, fields
from typing import Annotated

from app.commands.flags import (
    BadInput,
    NumberFlag,
    PathFlag,
    RealFlag,
    Switch,
    choice_flag,
    default_hint,
    list_flag,
)
from app.commands.output import Progress, Target, json_text, noted_interrupts, say, stdout_to_stderr
from solvers.bar.scene import BarScene
from solvers.scene import (
    DEFAULT_CFL,
    DEFAULT_PERIODS,
    EFFECTS,
    ESTIMATORS,
    FLAGS,
    SAMPLES_A_PERIOD,
    Arch,
    BodyForce,
    Method,
    PositionUpdate,
    Scene,
)

OK, FAILED, UNSTABLE = 0, 1, 3
SCENE_FIELDS = {key: field for field, key in FLAGS.items()}


@dataclass(frozen=True)
class RunBar:
    """Run the vibrating bar once and report its true and estimated errors.

    The bar is 1 m long. Without --json a table goes to standard output.
    Exit status: 0 ok, 1 could not run or write, 2 bad input, 3 the run went unstable.
    """

    method: choice_flag(Method) = BarScene.method
    """Shape functions of the particles."""
    cells: NumberFlag = BarScene.cells
    """Cells of the grid; h = 1 m / cells."""
    ppc: NumberFlag = BarScene.particles_per_cell
    """Particles per cell."""
    amplitude: RealFlag = BarScene.amplitude
    """Amplitude A of the displacement, m."""
    modulus: RealFlag = BarScene.modulus
    """Young's modulus E, Pa."""
    density: RealFlag = BarScene.density
    """Density, kg/m3."""
    dt: Annotated[RealFlag, default_hint("from --cfl")] = None
    """Time step, s; instead of --cfl."""
    cfl: Annotated[RealFlag, default_hint(f"{DEFAULT_CFL} without --dt")] = None
    """Time step as dt c/h, no unit, c = sqrt(E/density); instead of --dt."""
    t_end: Annotated[RealFlag, default_hint("from --periods")] = None
    """End of the run, s; instead of --periods."""
    periods: Annotated[RealFlag, default_hint(f"{DEFAULT_PERIODS:g} without --t-end")] = None
    """End of the run in periods of the vibration; instead of --t-end."""
    body_force: choice_flag(BodyForce) = BarScene.body_force
    """Where the body force is evaluated: at material points, at nodes, or nowhere."""
    linearity_preserving: bool = BarScene.linearity_preserving
    """Make the particle-grid transfers exact for linear fields."""
    velocity: choice_flag(PositionUpdate) = BarScene.velocity
    """Velocity that moves the particles (corners: cpgimp only)."""
    estimator: list_flag((*ESTIMATORS, "none")) = BarScene.estimators
    """Error estimators, one or several."""
    effects: Annotated[list_flag((*EFFECTS, "all", "none")), default_hint("all")] = EFFECTS
    """What to compute beside the method, with commas between; what is left out costs nothing."""
    arch: choice_flag(Arch) = BarScene.arch
    """Processor to run on."""
    threads: NumberFlag = BarScene.threads
    """Processor threads, at most."""
    sample_every: Annotated[NumberFlag, default_hint(f"about {SAMPLES_A_PERIOD} samples a period")] = None
    """Steps between two samples of the errors."""
    json: Annotated[PathFlag, default_hint("a table is printed instead")] = None
    """File for the result as a JSON object; - is standard output."""
    plot: Annotated[PathFlag, default_hint("no picture")] = None
    """File for a picture of the result, .png."""
    quiet: Annotated[Switch, default_hint("off")] = False
    """No progress bar and no remarks on standard error."""

    def scene(self) -> Scene:
        """The scene that the flags describe; ``Scene`` itself checks it."""
        values = {f.name: getattr(self, f.name) for f in fields(self)
                  if f.name not in ("json", "plot", "quiet")}
        values["estimator"] = _expand("estimator", self.estimator, {"none": ()})
        values["effects"] = _expand("effects", self.effects, {"none": (), "all": EFFECTS})
        return BarScene(**{SCENE_FIELDS.get(key, key): value for key, value in values.items()})

    def execute(self) -> int:
        """Run, then write what was asked for. Files are tried first, so that no run is lost to a typo."""
        scene = self.scene()
        json_target = None if self.json is None else Target("json", self.json, may_be_stdout=True)
        plot_target = None if self.plot is None else Target("plot", self.plot, ending=".png")
        if json_target and plot_target and json_target.path == plot_target.path:
            raise BadInput("plot", self.plot, "is the file of --json too; give each its own")
        with stdout_to_stderr():
            result = _run(scene, self.quiet)
        values = result.to_dict()
        if json_target:
            json_target.write(json_text(values, lines=not json_target.is_stdout).encode())
        else:
            from app.commands.table import run_table
            print(run_table(values), flush=True)
        drawn = plot_target is None or _draw(result, plot_target)
        if result.status != "ok":
            say(result.reason)
            return UNSTABLE
        return OK if drawn else FAILED


def _expand(flag: str, words: tuple[str, ...], special: dict[str, tuple[str, ...]]) -> tuple[str, ...]:
    """Words with the special ones, which must stand alone, replaced by what they mean."""
    if not words:
        raise BadInput(flag, "", "give one or several names (mpm-lab run bar --help lists them)")
    for word in words:
        if word in special:
            if len(words) > 1:
                raise BadInput(flag, " ".join(words), f"{word} stands alone; leave it or the others out")
            return special[word]
    return words


def _run(scene: Scene, quiet: bool):
    with noted_interrupts() as check_interrupts, contextlib.closing(Progress(sys.stderr, quiet)) as progress:
        warnings.simplefilter("ignore", SyntaxWarning)  # Taichi's source, on its first import by Python 3.12 on
        from solvers.run import run  # here: bad input and --help must not wait for Taichi

        def show(part: float) -> None:
            check_interrupts()
            progress.show(part)

        result = run(scene, on_progress=show)
    if scene.arch == "gpu" and result.arch in ("x64", "arm64") and not quiet:
        say(f"no GPU was found: this ran on the processor ({result.arch})")
    return result


def _draw(result, target: Target) -> bool:
    """Draw and write the picture; a failure is told and costs nothing else of the run."""
    try:
        from app.plots import png_bytes, run_figure
        target.write(png_bytes(run_figure(result)))
    except Exception as error:
        say(f"--plot {target.text}: the picture failed ({type(error).__name__}: {error}); the run is fine")
        return False
    return True
