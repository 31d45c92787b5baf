"""``mpm-lab run FILE.toml`` and ``mpm-lab body list|show``: bodies without an exact solution, from files."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import tyro

from app.commands.lenient_flag_types import BadInput, PathFlag, Switch, TextFlag, default_hint
from app.commands.output import json_and_plot_targets, print_message, put_result, put_text
from app.commands.progress import show_progress
from app.commands.run.command import BROKEN, OK
from app.commands.run.text_summary import format_value
from solvers.bodies import body_file
from solvers.bodies.body import Body
from solvers.bodies.rectangle import check_estimator
from solvers.scene.estimator_registry import COMPANION
from solvers.scene.validation import SceneError
from solvers.untrusted.quoting import file_name, one_line, suggest_word

MEANING = """delta: what the two companions differ by, over what they find; below 0.3 the number stands, below 0.6 it
may be 30 % off, from 0.6 on there is none (assets/body.md)"""


@dataclass(frozen=True)
class BodyList:
    """List the bodies that come along: name and first line of the file.

    Exit status: 0 ok."""

    EXAMPLE: ClassVar[str] = "mpm-lab body list"

    def execute(self) -> int:
        names = body_file.library_names()
        for name in names:
            about = body_file.library_text(name).partition("\n")[0].lstrip("# ")
            put_text(f"{name:<{max(map(len, names))}}  {about}\n")
        return OK


@dataclass(frozen=True)
class BodyShow:
    """Print the file of a body that comes along.

    Save it, change it, and run it with mpm-lab run FILE.toml. Exit status: 0 ok, 2 bad input."""

    EXAMPLE: ClassVar[str] = "mpm-lab body show cantilever"

    name: Annotated[TextFlag, tyro.conf.Positional] = ""
    """Name of the body."""

    def execute(self) -> int:
        names = body_file.library_names()
        if self.name not in names:
            unknown = f"is not known{suggest_word(self.name, names)}; " if self.name else ""
            raise BadInput("", self.name, f"{unknown}give one of {', '.join(names)}")
        put_text(body_file.library_text(self.name))
        return OK


@dataclass(frozen=True)
class RunBody:
    """Run the body of a file, whose exact solution nobody knows, and estimate its errors.

    It must be elastic; patches, loads, method and goals are in the file (mpm-lab body show NAME prints one). Two
    companions of orders 4 and 6 give the estimates, and error bars of the goals. Without --json a table goes to
    standard output. A rectangle can have a second estimate beside it (--estimator recovered).
    Exit status: 0 ok, 1 could not run or write, 2 bad input, 3 the run went unstable."""

    EXAMPLE: ClassVar[str] = "mpm-lab run FILE.toml"

    file: Annotated[TextFlag, tyro.conf.Positional, tyro.conf.arg(name="FILE")] = ""
    """File of the body, .toml."""
    json: Annotated[PathFlag, default_hint("a table is printed instead")] = None
    """File for the result as a JSON object; - is standard output."""
    plot: Annotated[PathFlag, default_hint("no picture")] = None
    """File for a picture of the goals over time in the bands of their bars, .png."""
    estimator: TextFlag = COMPANION
    """recovered: also an estimate from the particles alone, for a rectangle with free and clamped sides."""
    quiet: Annotated[Switch, default_hint("off")] = False
    """No progress bar and no warnings on standard error."""

    def execute(self) -> int:
        target, picture = json_and_plot_targets(self.json, self.plot)
        body = read_body_file(self.file)
        check_estimator(body, self.estimator)
        for sentence in () if self.quiet else body.warnings():
            print_message(f"warning: {sentence}")
        with show_progress(self.quiet) as show:
            from solvers.bodies.run import run_body  # here: bad input and --help must not wait for Taichi
            try:
                result = run_body(body, show, self.estimator)
            except SceneError as error:  # a force that changes too fast
                raise BadInput("", self.file, str(error)) from None
        put_result(result.to_dict(), target, lambda values: body_table(file_name(self.file), values))
        if picture:
            from app.pictures.body_goals import goals_figure
            from app.pictures.run_errors import png_bytes
            picture.write(png_bytes(goals_figure(result, file_name(self.file))))
        if result.reason:
            print_message(result.reason)
        return OK if result.status == "ok" else BROKEN


def read_body_file(path: str) -> Body:
    """Returns the body of a file; raises FileError, or BadInput for a body that cannot be run."""
    try:
        return body_file.read_body(path)
    except SceneError as error:
        raise BadInput("", path, str(error)) from None


def body_table(name: str, result: Mapping[str, Any]) -> str:
    """Returns the text for the JSON object of a body's run, from the file ``name``."""
    body, spent = result["body"], result["seconds"]
    parts = [f"{name}: {body['method']}, {body['cells_per_metre']:g} cells per metre, {body['ppc']} x {body['ppc']} "
             f"particles per cell ({result['particles']:,})\n{result['status']}: {result['steps']:,} steps to t = "
             f"{result['t']:.6g} s"]
    if result["estimate"]:
        until = "" if result["estimated_until"] == result["t"] else f" to t = {result['estimated_until']:.4g} s"
        summary = ("final", "max", "mean")
        rows = [("estimated error, RMS" + until, *summary, "delta", ""),
                *((f"{quantity} ({one['unit']})", *(format_value(one[key], ".3e") for key in summary),
                   format_value(one["delta"], ".2f"), "+- 30 %" if one["trust"] == "30 %" else "")
                  for quantity, one in result["estimate"].items())]
        parts.append("\n".join((f"{row[0]:<32}" + "".join(f"{cell:>11}" for cell in row[1:])).rstrip() for row in rows))
        parts.append(MEANING)
    if recovered := result["recovered"]:
        parts.append(recovered["not_valid"] or "\n".join(
            f"recovered, {name} ({recovered[name]['unit']})".ljust(32) + "".join(
                f"{format_value(recovered[name][key], '.3e'):>11}" for key in ("final", "max", "mean"))
            for name in recovered if name != "not_valid"))
    if result["goals"]:
        parts.append("\n".join(_goal_line(goal, body["goals"][goal], value) for goal, value in result["goals"].items()))
    parts += map(one_line, result["remarks"])
    companions = result["companion"]
    parts.append(f"companions: orders {companions['orders'][0]} and {companions['orders'][1]} on "
                 f"{companions['elements']} elements\ntime: {spent['run']:.3g} s; companions "
                 f"{spent['companions']:.3g} s; and {spent['compile']:.3g} s to compile")
    return "\n\n".join(parts)


def _goal_line(name: str, goal: Mapping[str, Any], found: Mapping[str, Any]) -> str:
    value, bar = found["value"], found["bar"]
    said = "not reached by the end" if value is None else f"{value:.6g} (no bar) {found['unit']}" if bar is None else \
        f"{value_and_bar(value, bar)} {found['unit']}"
    return f"{name:<16} {said}   {goal['value']} at ({goal['at'][0]:g}, {goal['at'][1]:g})"


def value_and_bar(value: float, bar: float) -> str:
    """Formats a value and its error bar in one unit, both to the second digit of the bar: -1.3150 +- 0.0020."""
    places = 1 - math.floor(math.log10(bar)) if 0 < bar < math.inf else 6
    return " +- ".join(f"{round(number, places):,.{max(0, places)}f}" for number in (value, bar))
