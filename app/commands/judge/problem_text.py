"""The page of text of ``mpm-lab problem``, in Markdown."""

from collections.abc import Sequence

from app.words import per_cell, title
from solvers.judging.columns import column_names
from solvers.problems.reference import OF_METHODS, Texts
from solvers.scene.rules import field_key
from solvers.scene.scene import Scene
from solvers.study.markdown import grid


def page(scene: Scene, texts: Texts, times: Sequence[float], solution: str) -> str:
    """What the problem is, what each file holds, and how to be judged."""
    D = scene.DIMENSIONS
    period = "A period of the motion is" if scene.swings else "Times are counted in periods of the vibrating bar,"
    columns = {key: ", ".join(f"`{name}`" for name in column_names(key, D)) for key in ("X", "x", "v", "F", "sigma")}
    known = "the exact solution" if scene.solution_known else \
        "a spectral-element solution of the same problem (companion), for none is known exactly,"
    files = grid(("file", "what is in it"), [
        ("`particles.csv`, `particles.vtu`", f"particles of the {title(scene)} at $t = 0$: id, material position and "
                                             "position, velocity, F, volume and mass (of a thickness of 1 m)"),
        ("`body_force.csv`", f"the body force per mass in m/s² over two periods. {texts.table}"),
        (f"`{solution}.csv`", f"{known} at {len(times)} times at the same particles, in the form that the judge reads"),
        ("`problem.json`", "the numbers of this page, for programs")], words=("file", "what is in it"))
    reading = grid(("columns", "what"), [
        ("`t`", "time in s; or `# t = ...` above the names of a .csv, `t` in a .npz, `TimeValue` in VTK's field data, "
         "or the flag `--time`"),
        (f"`id` or {columns['X']}", "which particle it is: its number in `particles.csv`, or its material position in "
                                    "m"),
        (columns["x"], "position in m; in VTK's formats the points"),
        (columns["v"], "velocity in m/s, if there is one"),
        (f"{columns['F']} or {columns['sigma']}", "deformation gradient, or Cauchy stress in Pa, if there is one")],
        words=("columns", "what"))
    sections = {
        "The body": texts.body, "Material": texts.material, "Body force": texts.force, "Boundary": texts.boundary,
        "Start": texts.start, "Exact solution": texts.exact,
        "Grid and particles": f"The particles in these files are those of a grid of {scene.cells} cells, h = "
        f"{scene.spacing:.6g} m, with {per_cell(scene.problem, scene.ppc)} in a cell. Any others will do: give their "
        f"material positions. {period} {scene.period:.15g} s, the wave speed "
        f"{scene.wave_speed:.15g} m/s, so that a wave takes {scene.spacing / scene.wave_speed:.4g} s through a cell.",
        "Files": files,
        "To be judged": "Write particles at one or many times as CSV, NPZ (arrays of (P, ...), or (T, P, ...) with "
                        "`t`), VTK, "
        f"VTU or VTP, in one file or many, and give them to\n\n    mpm-lab judge {scene.problem} FILES... "
        f"{_flags(scene)} --out verdict\n\n{reading}\n\n`{solution}.csv` is such a file."}
    body = "\n\n".join(f"## {head}\n\n{text}" for head, text in sections.items())
    return f"# The {title(scene)}, for any code\n\nIn SI units: metres, seconds, kilograms, pascals.\n\n{body}\n"


def _flags(scene: Scene) -> str:
    """What says the problem to the judge: every input but those of methods and of the end."""
    said = {key: value for key, value in scene.to_dict().items() if value is not None}
    return " ".join(f"--{key.replace('_', '-')} {f'{value:.15g}' if isinstance(value, float) else value}"
                    for key, value in said.items()
                    if key not in {"problem", "t_end", "periods", *map(field_key, OF_METHODS)})
