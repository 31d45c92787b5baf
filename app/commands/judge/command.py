"""``mpm-lab judge PROBLEM FILES...``: how wrong the particles of any code are."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import tyro

from app.commands import flags
from app.commands.expected import Expectable
from app.commands.output import Folder, put_report, put_text
from app.commands.progress import working
from app.commands.scene_flags import SceneFlags
from app.lessons.claims import NORMS
from solvers.judging.findings.finding import OFF
from solvers.judging.measure import QUANTITIES
from solvers.outside.file_error import FileError
from solvers.problems.reference import OF_METHODS

COMPANION = "companion"
#: What ``--expect`` may ask for: error.x.max of each grid, last(error.x.max) of the finest; order.x, of the largest
#: errors over the times that all grids have; index.companion.x, what the companion says over the truth; contradictions,
#: things that were compared and do not hold.
EXPECTABLE = Expectable("grids", {
    "error": (QUANTITIES, NORMS), "order": (QUANTITIES,), "estimate": ((COMPANION,), QUANTITIES, NORMS),
    "index": ((COMPANION,), QUANTITIES), "distance": ((COMPANION,), QUANTITIES), "contradictions": (), "particles": (),
    "scene": (("cells",),)})


@dataclass(frozen=True, kw_only=True)
class Judge(SceneFlags):
    """The files, and where the report goes."""

    HELP: ClassVar[str] = """Judge what any code's particles of the {title} get wrong, where and of which order.

    FILES are .csv, .npz, .vtk, .vtu or .vtp with particles at one or many times, of one grid or several: positions, id
    or material position, and velocity, F or stress as there are (`mpm-lab problem` says how, and writes one). The flags
    say what was run.
    Exit status: 0 judged, 1 not as expected or could not write, 2 bad input.
    """
    EXAMPLE: ClassVar[str] = "mpm-lab judge {problem} mine.csv --cells 40 --out verdict"
    LEFT_OUT: ClassVar[frozenset[str]] = OF_METHODS - {"dt", "cfl"}

    files: Annotated[flags.FilesFlag, tyro.conf.Positional, tyro.conf.arg(metavar="FILES")] = ()
    """Files of particles."""
    time: Annotated[flags.NamesFlag, flags.default_hint("the files say it")] = ()
    """Time of each file, s, in their order, where they do not say it."""
    out: Annotated[flags.PathFlag, flags.default_hint("the summary is printed only")] = None
    """Directory for report.md, report.html, report.json and pictures; it must be new or empty."""
    no_compare: Annotated[flags.Switch, flags.default_hint("off")] = False
    """Run none of our own methods on the same grid beside."""
    expect: flags.ClaimsFlag = ()
    """A claim such as "order.x in 1.8..2.3" or "error.x.max < 1e-3"; one that does not hold is exit status 1."""
    quiet: Annotated[flags.Switch, flags.default_hint("off")] = False
    """No progress bar and no summary on standard output."""

    def execute(self) -> int:
        EXPECTABLE.check(self.expect)
        times = flags.times_for(self.files, self.time)
        cells = self._cells()
        scene, *_ = (self.scene(cells=count) for count in cells)  # each says what is wrong with it
        folder = None if self.out is None else Folder(self.out)
        try:
            with working(self.quiet) as show:
                from solvers import judge  # here: bad input must not wait for it
                judged = judge(scene, self.files, cells=cells, times=times, compare=not self.no_compare,
                               on_progress=show)
        except FileError as error:
            raise flags.BadInput("", error.file, error.sentence) from None
        return self._write(folder, judged)

    def _cells(self) -> list[Any]:
        """Cells of the grid, one number for all files or one for each."""
        given = self.inputs()["cells"]
        words = given.replace(",", " ").split() if isinstance(given, str) else []
        cells = [flags.number([word]) for word in words] or [given]
        if len(cells) > 1 and len(cells) != len(self.files):
            raise flags.BadInput("cells", given, f"gives {len(cells)} grids for {len(self.files)} files; give one "
                                                 "number for all or one for each")
        return cells

    def _write(self, folder: Folder | None, judged: Any) -> int:
        """The summary, the report where it was asked for, and what came of the claims."""
        from app.commands.judge.text import as_markdown, summary

        values, status = judged.to_dict(), 0
        if not self.quiet:
            put_text(summary(values, judged) + "\n")
        if folder is not None:
            from app.pictures.judge import FIGURES
            status = put_report(folder, values, judged, FIGURES, lambda drawn: as_markdown(values, judged, drawn))
        grids = outcomes(values)
        return max(status, EXPECTABLE.told(self.expect, grids, "cells" if len(grids) > 1 else ""))


def outcomes(values: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    """Each grid's part of the report in the shape of a run's JSON object."""
    orders = values["order"] or {}
    return [{
        "scene": {"cells": grid["cells"], "estimator": [COMPANION]}, "error": grid["error"],
        "estimate": grid["estimate"][COMPANION], "index": grid["estimate"]["index"],
        "distance": grid["estimate"]["distance"],
        "order": {q: (orders.get(q) or {}).get("order") for q in QUANTITIES},
        "contradictions": sum(one["verdict"] == OFF for one in grid["checks"]), "particles": grid["particles"]}
        for grid in values["grids"]]
