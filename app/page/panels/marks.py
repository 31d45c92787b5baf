"""Marks before a widget, by which the style and the scripts know it: the viewer gives them no names of its own."""

from html import escape

import viser


def mark(gui: viser.GuiApi, *names: str, words: str = "") -> viser.GuiHtmlHandle:
    """A mark with names, for the widget that is made next. ``words`` are written beside its label, or at the right of a
    folder's (``js/beside.js``); set the handle's content to :func:`marked` for others."""
    return gui.add_html(marked(*names, words=words))


def marked(*names: str, words: str = "") -> str:
    """The html of a mark."""
    return f"<i class='{' '.join(('lab-words', *names))}' data-words='{escape(words)}'></i>"
