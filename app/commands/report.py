"""A report in three forms, Markdown, JSON and one page of HTML, with its pictures."""

from collections.abc import Callable, Mapping
from html import escape
from pathlib import Path
from typing import Any

from app.commands.output import Folder, draw, json_text
from app.lessons.markup import html
from app.templates import rendered

PAGE = Path(__file__).parent / "report.html"


def as_html(text: str, folder: Path) -> str:
    """The report as one page, its pictures, which lie in the folder, in it."""
    title = escape(text.partition("\n")[0].lstrip("# "))
    body = html(text, folder)  # whose tables scroll by themselves where they are wider than a phone
    body = body.replace("<table>", '<div class="wide" tabindex="0"><table>').replace("</table>", "</table></div>")
    return rendered(PAGE, title=title, body=body)


def put_report(folder: Folder, values: dict, pictured: Any, figures: Mapping[str, Callable[[Any], Any]],
               markdown: Callable[[list[str]], str]) -> int:
    """Write what ``values`` say and ``pictured`` shows; the exit status. A picture that fails costs nothing else."""
    drawn, status = draw(figures, pictured, folder.put, folder.text, "the rest is fine")
    text = markdown(drawn)
    folder.put("report.json", json_text(values, lines=True).encode())
    folder.put("report.md", text.encode())
    folder.put("report.html", as_html(text, folder.path).encode())
    return status
