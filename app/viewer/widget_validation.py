"""Validation of values that visitors set, by kind of widget, and access to private parts of the viewer."""

import math
from collections.abc import Callable, Sequence
from typing import Any, cast

import numpy as np
import viser

from app.viewer.message_batch_encoding import ChangedArrays
from app.viewer.send_queue import SendBuffer

LONGEST_TEXT = 200  # characters; few inputs of the page need more
_OWN = "longest_text"  # attribute of a text that may be longer


def why_value_refused(widget: Any, value: Any) -> str | None:
    """Returns why a browser cannot have set a widget to a decoded ``value``, in words for the log, or None."""
    rule = RULES.get(type(widget))
    if rule is None:
        return "a widget of a kind that takes no values"
    if widget.disabled or not widget.visible:
        return "a widget that is off"
    return None if rule(widget, value) else f"a value that “{widget.label}” cannot have"


def set_max_length(text: viser.GuiTextHandle, longest: int) -> None:
    """Sets the most characters that :func:`why_value_refused` allows in a text input."""
    object.__setattr__(text, _OWN, longest)  # the viewer's own setter accepts its properties only


def is_number_between(value: Any, low: float = -math.inf, high: float = math.inf) -> bool:
    """Whether a value is a finite number from ``low`` to ``high``, and no bool."""
    return type(value) in (int, float) and abs(value) <= 1e300 and low <= value <= high


def set_node_arrays(changed: Sequence[tuple[viser.SceneNodeHandle, dict[str, np.ndarray]]]) -> None:
    """Sets arrays, by property, of scene nodes of one client, in a message per node. They must not be modified later:
    the viewer's own setters copy them, which takes half a frame's time."""
    messages, api = [], changed[0][0]._impl.api
    for handle, arrays in changed:
        vars(handle._impl.props).update(arrays)
        messages.append(ChangedArrays(handle.name, arrays, api._owner_id))
    cast(SendBuffer, api._websock_interface.get_message_buffer()).push_all(messages)


def widget_id(widget: Any) -> str:
    """Returns the id of a widget's input in the browser."""
    return str(widget._impl.uuid)


def is_removed(widget: Any) -> bool:
    """Whether a widget has been removed; the viewer would warn if it were changed."""
    return widget._impl.removed


def _is_in_range(widget: Any, value: Any) -> bool:
    """Whether a number is in a widget's range, up to half its last digit, as a browser rounds to the digits shown."""
    half = 0.5 * 10.0**-widget.precision * (1 + 1e-9) if type(widget.value) is float else 0.0
    low = -math.inf if widget.min is None else widget.min - half
    high = math.inf if widget.max is None else widget.max + half
    return is_number_between(value, low, high) and (type(widget.value) is float or value == int(value))


def _is_bool(widget: Any, value: Any) -> bool:
    return type(value) is bool


def _is_option(widget: Any, value: Any) -> bool:
    return type(value) is str and value in widget.options


RULES: dict[type, Callable[[Any, Any], bool]] = {
    viser.GuiSliderHandle: _is_in_range, viser.GuiNumberHandle: _is_in_range, viser.GuiCheckboxHandle: _is_bool,
    viser.GuiButtonHandle: _is_bool, viser.GuiDropdownHandle: _is_option, viser.GuiButtonGroupHandle: _is_option,
    viser.GuiTextHandle: lambda text, value: type(value) is str and len(value) <= getattr(text, _OWN, LONGEST_TEXT)}
