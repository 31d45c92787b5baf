"""What the viewer's handles can do that it keeps to itself."""

from typing import Any

import viser
from viser._messages import SceneNodeUpdateMessage


def put_props(handle: viser.SceneNodeHandle, props: dict[str, Any]) -> None:
    """Set several properties of a thing on the stage in one message, as they are.

    The viewer's setters compare, copy and convert each of them several times, which took half of the time of a frame.
    """
    for name, value in props.items():
        setattr(handle._impl.props, name, value)
    handle._impl.api._queue_scene_message(SceneNodeUpdateMessage(handle.name, props))


def is_removed(widget: Any) -> bool:
    """Whether a widget has gone: the viewer would warn of what is set of it."""
    return widget._impl.removed
