"""Tables in Markdown."""

from collections.abc import Collection, Iterable, Sequence


def markdown_table(heads: Sequence[str], lines: Iterable[Sequence[str]], words: Collection[str] | None = None) -> str:
    """A table. ``words`` are the headings of columns that stand to the left, while numbers stand to the right; without
    it whoever shows the table decides."""
    rules = ["---" if words is None else ":---" if head in words else "---:" for head in heads]
    cells = [[cell.replace("|", "\\|") for cell in row] for row in (heads, rules, *lines)]
    return "\n".join(f"| {' | '.join(row)} |" for row in cells)
