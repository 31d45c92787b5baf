"""Beside the control that was changed last: that what it asks for is being compiled."""

import threading
from typing import Any

from app.viewer.handles import is_removed

MARK = "\ncompiling …"  # below the label, in small letters (style.css): a row is high enough for both


class Patience:
    """Marks the label of one visitor's last changed widget while its wish waits for a compiler."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._last: Any = None
        self._marked: Any = None

    def changed(self, widget: Any) -> None:
        with self._lock:
            self._last = widget

    def show(self, compiling: bool) -> None:
        """Mark the widget, or take the mark away. Its label may have changed meanwhile."""
        with self._lock:
            wanted = self._last if compiling else None
            marked, self._marked = self._marked, wanted
            if marked and marked is not wanted and not is_removed(marked):
                marked.label = marked.label.removesuffix(MARK)
            if wanted and not is_removed(wanted) and not wanted.label.endswith(MARK):
                wanted.label += MARK
