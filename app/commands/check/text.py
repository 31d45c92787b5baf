"""The report of ``mpm-lab check`` in Markdown, made from the JSON object."""

from pathlib import Path
from typing import Any

from app.templates import rendered
from app.words import NOTHING, with_unit
from solvers.outside.quoting import code, file_name, markdown
from solvers.study.markdown import grid

HERE = Path(__file__).parent
CAPTION = "The particles at the moment of the first contradiction, or at the last one: how far each is from a plane " \
          "through its neighbours, and those that were named"
NO_CONTRADICTION = "No contradiction was found. That is not to say that the run is right."


def summary(values: dict) -> str:
    """The verdict, what was found wrong, and what could not be told."""
    lines = [*map(markdown, values["not_told"]), *values["never_told"]]
    return "\n\n".join([_verdict(values), *([_wrong(values)] if _wrong(values) else []),
                        "What could not be told:\n\n" + "\n".join(f"* {line}" for line in lines)])


def as_markdown(values: dict, pictures: list[str]) -> str:
    """The whole report; pictures stand after the summary."""
    files, count = values["files"], len(values["files"])
    notes = ["\n".join(f"* {markdown(note)}" for note in values["notes"])] if values["notes"] else []
    listed = ", ".join(code(file_name(file)) for file in files[:20]) + f" and {count - 20} more" * (count > 20)
    rows = [[one["finding"], _size(one["measured"], one["unit"]), _size(one["limit"], one["unit"]), one["verdict"],
             markdown(one["says"]) or NOTHING] for one in values["findings"]]
    looked = "## What was looked at\n\n" + grid(["looked at", "measured", "limit", "verdict", "remark"], rows,
                                                words=("looked at", "verdict", "remark"))
    shown = [f"![{CAPTION}]({name})" for name in pictures]
    return "\n\n".join([f"# {count} file{'s' * (count != 1)} checked: {values['verdict']}", summary(values), *shown,
                        looked, *notes, f"Files: {listed}.", rendered(HERE / "how.md")])


def _verdict(values: dict) -> str:
    times = values["times"]
    what = (f"{values['particles']:,} particles in {('one', 'two', 'three')[values['dimensions'] - 1]} "
            f"direction{'s' * (values['dimensions'] != 1)} at {len(times)} moments, t = {times[0]:.4g} to "
            f"{times[-1]:.4g} s, with {', '.join(values['quantities'])}; counted from {values['reference']}")
    said = {"consistent": NO_CONTRADICTION, "suspicious": "What stands below should not be in a sound run.",
            "broken": "What stands below cannot be in a sound run."}[values["verdict"]]
    return f"**Verdict: {values['verdict']}.** {said} ({what}.)"


def _wrong(values: dict) -> str:
    order = {"broken": 0, "suspicious": 1}
    found = sorted((one for one in values["findings"] if one["verdict"] in order),
                   key=lambda one: order[one["verdict"]])
    lines = []
    for one in found:
        where = f" at X = {', '.join(f'{c:.4g}' for c in one['X'])}" if one["X"] else ""
        place = "" if one["particle"] is None else f" (particle {one['particle']}{where})"
        lines.append(f"* **{one['verdict'].capitalize()}**, {one['finding']}: {markdown(one['says'])}{place}.")
    return "\n".join(lines)


def _size(value: Any, unit: str) -> str:
    if value is None:
        return NOTHING
    return with_unit(value, unit) if unit in ("m", "m/s", "Pa", "s") else f"{value:.3g} {unit}".strip()
