"""``mpm-lab judge PROBLEM FILES...``: errors of any code's particles, and the report in Markdown."""

from collections.abc import Mapping
from dataclasses import dataclass
from operator import itemgetter
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import numpy as np
import tyro

from app import names_and_units
from app.commands import lenient_flag_types
from app.commands.check.contradiction_check import unread_columns_text
from app.commands.expect_flag import ClaimChecker
from app.commands.output import OutputFolder, put_report, put_text
from app.commands.progress import show_progress
from app.commands.scene_flags import SceneFlags
from app.lessons.claims import NORMS
from app.names_and_units import NOTHING, QUANTITIES, format_ratio, method_name, motion_text, with_unit
from app.problems.views import VIEWS
from app.templates import render_template
from solvers.judging.error_norms import QUANTITIES as JUDGED
from solvers.judging.findings.amplitude_and_pace import AMPLITUDE
from solvers.judging.findings.finding import HOLDS, OFF
from solvers.judging.quantity_names import PLANES
from solvers.problems.judging_reference import METHOD_FIELDS
from solvers.study.markdown_tables import markdown_table
from solvers.untrusted.quoting import code_span, escape_markdown, file_name

if TYPE_CHECKING:
    from solvers.judging.judgement import Judgement  # which reads files of all kinds: --help must not wait for it

COMPANION = "companion"
#: Paths for ``--expect``: error.x.max of each grid, last(error.x.max) of the finest; order.x of the largest
#: errors over the common times of all grids; index.companion.x, the companion's estimate over the truth;
#: contradictions, the number of failed checks.
EXPECTABLE = ClaimChecker("grids", {
    "error": (JUDGED, NORMS), "order": (JUDGED,), "estimate": ((COMPANION,), JUDGED, NORMS),
    "index": ((COMPANION,), JUDGED), "distance": ((COMPANION,), JUDGED), "contradictions": (), "particles": (),
    "scene": (("cells",),)})


@dataclass(frozen=True, kw_only=True)
class Judge(SceneFlags):
    """Command ``mpm-lab judge``: flags of the scene, the files of particles, and the report."""

    HELP: ClassVar[str] = """Judge what any code's particles of the {title} get wrong, where and of which order.

    FILES are text (.csv, .txt, .dat), .npz or VTK's with particles at one or many times, of one grid or several:
    positions, id or material position, and velocity, F or stress as there are (`mpm-lab problem` says how, and writes
    one). The flags say what was run.
    Exit status: 0 judged, 1 not as expected or could not write, 2 bad input."""
    EXAMPLE: ClassVar[str] = "mpm-lab judge {problem} mine.csv --cells 40 --out verdict"
    LEFT_OUT: ClassVar[frozenset[str]] = METHOD_FIELDS - {"dt", "cfl"}

    files: Annotated[lenient_flag_types.FilesFlag, tyro.conf.Positional, tyro.conf.arg(metavar="FILES")] = ()
    """Files of particles."""
    time: Annotated[lenient_flag_types.NamesFlag, lenient_flag_types.default_hint("the files say it")] = ()
    """Time of each file, s, in their order, where they do not say it."""
    plane: Annotated[Any, lenient_flag_types.one_of(PLANES), lenient_flag_types.default_hint(PLANES[0])] = PLANES[0]
    """Directions of three that are those of a plane problem."""
    out: Annotated[lenient_flag_types.PathFlag, lenient_flag_types.default_hint("the summary is printed only")] = None
    """Directory for report.md, report.html, report.json and pictures; it must be new or empty."""
    no_compare: Annotated[lenient_flag_types.Switch, lenient_flag_types.default_hint("off")] = False
    """Run none of our own methods on the same grid beside."""
    expect: lenient_flag_types.ClaimsFlag = ()
    """A claim such as "order.x in 1.8..2.3" or "error.x.max < 1e-3"; one that does not hold is exit status 1."""
    quiet: Annotated[lenient_flag_types.Switch, lenient_flag_types.default_hint("off")] = False
    """No progress bar and no summary on standard output."""

    def execute(self) -> int:
        EXPECTABLE.validate_claims(self.expect)
        if self.plane not in PLANES:
            raise lenient_flag_types.BadInput("plane", self.plane, f"is none; give {' or '.join(PLANES)}")
        times = lenient_flag_types.parse_file_times(self.files, self.time)
        cells = self._cells()
        scene, *_ = (self.scene(cells=count) for count in cells)  # each validates itself
        folder = None if self.out is None else OutputFolder(self.out)
        with show_progress(self.quiet) as show:
            from solvers import judge  # here: bad input must not wait for it
            judged = judge(scene, self.files, cells=cells, times=times, plane=self.plane,
                           compare=not self.no_compare, on_progress=show)
        return self._write_reports(folder, judged)

    def _cells(self) -> list[Any]:
        """Returns the numbers of cells, one for all files or one for each; raises BadInput for another count."""
        given = self.inputs()["cells"]
        words = given.replace(",", " ").split() if isinstance(given, str) else []
        cells = [lenient_flag_types.parse_number_or_text([word]) for word in words] or [given]
        if len(cells) > 1 and len(cells) != len(self.files):
            raise lenient_flag_types.BadInput("cells", given, f"gives {len(cells)} grids for {len(self.files)} files; "
                                              "give one number for all or one for each")
        return cells

    def _write_reports(self, folder: OutputFolder | None, judged: Any) -> int:
        """Writes the summary, the reports if there is a folder, and whether claims hold; returns the exit status."""
        values, status = judged.to_dict(), 0
        if not self.quiet:
            put_text(judgement_text(values, judged) + "\n")
        if folder is not None:
            from app.pictures.judgement_and_check import FIGURES
            status = put_report(folder, values, judged, FIGURES, lambda drawn: as_markdown(values, judged, drawn))
        grids = grid_values_for_claims(values)
        words = {f"order.{q}": said for q, fit in (values["order"] or {}).items()
                 if fit and (said := fit["reason"] or fit["remark"])}
        return max(status, EXPECTABLE.report_claims(self.expect, grids, "cells" if len(grids) > 1 else "", words))


def grid_values_for_claims(values: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    """Returns each grid's part of the report with the keys that claims use, as those of a run's JSON object."""
    orders = values["order"] or {}
    return [{"scene": {"cells": grid["cells"], "estimator": [COMPANION]},
             "error": grid["error"], "estimate": grid["estimate"][COMPANION], "index": grid["estimate"]["index"],
             "distance": grid["estimate"]["distance"], "order": {q: (orders.get(q) or {}).get("order") for q in JUDGED},
             "contradictions": sum(one["verdict"] == OFF for one in grid["checks"]), "particles": grid["particles"]}
            for grid in values["grids"]]


CAPTIONS = {"norms.png": "Error norms over time: against the truth where there is one, and as the companion sees them",
            "space.png": "Where the error of x is, at the time at which it is largest",
            "order.png": "Largest errors over the cell size, beside our own methods"}
#: Inputs of some problems: keys, names and units.
OF_SOME = (("poisson_ratio", "Poisson's ratio", ""), ("frequency", "frequency B =", " 1/s"), ("law", "law", ""))
HERE = Path(__file__).parent


def judgement_text(values: dict, judged: "Judgement") -> str:
    """Returns a summary in Markdown of a judgement and its ``values`` for JSON: problem, errors, contradictions."""
    scene, asked = judged.scene, values["scene"]
    more = [f"{name} {asked[key]:{'' if key == 'law' else 'g'}}{unit}" for key, name, unit in OF_SOME if key in asked]
    files = sorted({file for g in values["grids"] for file in g["files"]})
    head = [f"# {scene.title.capitalize()}: {len(files)} file{'s' * (len(files) != 1)} judged",
            f"{values['problem'].capitalize()}: {motion_text(scene)}, E = {asked['modulus']:g} Pa, density "
            f"{asked['density']:g} kg/m³, {''.join(f'{one}, ' for one in more)}body force {asked['body_force']}, "
            f"{names_and_units.particles_per_cell(values['problem'], asked['ppc'])} unless files say which they are, "
            f"against the {values['against']}.", _largest_error_table(values, judged)]
    head += [_grid_verdict(g, values) for g in values["grids"]]
    if values["order"]:
        known = [f"{_order(fit)} of {QUANTITIES[q].symbol}"
                 + (f" ({said})" if (said := fit["reason"] or fit["remark"]) else "")
                 for q, fit in values["order"].items() if fit]
        head.append(f"**Order in h:** {', '.join(known) or 'none could be found'}.")
    head += unread_columns_text(list(dict.fromkeys(name for g in values["grids"] for name in g["not_read"])))
    return "\n\n".join(head)


def as_markdown(values: dict, judged: "Judgement", pictures: list[str]) -> str:
    """Returns the report in Markdown; pictures, names of files beside it, follow the summary."""
    shown = [f"![{CAPTIONS[name]}]({name})" for name in pictures]
    body = [_grid_section(g, values, several=len(values["grids"]) > 1) for g in values["grids"]]
    order = [_order_section(values)] if values["order"] else []
    return "\n\n".join([judgement_text(values, judged), *shown, *order, *body, render_template(HERE / "how.md")])


def _largest_error_table(values: dict, judged: "Judgement") -> str:
    heads = ["cells", "h", "particles", "times", *(f"largest {QUANTITIES[q].symbol}" for q in JUDGED), "of the motion"]
    rows = []
    for g, one in zip(values["grids"], judged.grids, strict=True):
        errors, times = _true_or_estimated_errors(g), g["times"]
        x = errors["x"]["max"]
        when = f"t = {times[0]:.4g} s" if len(times) == 1 else f"{len(times)}, {times[0]:.4g} to {times[-1]:.4g} s"
        rows.append([str(g["cells"]), with_unit(g["h"], "m"), f"{g['particles']:,}", when,
                     *(_format_size(errors[q]["max"], q) for q in JUDGED),
                     NOTHING if x is None else f"{100 * x / one.scene.size_of('x'):.3g} %"])
    return markdown_table(heads, rows, words=("times",))


def _true_or_estimated_errors(g: dict) -> dict:
    """Returns a grid's true errors by quantity, or else the companion's estimates: final, max, mean, in SI."""
    return g["error"] or g["estimate"]["companion"]


def _grid_verdict(g: dict, values: dict) -> str:
    """Returns sentences on a grid ``g`` of the report: its error, the ratio to our methods', and outliers."""
    from solvers.judging.judgement import BY_PLACE
    x = _true_or_estimated_errors(g)["x"]["max"]
    sentences = [f"**{g['cells']} cells:** the error of x is up to {_format_size(x, 'x')}." if any(g["times"]) else
                 f"**{g['cells']} cells: only the start was given, t = 0, and nothing that was computed.**"]
    ours = [(size, _full_method_name(run)) for run in g["ours"]
            if run["status"] == "ok" and (size := run["error"]["x"]["max"])]
    if ours and x is not None:
        (least, best), (most, worst) = min(ours, key=itemgetter(0)), max(ours, key=itemgetter(0))
        sentences.append(f"Of our methods on this grid {best} has the least, {_format_size(least, 'x')} (these "
                         f"particles: {format_ratio(x / least)} times), and {worst} the most, "
                         f"{_format_size(most, 'x')}.")
    sentences += [f"**{check['says'][:1].upper()}{check['says'][1:]}.**" for check in g["checks"]
                  if check["verdict"] == OFF and check["check"] != BY_PLACE]
    sentences += [f"{check['says'][:1].upper()}{check['says'][1:]}, beside other errors." for check in g["checks"]
                  if check["verdict"] == HOLDS and check["check"] == AMPLITUDE and check["says"]]
    if found := g["neighbour_gap"]:
        sentences.append(f"**{found['count']:,} particle{'s' * (found['count'] != 1)} ({100 * found['share']:.2g} %) "
                         f"{'are' if found['count'] != 1 else 'is'} not where the neighbours are**, by up to "
                         f"{found['farthest_over_h']:.2g} h, at t = {found['t']:.4g} s: the farthest is particle "
                         f"{found['particle']} at {_format_point(found['X'])}, "
                         f"{_region_name(values['problem'], found['X'])} "
                         f"({escape_markdown(file_name(found['file']))}).")
    return " ".join(sentences)


def _grid_section(g: dict, values: dict, several: bool) -> str:
    rows = [[str(QUANTITIES[q]), _format_size(found["size"], q), str(found["particle"]), _format_point(found["X"]),
             _region_name(values["problem"], found["X"]), f"{found['t']:.4g} s", code_span(file_name(found['file']))]
            for q, found in g["worst"].items() if found]
    worst = markdown_table(["error of", "size", "particle", "X", "where", "t", "file"], rows,
                           words=("error of", "where", "file"))
    parts = [f"## {g['cells']} cells" if several else "## Errors", _error_table(g),
             f"Worst of all particles and times:\n\n{worst}"]
    parts.append(f"At least {g['crossings_at_least']:,} grid crossings between the times given.")
    rows = [[check["check"], *(_format_number(check[key], ".3g") for key in ("measured", "tolerance")), check["unit"],
             check["verdict"], check["says"]] for check in g["checks"]]
    compared = markdown_table(["compared", "measured", "tolerance", "in", "verdict", "remark"], rows,
                              words=("compared", "in", "verdict", "remark"))
    parts.append(f"What was compared, with what tolerance:\n\n{compared}")
    if g["ours"]:
        parts += ["Our own methods on the same grid, at the same times:", _own_methods_table(g)]
    told = {check["says"] for check in g["checks"]}  # shown in the table and above
    if notes := [note for note in g["notes"] if note not in told]:
        parts.append("\n".join(f"* {escape_markdown(note)}" for note in notes))
    parts.append("Files: " + ", ".join(code_span(file_name(file)) for file in g["files"][:20])
                 + (f" and {len(g['files']) - 20} more" if len(g["files"]) > 20 else "") + ".")
    return "\n\n".join(parts)


def _error_table(g: dict) -> str:
    heads = ["error of", "final", "largest", "mean", "companion: largest", "index", "distance", "companion's own error"]
    estimate, unknown = g["estimate"], dict.fromkeys(("final", "max", "mean"))
    rows = [[str(QUANTITIES[q]), *(_format_size((g["error"] or {}).get(q, unknown)[part], q) for part in unknown),
             _format_size(estimate["companion"][q]["max"], q),
             *(_format_number((estimate[key] or {}).get(q), ".3f") for key in ("index", "distance")),
             _format_size(estimate["own_error"][q], q)] for q in JUDGED]
    return markdown_table(heads, rows, words=("error of",))


def _own_methods_table(g: dict) -> str:
    here = _true_or_estimated_errors(g)
    heads = ["method", *(f"largest {QUANTITIES[q].symbol}" for q in JUDGED),
             *(f"these over ours, {QUANTITIES[q].symbol}" for q in JUDGED), "ran"]
    rows = []
    for run in g["ours"]:
        theirs = run["error"]
        both = [(here[q]["max"], theirs[q]["max"]) for q in JUDGED]
        rows.append([_full_method_name(run), *(_format_size(theirs[q]["max"], q) for q in JUDGED),
                     *(NOTHING if one is None or not other else format_ratio(one / other) for one, other in both),
                     f"{run['status']}, cfl {run['cfl']:.3g}"])
    return markdown_table(heads, rows, words=("method", "ran"))


def _order_section(values: dict) -> str:
    common = values["common_times"]
    if not any(t > 0 for t in common):
        return "## Order in h\n\nThe grids have no time in common after the start, so that no order can be found."
    rows = [[str(QUANTITIES[q]), *([NOTHING] * 3 if fit is None else [
        _order(fit), ", ".join(f"{one:.2f}" for one in fit["pairwise"]), fit["reason"] or fit["remark"] or ""])]
            for q, fit in values["order"].items()]
    return (f"## Order in h\n\nOf the largest norm over the {len(common)} times that all {len(values['grids'])} grids "
            f"have.\n\n" + markdown_table(["error of", "order", "between neighbours", "remark"], rows,
                                          words=("error of", "remark")))


def _order(fit: Mapping[str, Any]) -> str:
    return "none" if fit["order"] is None else f"{fit['order']:.2f}"


def _full_method_name(run: dict) -> str:
    return method_name(run["method"]) + (", linearity preserving" if run["linearity_preserving"] else "")


def _format_point(X: list[float]) -> str:
    return "X = " + ", ".join(f"{c:.4f}" for c in X)


def _region_name(problem: str, X: list[float]) -> str:
    regions = VIEWS[problem].regions(np.array([X]))
    return regions.names[int(regions.number[0])]


def _format_size(value: Any, quantity: str) -> str:
    return NOTHING if value is None else f"{value:.3e} {QUANTITIES[quantity].unit}"


def _format_number(value: float | None, form: str) -> str:
    return NOTHING if value is None else format(value, form)
