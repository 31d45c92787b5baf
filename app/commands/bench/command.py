"""``mpm-lab bench``: speed of this machine; its tables are made only from the JSON object."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

import tyro

from app.commands.lenient_flag_types import NumberFlag, PathFlag, Switch, default_hint
from app.commands.output import json_target, put_result
from app.commands.progress import show_progress
from app.commands.run.text_summary import NOTHING, format_value
from solvers.scene.validation import require_number, require_whole

MOST_VISITORS, MOST_MINUTES = 200, 600


@dataclass(frozen=True)
class Bench:
    """Measure how fast this machine is, and what estimators and effects cost on it.

    One thread of the processor, in its own time; takes about a minute. Beside them stand rates of C++ that is compiled
    here. With --class, have so many visitors use the page on a server of this machine instead.
    Exit status: 0 ok, 1 could not run or write, 2 bad input."""

    EXAMPLE: ClassVar[str] = "mpm-lab bench --quick"
    GONE: ClassVar[dict[str, str]] = {"--history": "mpm-lab bench itself has the ratios to C++; --json keeps them",
                                      "--waits": "assets/speed.md keeps what it has measured",
                                      "--beside": "it went with --waits"}

    json: Annotated[PathFlag, default_hint("a table is printed instead")] = None
    """File for the result as a JSON object; - is standard output."""
    quick: Annotated[Switch, default_hint("off")] = False
    """Fewer sizes and turns: less time, more noise."""
    visitors: Annotated[NumberFlag, tyro.conf.arg(name="class", help_behavior_hint="(default: no class)")] = None
    """Visitors without a browser who come within five seconds and move sliders; says what each of them gets."""
    minutes: NumberFlag = 1
    """How long the class stays."""
    quiet: Annotated[Switch, default_hint("off")] = False
    """No progress bar on standard error."""

    def execute(self) -> int:
        target = json_target(self.json)
        if self.visitors is not None:
            require_whole("class", self.visitors, 1, MOST_VISITORS)
            require_number("minutes", self.minutes, 0, MOST_MINUTES)
        with show_progress(self.quiet) as show:  # imports here: bad input and --help must not wait for Taichi
            if self.visitors is None:
                from app.commands.bench.class_load import ITSELF
                from solvers.bench.all_benchmarks import run_benchmarks
                values, table = run_benchmarks(self.quick, (*ITSELF, "--version"), show), bench_table
            else:
                from app.commands.bench.class_load import ClassLoadSettings, class_load_table, run_class_load
                load = ClassLoadSettings(self.visitors, 60 * self.minutes)
                values, table = run_class_load(load, show), class_load_table
        put_result(values, target, table)
        return 0


def bench_table(values: dict, /) -> str:
    """Returns the text for the command's JSON object: rates, costs of estimators and effects, start-up times."""
    return "\n\n".join([
        _heading(values), _rate_table(values["rates"]), _gpu_table(values["gpu"]),
        _price_table("price of an estimator: time of a step with it over a bare one", values["estimators"]),
        _price_table("price of an effect: time of a step with it over one without", values["effects"]),
        _overhead_table(values["off"]), _cpp_table(values["limit"]), _startup_table(values["start"])])


def _heading(values: dict) -> str:
    machine = values["machine"]
    load = "" if machine["load"] is None else f", load {machine['load']:.1f}"
    return (f"{machine['system']} {machine['processor']}, {machine['cores']} cores{load}, Python {machine['python']}, "
            f"Taichi {machine['taichi']} on {values['arch']}\n"
            f"one thread, {values['precision']} precision, processor time; fastest turns, median ratios"
            f"{' (quick: few turns, more noise)' if values['quick'] else ''}; {values['seconds']:.0f} s in all")


def _rate_table(rates: list[dict]) -> str:
    lines = ["rate, million particle-steps per second, nothing but the method"]
    for problem in dict.fromkeys(row["problem"] for row in rates):
        rows = [row for row in rates if row["problem"] == problem]
        sizes = {row["cells"]: row["particles"] for row in rows}
        cells = {(row["method"], row["cells"]): row["rate"] for row in rows}
        lines.append(_table_row(problem, *(f"{n} cells" for n in sizes)))
        lines.append(_table_row("  particles", *(f"{n:,}" for n in sizes.values())))
        lines += [_table_row(f"  {method}", *(_format_rate(cells[method, n]) for n in sizes))
                  for method in dict.fromkeys(row["method"] for row in rows)]
    return "\n".join(lines)


def _gpu_table(gpu: dict) -> str:
    title = "rate on a GPU, million particle-steps per second of wall time, nothing but the method"
    if gpu["missing"]:
        return f"{title}: {gpu['missing']}"
    name = f", {gpu['name']}" if gpu["name"] else ""
    lines = [title, f"  {gpu['arch']}{name}; a copy moves {gpu['bandwidth']:.0f} GB/s",
             _table_row("", "particles", "GPU", "of the limit", "serial", "parallel")]
    lines += [_table_row(_scene_text(row), f"{row['particles']:,}", _format_rate(row["rates"]["gpu"]),
                         NOTHING if row["share"] is None else f"{100 * row['share']:.0f} %",
                         *(format_value(row["rates"][plan], ".1f") for plan in ("serial", "parallel")))
              for row in gpu["rows"]]
    return "\n".join([*lines, "  limit: what the memory allows, each particle's numbers moved once in each phase\n"
                      "  serial, parallel: the processor's plans, on one thread and on all"])


def _price_table(title: str, rows: list[dict]) -> str:
    lines = [title]
    for row in rows:
        lines.append(_table_row(f"{_scene_text(row)}: {row['name']}", format_value(row["ratio"], ".3f")))
        if row.get("not_valid"):
            lines.append(f"    {row['not_valid']}")
    return "\n".join(lines)


def _overhead_table(rows: list[dict]) -> str:
    lines = ["an effect that is off: time of a bare step over the method's phases with nothing optional",
             _table_row("", "ratio", "quartiles", "noise", "call", "stripped")]
    for row in rows:
        ratio, low, high = (format_value(row[name], ".3f") for name in ("ratio", "low", "high"))
        noise = NOTHING if row["same"] is None else f"{100 * abs(row['same'] - 1):.1f} %"
        lines.append(_table_row(_scene_text(row), ratio, f"{low}..{high}", noise, f"{1e3 * row['call']:.2f} ms",
                                f"{1e3 * row['call_stripped']:.2f} ms"))
    return "\n".join([*lines, "  noise: between two solvers of the same machine code; compiled apart, 1 to 3 %\n  "
                      "call: what a call costs however many steps it takes"])


def _cpp_table(problems: list[dict]) -> str:
    lines = ["our rate over that of hand-written C++, million particle-steps per second",
             _table_row("", "ratio", "quartiles", "ours", "C++")]
    for problem in problems:
        lines += [_table_row(_scene_text({"problem": problem["problem"], **row}),
                             f"{row['ratio']:.3f}", f"{row['low']:.3f}..{row['high']:.3f}",
                             _format_rate(row["rate"]), _format_rate(row["limit"])) for row in problem["cases"]]
        lines += [f"  {problem['problem']}: {problem['missing']}"] if problem["missing"] else []
    return "\n".join(lines)


def _startup_table(start: dict) -> str:
    title = "start, seconds of wall time"
    if start["failed"]:
        return f"{title}: could not be measured: {start['failed']}"
    lines = [title, _table_row("mpm-lab --version, from start to end", f"{start['command']:.2f}"),
             _table_row("import of the solvers and Taichi", f"{start['import']:.2f}"),
             _table_row("start of Taichi", f"{start['taichi']:.2f}"),
             _table_row("compiling the default scene", "cold", "warm")]
    lines += [_table_row(f"  {problem}", f"{cold:.2f}", f"{start['warm'][problem]:.2f}")
              for problem, cold in start["cold"].items()]
    return "\n".join([*lines, "  cold: with Taichi's cache of compiled kernels empty; in seconds of the processor"])


def _scene_text(row: dict) -> str:
    return f"  {row['problem']} {row['method']} {row['cells']}"


def _table_row(name: str, *cells: str) -> str:
    return f"{name:<40}" + "".join(f"{cell:>14}" for cell in cells)


def _format_rate(rate: float | None) -> str:
    return "unstable" if rate is None else f"{rate:.1f}"
