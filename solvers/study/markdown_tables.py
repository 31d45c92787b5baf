"""Tables in Markdown."""

from collections.abc import Collection, Iterable, Sequence


def markdown_table(heads: Sequence[str], lines: Iterable[Sequence[str]], words: Collection[str] | None = None) -> str:
    """Returns a table in Markdown. ``words`` are the headings of left-aligned columns, all others are right-aligned;
    None leaves the alignment to the viewer."""
    rules = ["---" if words is None else ":---" if head in words else "---:" for head in heads]
    cells = [[cell.replace("|", "\\|") for cell in row] for row in (heads, rules, *lines)]
    return "\n".join(f"| {' | '.join(row)} |" for row in cells)
