"""The notebooks of lessons/notebooks, each run as a reader runs it: every cell, in a kernel of its own."""

import re

import pytest

from tests.groups import require_group
from tests.support.paths import ROOT

NOTEBOOKS = ROOT / "lessons" / "notebooks"
#: What each prints that it also says in words, as a pattern with one number, and what the words promise of that.
CLAIMS = {
    "crossing": [(r"mpm +shares of the error of v: {'crossings': ([\d.-]+)", 0.85, 1.0),
                 (r"bspline +shares of the error of v: {'crossings': ([\d.-]+)", -0.05, 0.05)],
    "crossing_share": [(r"20 cells: .* (\d+) % by crossings", 40, 70), (r"40 cells: .* (\d+) % by crossings", 90, 99),
                       (r"80 cells: .* (\d+) % by crossings", 97, 100), (r"x: .* missed by ([\d.]+) %", 0, 15),
                       (r"v: .* missed by ([\d.]+) %", 0, 15), (r"index ([\d.]+) to", 0.9, 1.1),
                       (r" to ([\d.]+)\n", 0.9, 1.1)],
    "judged": [(r"order of x: ([\d.]+)", 1.9, 2.1),
               (r"does not hold +times against the motion: .* multiplied by ([\d.]+)", 0.94, 0.96)],
}
PLAYERS = {"crossing": 1, "crossing_share": 0, "judged": 1}
PICTURES = {"crossing": 1, "crossing_share": 1, "judged": 1}


def test_every_notebook_is_run():
    assert {path.stem for path in NOTEBOOKS.iterdir()} == set(CLAIMS)


@pytest.mark.parametrize("name", [name if name == "judged" else pytest.param(name, marks=pytest.mark.slow)
                                  for name in CLAIMS])  # the others compile for ten seconds each
def test_a_notebook_runs_and_keeps_its_word(name, tmp_path):
    require_group("notebook")
    import jupytext
    from nbclient import NotebookClient

    notebook = jupytext.read(NOTEBOOKS / f"{name}.py")
    folder = {"metadata": {"path": str(tmp_path)}}
    NotebookClient(notebook, timeout=None, kernel_name="python3", resources=folder).execute()
    outputs = [output for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs]
    said = "".join(output["text"] for output in outputs if output.output_type == "stream")
    warned = [output["text"] for output in outputs if output.get("name") == "stderr"
              and "encryption" not in output["text"]]  # of the kernel itself: how it talks to its client
    assert warned == []
    for pattern, least, most in CLAIMS[name]:
        assert (found := re.search(pattern, said)), f"{pattern} in\n{said}"
        assert least <= float(found[1]) <= most, found[0]
    shown = [output.get("data", {}) for output in outputs]
    assert sum("<iframe" in data.get("text/html", "") for data in shown) == PLAYERS[name]
    assert sum("image/png" in data for data in shown) == PICTURES[name]
    assert len({path.name for path in tmp_path.iterdir()}) == 0  # nothing is left behind
