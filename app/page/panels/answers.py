"""What is said under the control that was changed last: that its wish is being compiled, or why it cannot be met."""

import threading
from collections.abc import Callable
from html import escape
from time import monotonic
from typing import Any

import viser

from app.language.spoken import tr
from app.viewer.widgets import identity, is_removed

REST = 0.7  # seconds without another refusal, after which the control goes back: not under the hand that moves it
TO_BE_READ = 8.0  # seconds that a refusal stands there


class Answers:
    """One visitor's. Call :meth:`refresh` a few times a second; the browser lays the words (``js/answers.js``)."""

    def __init__(self, gui: viser.GuiApi, clock: Callable[[], float] = monotonic):
        self._html, self._clock = gui.add_html(""), clock
        self._lock = threading.Lock()
        self._last: Any = None  # the widget that was changed last
        self._refusal: tuple[float, str] | None = None
        self._back: Callable[[], None] | None = None

    def changed(self, widget: Any) -> None:
        """The visitor has changed a widget."""
        with self._lock:
            self._last, self._refusal, self._back = widget, None, None

    def refuse(self, widget: Any, sentence: str, back: Callable[[], None]) -> None:
        """What a widget says cannot be, for a reason; ``back`` has it say again what is."""
        with self._lock:
            self._last, self._refusal, self._back = widget, (self._clock(), sentence), back

    def refresh(self, compiling: bool) -> None:
        """Say what there is to say, and put a refused widget back."""
        with self._lock:
            widget, back, now = self._last, None, self._clock()
            since, sentence = self._refusal or (now, "")
            if self._back and now > since + REST:
                back, self._back = self._back, None
            if now > since + TO_BE_READ:
                self._refusal = None
        if widget is None or is_removed(widget):
            content = ""
        elif self._refusal:
            content = _said(widget, "refused", f"{sentence[:1].upper()}{sentence[1:]}.")
        else:
            content = _said(widget, "compiling", tr("compiling …")) if compiling else ""
        self._html.content = content
        if back and not is_removed(widget):
            back()


def _said(widget: Any, kind: str, sentence: str) -> str:
    return f"<i class='lab-answer' data-of='{identity(widget)}' data-kind='{kind}' data-says='{escape(sentence)}'></i>"
