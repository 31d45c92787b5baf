"""The bar of the page's opening as a recorded run, for the first page."""

from pathlib import Path
from typing import Any

from app.export.html_file import recorded_page
from app.page.features.opening_tour import OPENING

FILE = "bar.html"


def setup(app: Any) -> dict:
    app.connect("builder-inited", write_bar)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def write_bar(app: Any) -> None:
    """Runs and records the bar, and writes the file beside the site's styles."""
    if app.builder.format == "html":
        folder = Path(app.outdir) / "_static"
        folder.mkdir(parents=True, exist_ok=True)
        (folder / FILE).write_text(recorded_page(OPENING), encoding="utf-8")
