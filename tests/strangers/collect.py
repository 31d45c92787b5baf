"""Write assets/strangers.md from what ``mpm-lab judge`` said of other codes' particles, and what they ran with.

    python tests/strangers/collect.py TITLE=VERDICT_DIR=INFO.json... > assets/strangers.md

VERDICT_DIR is the --out of ``mpm-lab judge``, INFO.json has the lines that the code's script printed, a grid each.
``tests/strangers/README.md`` has all commands.
"""

import json
import sys
from pathlib import Path

HEAD = """# Codes that we did not write

Back to the [README](../README.md). Each ran the bar that `mpm-lab problem bar` describes, and `mpm-lab judge bar`
judged its particles. The scripts are in `tests/strangers/`, this page is made by `collect.py` there.
"""


def section(title: str, verdict: Path, info: Path) -> str:
    """One code: what it ran with, and the errors of its grids beside those of ours."""
    report = json.loads((verdict / "report.json").read_text())
    ran = [json.loads(line) for line in info.read_text().splitlines() if line.startswith("{")]
    about = (Path(__file__).parent / f"{title}.md").read_text(encoding="utf-8").strip()
    scene = report["scene"]
    versions = ", ".join(f"{name} {value}" for name, value in ran[0].items() if name in ("torch", "warp"))
    lines = [f"## {ran[0]['code']} {ran[0]['version']}", about,
             f"With {versions}; A = {scene['amplitude']:g} m, E = {scene['modulus']:g} Pa, {scene['ppc']} particles "
             f"per cell, "
             f"{report['grids'][0]['times'][-1]:g} s, steps of " + ", ".join(f"{one['dt']:.3g} s" for one in ran) + ".",
             "| cells | x, of A | x (m) | v (m/s) | σ (Pa) | x over our uGIMP | over our B-spline | crossings |",
             "| ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |"]
    rows = []
    for grid in report["grids"]:
        error = {q: grid["error"][q]["max"] for q in ("x", "v", "sigma")}
        ours = {run["method"]: run["error"]["x"]["max"] for run in grid["ours"] if not run["linearity_preserving"]}
        rows.append([str(grid["cells"]), f"{100 * error['x'] / scene['amplitude']:.3g} %",
                     *("–" if value is None else f"{value:.3e}" for value in error.values()),
                     *(f"{error['x'] / ours[name]:.2f}" for name in ("ugimp", "bspline")),
                     f"{grid['crossings_at_least']:,}"])
    order = ", ".join(f"{q} {fit['order']:.2f}" for q, fit in report["order"].items() if fit)
    found = [f"* {grid['cells']} cells: {note}" for grid in report["grids"] for note in grid["notes"]]
    table = "\n".join(lines[3:] + [f"| {' | '.join(row)} |" for row in rows])
    return "\n\n".join([*lines[:3], table, f"Order in h: {order}.", *(["\n".join(found)] if found else [])])


def main(arguments: list[str]) -> None:
    parts = [section(title, Path(verdict), Path(info)) for title, verdict, info in (a.split("=") for a in arguments)]
    rest = (Path(__file__).parent / "others.md").read_text(encoding="utf-8").strip()
    print("\n\n".join([HEAD.strip(), *parts, rest]))


if __name__ == "__main__":
    main(sys.argv[1:])
