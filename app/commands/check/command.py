"""``mpm-lab check FILES...``: what within the particles of any run contradicts itself."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import tyro

from app.commands.expected import Expectable
from app.commands.flags import (
    BadInput,
    ClaimsFlag,
    FilesFlag,
    NamesFlag,
    PathFlag,
    Switch,
    default_hint,
    look_for,
    require_files,
    times_for,
)
from app.commands.output import Folder, json_target, json_text, put_report, put_text
from app.commands.progress import working
from solvers.outside.quoting import FileError

CONTRADICTED = 3
EXPECTABLE = Expectable("run", dict.fromkeys(("contradictions", "broken", "suspicious", "particles"), ()))


@dataclass(frozen=True)
class Check:
    """Look through the particles of any run for what contradicts itself, without a problem or a solution.

    FILES are .csv, .npz, .vtk, .vtu or .vtp with the particles of one run at two or more moments: positions x, and X or
    id, v, F, stress, mass and volume as there are. That no contradiction was found does not mean that the run is right.
    Exit status: 0 no contradiction found, 1 not as expected or could not write, 2 bad input, 3 suspicious or broken
    (with --expect the claims alone decide).
    """

    EXAMPLE: ClassVar[str] = "mpm-lab check mine-*.vtu --out checked"

    files: Annotated[FilesFlag, tyro.conf.Positional, tyro.conf.arg(metavar="FILES")] = ()
    """Files of particles."""
    time: Annotated[NamesFlag, default_hint("the files say it")] = ()
    """Time of each file, s, in their order, where they do not say it."""
    out: Annotated[PathFlag, default_hint("the report is printed only")] = None
    """Directory for report.md, report.html, report.json and a picture; it must be new or empty."""
    json: Annotated[PathFlag, default_hint("none")] = None
    """File for the report as a JSON object; - is standard output, in place of the text."""
    expect: ClaimsFlag = ()
    """A claim such as "contradictions == 0" or "broken == 0"; one that does not hold is exit status 1."""
    quiet: Annotated[Switch, default_hint("off")] = False
    """No progress bar and no report on standard output."""

    def execute(self) -> int:
        require_files(self.files)
        times = times_for(self.files, self.time)
        EXPECTABLE.check(self.expect)
        look_for(self.files)
        target = json_target(self.json)
        folder = None if self.out is None else Folder(self.out)
        try:
            with working(self.quiet) as show:
                from solvers.judging.check import check  # here: bad input must not wait for it
                checked = check(self.files, times=times, on_progress=show)
        except FileError as error:
            raise BadInput("", error.file, error.sentence) from None
        values = checked.to_dict()
        status = self._write(folder, checked, values)
        if target:
            target.write(json_text(values, lines=not target.is_stdout).encode())
        if self.expect:
            return max(status, EXPECTABLE.told(self.expect, [outcome(values)]))
        return status or (CONTRADICTED if checked.wrong else 0)

    def _write(self, folder: Folder | None, checked: Any, values: dict) -> int:
        """The report where it was asked for."""
        from app.commands.check.text import as_markdown, summary

        if not self.quiet and self.json != "-":
            put_text(summary(values) + "\n")
        if folder is None:
            return 0
        from app.pictures.check import FIGURES
        return put_report(folder, values, checked, FIGURES, lambda drawn: as_markdown(values, drawn))


def outcome(values: Mapping[str, Any]) -> dict[str, Any]:
    """The report in the shape that claims are about."""
    count = {word: sum(one["verdict"] == word for one in values["findings"]) for word in ("broken", "suspicious")}
    return {"contradictions": values["contradictions"], "particles": values["particles"], **count}
