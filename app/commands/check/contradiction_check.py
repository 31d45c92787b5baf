"""``mpm-lab check FILES...``: contradictions within the particles of any run, and the report in Markdown."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, ClassVar

import tyro

from app.commands import lenient_flag_types
from app.commands.expect_flag import ClaimChecker
from app.commands.output import OutputFolder, json_target, json_text, put_report, put_text
from app.commands.progress import show_progress
from app.names_and_units import NOTHING, with_unit
from app.templates import render_template
from solvers.study.markdown_tables import markdown_table
from solvers.untrusted.quoting import code_span, escape_markdown, file_name

CONTRADICTED = 3
EXPECTABLE = ClaimChecker("run", dict.fromkeys(("contradictions", "broken", "suspicious", "particles"), ()))


@dataclass(frozen=True)
class ContradictionCheck:
    """Look through the particles of any run for what contradicts itself, without a problem or a solution.

    FILES are text (.csv, .txt, .dat), .npz or VTK's with the particles of one run at two or more moments: positions x,
    and X or id, v, F, stress, mass and volume as there are. That no contradiction was found does not mean that the run
    is right.
    Exit status: 0 no contradiction found, 1 not as expected or could not write, 2 bad input, 3 suspicious or broken
    (with --expect the claims alone decide)."""

    EXAMPLE: ClassVar[str] = "mpm-lab check mine-*.vtu --out checked"

    files: Annotated[lenient_flag_types.FilesFlag, tyro.conf.Positional, tyro.conf.arg(metavar="FILES")] = ()
    """Files of particles."""
    time: Annotated[lenient_flag_types.NamesFlag, lenient_flag_types.default_hint("the files say it")] = ()
    """Time of each file, s, in their order, where they do not say it."""
    out: Annotated[lenient_flag_types.PathFlag, lenient_flag_types.default_hint("the report is printed only")] = None
    """Directory for report.md, report.html, report.json and a picture; it must be new or empty."""
    json: Annotated[lenient_flag_types.PathFlag, lenient_flag_types.default_hint("none")] = None
    """File for the report as a JSON object; - is standard output, in place of the text."""
    expect: lenient_flag_types.ClaimsFlag = ()
    """A claim such as "contradictions == 0" or "broken == 0"; one that does not hold is exit status 1."""
    quiet: Annotated[lenient_flag_types.Switch, lenient_flag_types.default_hint("off")] = False
    """No progress bar and no report on standard output."""

    def execute(self) -> int:
        EXPECTABLE.validate_claims(self.expect)
        times = lenient_flag_types.parse_file_times(self.files, self.time)
        target = json_target(self.json)
        folder = None if self.out is None else OutputFolder(self.out)
        with show_progress(self.quiet) as show:
            from solvers.judging.check import check  # here: bad input must not wait for it
            checked = check(self.files, times=times, on_progress=show)
        values = checked.to_dict()
        status = self._write_reports(folder, checked, values)
        if target:
            target.write(json_text(values, lines=not target.is_stdout).encode())
        if self.expect:
            return max(status, EXPECTABLE.report_claims(self.expect, [values_for_claims(values)]))
        return status or (CONTRADICTED if checked.contradictions else 0)

    def _write_reports(self, folder: OutputFolder | None, checked: Any, values: dict) -> int:
        """Writes the requested reports of the check, and of its ``values`` for JSON; returns the exit status."""
        if not self.quiet and self.json != "-":
            put_text(verdict_text(values) + "\n")
        if folder is None:
            return 0
        from app.pictures.judgement_and_check import CHECKED
        return put_report(folder, values, checked, CHECKED, lambda drawn: as_markdown(values, drawn))


def values_for_claims(values: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the numbers that claims may name: contradictions, particles, broken and suspicious findings."""
    count = {word: sum(one["verdict"] == word for one in values["findings"]) for word in ("broken", "suspicious")}
    return {"contradictions": values["contradictions"], "particles": values["particles"], **count}


HERE = Path(__file__).parent
CAPTION = "The particles at the moment of the first contradiction, or at the last one: how far each is from a plane " \
          "through its neighbours, and those that were named"
NO_CONTRADICTION = "No contradiction was found. That is not to say that the run is right."


def verdict_text(values: dict) -> str:
    """Returns the verdict, the contradictions, and what could not be checked, in Markdown, from the JSON object."""
    lines = [*map(escape_markdown, values["not_told"]), *values["never_told"]]
    return "\n\n".join([_verdict_sentence(values), *([_findings_list(values)] if _findings_list(values) else []),
                        *unread_columns_text(values["not_read"]),
                        "What could not be told:\n\n" + "\n".join(f"* {line}" for line in lines)])


def unread_columns_text(names: Sequence[str]) -> list[str]:
    """Returns a paragraph of Markdown on the columns that were not read, [] if all were."""
    from solvers.judging.particle_data_types import list_names  # here: bad input must not wait for it
    return [f"Columns that were not read: {escape_markdown(list_names(names, 40))}."] if names else []


def as_markdown(values: dict, pictures: list[str]) -> str:
    """Returns the complete report in Markdown; pictures, files' names, follow the summary."""
    files, count = values["files"], len(values["files"])
    notes = ["\n".join(f"* {escape_markdown(note)}" for note in values["notes"])] if values["notes"] else []
    listed = ", ".join(code_span(file_name(file)) for file in files[:20]) + f" and {count - 20} more" * (count > 20)
    rows = [[one["finding"], _format_size(one["measured"], one["unit"]), _format_size(one["limit"], one["unit"]),
             one["verdict"], escape_markdown(one["says"]) or NOTHING] for one in values["findings"]]
    looked = "## What was looked at\n\n" + markdown_table(["looked at", "measured", "limit", "verdict", "remark"], rows,
                                                          words=("looked at", "verdict", "remark"))
    shown = [f"![{CAPTION}]({name})" for name in pictures]
    return "\n\n".join([f"# {count} file{'s' * (count != 1)} checked: {values['verdict']}", verdict_text(values),
                        *shown, looked, *notes, f"Files: {listed}.", render_template(HERE / "how.md")])


def _verdict_sentence(values: dict) -> str:
    times = values["times"]
    what = (f"{values['particles']:,} particles in {('one', 'two', 'three')[values['dimensions'] - 1]} "
            f"direction{'s' * (values['dimensions'] != 1)} at {len(times)} moments, t = {times[0]:.4g} to "
            f"{times[-1]:.4g} s, with {', '.join(values['quantities'])}; counted from {values['reference']}")
    said = {"consistent": NO_CONTRADICTION, "suspicious": "What stands below should not be in a sound run.",
            "broken": "What stands below cannot be in a sound run."}[values["verdict"]]
    return f"**Verdict: {values['verdict']}.** {said} ({what}.)"


def _findings_list(values: dict) -> str:
    order = {"broken": 0, "suspicious": 1}
    found = sorted((one for one in values["findings"] if one["verdict"] in order),
                   key=lambda one: order[one["verdict"]])
    lines = []
    for one in found:
        where = f" at X = {', '.join(f'{c:.4g}' for c in one['X'])}" if one["X"] else ""
        place = "" if one["particle"] is None else f" (particle {one['particle']}{where})"
        lines.append(f"* **{one['verdict'].capitalize()}**, {one['finding']}: {escape_markdown(one['says'])}{place}.")
    return "\n".join(lines)


def _format_size(value: Any, unit: str) -> str:
    if value is None:
        return NOTHING
    return with_unit(value, unit) if unit in ("m", "m/s", "Pa", "s") else f"{value:.3g} {unit}".strip()
