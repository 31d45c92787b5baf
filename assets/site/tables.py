"""Tables of numbers: 3.49e-6 stays on one line, however narrow its column."""

from typing import Any

from docutils import nodes


def setup(app: Any) -> dict:
    """Mark the cells, for the style."""
    app.connect("doctree-read", mark)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def mark(app: Any, doctree: nodes.document) -> None:
    """A cell of one word is not broken."""
    for cell in doctree.findall(nodes.entry):
        if " " not in cell.astext().strip():
            cell["classes"].append("whole")
