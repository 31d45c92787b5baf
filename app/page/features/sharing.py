"""Sharing: the state on the stage as a link, in the browser's address, to copy or as a QR code."""

import threading
from contextlib import suppress
from html import escape
from typing import Any
from urllib.parse import quote, urlsplit

import segno
import viser

from app import shareable_state
from app.language.translation import lazy, tr, translate_message
from app.page.feature import Feature
from app.page.page_context import PageContext
from app.page.panels.page_header import BESIDE
from app.page.visit.engine_links import scene_size_refusal

LESSON = "lesson="
SAFE = ";=,.+-_:"  # need no escaping in a link's fragment
MOST_QR = 1200  # characters that a phone still reads off a projector
HERE = ("localhost", "127.0.0.1", "::1")
OF_NO_USE = lazy("Only this computer can open this address, no phone can: serve with --host 0.0.0.0 for a class.")


def state_link(shown: shareable_state.State, lesson: str) -> str:
    """Returns what follows the # in the page's address: the open lesson's name, if it is not "", and a state."""
    return ";".join(filter(None, [f"{LESSON}{quote(lesson)}" if lesson else "",
                                  quote(shareable_state.write_state(shown), safe=SAFE)]))


def parse_link(text: str) -> tuple[str, str]:
    """Splits what follows the # in an address into a lesson's name and a state as text; either may be ""."""
    if not text.startswith(LESSON):
        return "", text
    lesson, _, rest = text.removeprefix(LESSON).partition(";")
    return lesson, rest


def linked_state(link: object) -> shareable_state.State | None:
    """Returns the state of a link; None if it has none, or none that can be shown."""
    with suppress(shareable_state.StateError):
        state = shareable_state.parse_state(parse_link(str(link))[1])
        return None if scene_size_refusal(state.scene) else state
    return None


class BrowserAddress:
    """Applies links opened in one visitor's browser, and updates the browser's address with the state shown."""

    def __init__(self, page: PageContext):
        self._page, self._keeping = page, threading.Lock()

    def listen(self, first: dict[str, Any]) -> None:
        """Applies the address that the page was opened with, and those opened later in the same browser tab; ``first``
        as of :meth:`BrowserStore.listen`."""
        lesson = self._page.lesson
        self._page.store.listen(self._follow, lesson.restore if lesson else lambda name, answers: None, first)

    def keep(self) -> None:
        """Stores the present state in the browser's address, and a lesson's answers in the browser."""
        with self._keeping:  # otherwise a refresh could overwrite a newer state
            lesson = self._page.lesson
            name, answers = (lesson.name, lesson.stored_progress) if lesson else ("", "")
            self._page.store.store(state_link(self._page.controls.state, name), name, answers)

    def _follow(self, link: str) -> None:
        """Shows lesson and state of a ``link``, an address after its #, unless they are shown; refuses invalid states
        with a message."""
        page = self._page
        name, text = parse_link(link)
        with page.store.defer_storing():
            if name and page.lesson and page.lesson.name != name:
                page.lesson.open(name)
            try:
                if text and (state := shareable_state.parse_state(text)) != page.controls.state:
                    page.controls.show(state)
            except shareable_state.StateError as error:
                page.session.refuse(tr("The link cannot be followed: {reason}", reason=translate_message(str(error))))


class Sharing(Feature):
    """Buttons to copy the link and to show it as a QR code. The browser itself copies: its address is the link."""

    def __init__(self, page: PageContext):
        self._page, gui = page, page.gui
        self.shortcuts = {"code": self.show_qr_code}
        with page.own_data:
            gui.add_html("<i class='lab-beside lab-copy'></i>")
            gui.add_button(tr("Copy link"), icon=viser.Icon.LINK, hint=tr(
                "the address of just this scene, view and pinned run: it opens for everyone who can reach this server"))
            gui.add_html(BESIDE)
            code = gui.add_button(tr("QR code"), icon=viser.Icon.QRCODE,
                                  hint=tr("the same, to be read off this screen by a phone"))
        code.on_click(lambda _: self.show_qr_code())

    def show_qr_code(self) -> None:
        """Shows a dialog with the stage's state as a QR code, as large as the window, as link and as command."""
        gui, here, seen = self._page.gui, self._page.store.here, self._page.controls.state
        address = f"{here}#{state_link(seen, '')}"
        with gui.add_modal(tr("This scene")) as modal:
            if urlsplit(here).hostname in HERE:
                gui.add_html(f"<div class='lab-code'><p><b>{tr(OF_NO_USE)}</b></p></div>")
            if here and len(address) <= MOST_QR:
                picture = segno.make(address, error="l").svg_inline(border=2, omitsize=True)
                gui.add_html(f"<div class='lab-code'>{picture}</div>")
            command = f"<code>mpm-lab run --scene '{escape(shareable_state.write_state(seen))}'</code>"
            gui.add_html(f"<div class='lab-code'><p>{escape(address)}</p>"
                         f"<p>{tr('Without a page: {command}', command=command)}</p></div>")
            close = gui.add_button(tr("Close"))
        close.on_click(lambda _: modal.close())
