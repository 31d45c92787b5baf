"""Beside the control that was changed last: that what it asks for is being compiled."""

import threading
from typing import Any

MARK = " · compiling …"


class Patience:
    """Marks the label of one visitor's last changed widget while its wish waits for a compiler."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._last: Any = None
        self._marked: tuple[Any, str] | None = None  # a widget, and its own label

    def changed(self, widget: Any) -> None:
        """The visitor has changed a widget."""
        with self._lock:
            self._last = widget

    def show(self, compiling: bool) -> None:
        """Mark the widget, or take the mark away."""
        with self._lock:
            marked = self._marked[0] if self._marked else None
            wanted = self._last if compiling else None
            if wanted is marked:
                return
            if self._marked:
                widget, label = self._marked
                if not widget._impl.removed:
                    widget.label = label
            self._marked = None
            if wanted is not None and not wanted._impl.removed:
                self._marked = (wanted, wanted.label)
                wanted.label += MARK
