"""What kinds of values a widget's properties take, worked out once for a kind of widget.

The viewer asks for it anew with each widget, and Python reads every annotation of it each time: a third of the time
that a page takes to make.
"""

from functools import cached_property
from typing import Any

from viser._assignable_props_api import AssignablePropsBase
from viser.infra._messages import get_type_hints_cached


def mend() -> None:
    """Have widgets ask what is known of their kind."""
    known = cached_property(_known)
    known.__set_name__(AssignablePropsBase, "_prop_hints")
    AssignablePropsBase._prop_hints = known  # type: ignore[method-assign, assignment]


def _known(widget: Any) -> dict[str, Any]:
    return get_type_hints_cached(type(widget._impl.props))  # type: ignore[arg-type]  # kinds can be looked up
