"""Docstrings as they are written here: whoever tells of each parameter needs no list of them all before it."""

from typing import Any

TELLS_ALL = "Parameters\n----------"


def setup(app: Any) -> dict:
    """Beside autodoc, which reads them."""
    app.connect("autodoc-process-signature", without_repetition)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def without_repetition(app: Any, what: str, name: str, thing: Any, options: Any, signature: str | None,
                       returned: str | None) -> tuple[str, None] | None:
    """A class without its signature where its docstring has each field with type, meaning and default."""
    return ("", None) if what == "class" and TELLS_ALL in (thing.__doc__ or "") else None
