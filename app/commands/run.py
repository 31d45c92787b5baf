"""What ``mpm-lab run bar`` and ``mpm-lab run ring`` share: one run without a page, to JSON, a picture or a table."""

from __future__ import annotations

import contextlib
import sys
import warnings
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

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
from solvers.scene import DEFAULT_CFL, EFFECTS, ESTIMATORS, FLAGS, Arch, Scene

if TYPE_CHECKING:
    from solvers.result import Result

OK, FAILED, UNSTABLE = 0, 1, 3
SCENE_FIELDS = {key: field for field, key in FLAGS.items()}


def periods_flag(scene: type[Scene]) -> Any:
    """The type of --periods, whose default is the problem's."""
    return Annotated[RealFlag, default_hint(f"{scene.DEFAULT_PERIODS:g} without --t-end")]


def sample_every_flag(scene: type[Scene]) -> Any:
    """The type of --sample-every, whose default is the problem's."""
    return Annotated[NumberFlag, default_hint(f"about {scene.SAMPLES_A_PERIOD} samples a period")]


@dataclass(frozen=True, kw_only=True)
class Run:
    """The flags of every problem, in the order of the help. A problem's command fills in the defaults.

    Every field but those in ``OUTPUT`` is an input of ``SCENE``, which checks it.
    """

    SCENE: ClassVar[type[Scene]]
    OUTPUT: ClassVar[frozenset[str]] = frozenset({"json", "plot", "quiet"})

    method: Any
    cells: NumberFlag
    ppc: NumberFlag
    amplitude: RealFlag
    modulus: RealFlag
    density: RealFlag
    dt: Annotated[RealFlag, default_hint("from --cfl")] = None
    """Time step, s; instead of --cfl."""
    cfl: Annotated[RealFlag, default_hint(f"{DEFAULT_CFL} without --dt")] = None
    """Time step as dt c/h, no unit, c = sqrt(E/density); instead of --dt."""
    t_end: Annotated[RealFlag, default_hint("from --periods")] = None
    """End of the run, s; instead of --periods."""
    periods: Any = None
    body_force: Any
    linearity_preserving: bool = False
    velocity: Any
    estimator: list_flag((*ESTIMATORS, "none")) = Scene.estimators
    """Error estimators, one or several."""
    effects: Annotated[list_flag((*EFFECTS, "all", "none")), default_hint("all")] = EFFECTS
    """What to compute beside the method, with commas between; what is left out costs nothing."""
    arch: choice_flag(Arch) = Scene.arch
    """Processor to run on."""
    threads: NumberFlag = Scene.threads
    """Processor threads, at most."""
    sample_every: Any = None
    json: Annotated[PathFlag, default_hint("a table is printed instead")] = None
    """File for the result as a JSON object; - is standard output."""
    plot: Annotated[PathFlag, default_hint("no picture")] = None
    """File for a picture of the result, .png."""
    quiet: Annotated[Switch, default_hint("off")] = False
    """No progress bar, no warnings and no remarks on standard error."""

    def scene(self) -> Scene:
        """The scene that the flags describe; the scene itself checks it."""
        values = {f.name: getattr(self, f.name) for f in fields(self) if f.name not in self.OUTPUT}
        values["estimator"] = _expand("estimator", self.estimator, {"none": ()})
        values["effects"] = _expand("effects", self.effects, {"none": (), "all": EFFECTS})
        return self.SCENE(**{SCENE_FIELDS.get(key, key): value for key, value in values.items()})

    def execute(self) -> int:
        """Run, then write what was asked for. Files are tried first, so that no run is lost to a typo."""
        scene = self.scene()
        json_target = None if self.json is None else Target("json", self.json, may_be_stdout=True)
        plot_target = None if self.plot is None else Target("plot", self.plot, ending=".png")
        if json_target and plot_target and json_target.path == plot_target.path:
            raise BadInput("plot", self.plot, "is the file of --json too; give each its own")
        if not self.quiet:
            _warn(scene)
        with stdout_to_stderr():
            result = _run(scene, self.quiet)
        _report(result, json_target)
        drawn = plot_target is None or _draw(result, plot_target)
        if result.status != "ok":
            say(result.reason)
            return UNSTABLE
        return OK if drawn else FAILED


def _expand(flag: str, words: tuple[str, ...], special: dict[str, tuple[str, ...]]) -> tuple[str, ...]:
    """Words with the special ones, which must stand alone, replaced by what they mean."""
    if not words:
        raise BadInput(flag, "", "give one or several names (--help lists them)")
    for word in words:
        if word in special:
            if len(words) > 1:
                raise BadInput(flag, " ".join(words), f"{word} stands alone; leave it or the others out")
            return special[word]
    return words


def _warn(scene: Scene) -> None:
    """Say what is allowed but will surprise, before the run starts."""
    for sentence in scene.warnings():
        say(f"warning: {sentence}")


def _run(scene: Scene, quiet: bool) -> Result:
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


def _report(result: Result, json_target: Target | None) -> None:
    """The result as JSON, or as a table on standard output."""
    values = result.to_dict()
    if json_target:
        json_target.write(json_text(values, lines=not json_target.is_stdout).encode())
    else:
        from app.commands.table import run_table
        print(run_table(values), flush=True)


def _draw(result: Result, target: Target) -> bool:
    """Draw and write the picture; a failure is told and costs nothing else of the run."""
    try:
        from app.plots import png_bytes, run_figure
        target.write(png_bytes(run_figure(result)))
    except Exception as error:
        say(f"--plot {target.text}: the picture failed ({type(error).__name__}: {error}); the run is fine")
        return False
    return True
