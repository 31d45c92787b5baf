"""``mpm-lab run PROBLEM``: one run without a page, to JSON, a picture or a table."""

from __future__ import annotations

import contextlib
import sys
import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, ClassVar

from app.commands.flags import BadInput, PathFlag, Switch, default_hint
from app.commands.output import Progress, Target, json_text, noted_interrupts, say, stdout_to_stderr
from solvers.scene import Scene

if TYPE_CHECKING:
    from solvers.result import Result

OK, FAILED, UNSTABLE = 0, 1, 3


@dataclass(frozen=True, kw_only=True)
class Run:
    """What is done with a scene, and where its result goes."""

    HELP: ClassVar[str] = """Run the {title} once and report its true and estimated errors.

    {setting} Without --json a table goes to standard output.
    Exit status: 0 ok, 1 could not run or write, 2 bad input, 3 the run went unstable.
    """
    OUTPUT: ClassVar[frozenset[str]] = frozenset({"json", "plot", "quiet"})

    json: Annotated[PathFlag, default_hint("a table is printed instead")] = None
    """File for the result as a JSON object; - is standard output."""
    plot: Annotated[PathFlag, default_hint("no picture")] = None
    """File for a picture of the result, .png."""
    quiet: Annotated[Switch, default_hint("off")] = False
    """No progress bar, no warnings and no remarks on standard error."""

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
        from app.commands.run_text import run_table
        print(run_table(values), flush=True)


def _draw(result: Result, target: Target) -> bool:
    """Draw and write the picture; a failure is told and costs nothing else of the run."""
    try:
        from app.pictures.run import png_bytes, run_figure
        target.write(png_bytes(run_figure(result)))
    except Exception as error:
        say(f"--plot {target.text}: the picture failed ({type(error).__name__}: {error}); the run is fine")
        return False
    return True
