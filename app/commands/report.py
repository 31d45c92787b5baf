"""A report in Markdown as one page of HTML."""

from html import escape
from pathlib import Path

from app.lessons.markup import html
from app.templates import rendered

PAGE = Path(__file__).parent / "report.html"


def as_html(text: str, folder: Path) -> str:
    """The report as one page, its pictures, which lie in the folder, in it."""
    title = escape(text.partition("\n")[0].lstrip("# "))
    body = html(text, folder)  # whose tables scroll by themselves where they are wider than a phone
    body = body.replace("<table>", '<div class="wide" tabindex="0"><table>').replace("</table>", "</table></div>")
    return rendered(PAGE, title=title, body=body)
