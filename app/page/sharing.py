"""Sharing: what is on the stage as a link, to copy or to show as a QR code."""

from html import escape
from urllib.parse import quote, urlsplit

import segno
import viser

from app import state
from app.language.translation import lazy, tr
from app.page.controls import Controls
from app.page.panels.browser_store import BrowserStore
from app.page.panels.page_header import BESIDE

LESSON = "lesson="
SAFE = ";=,.+-_:"  # may stand in a link's fragment as they are
LAST = 1e9  # in the order of what stands in the panel, whatever is made anew above
MOST_QR = 1200  # characters that a phone still reads off a projector
HERE = ("localhost", "127.0.0.1", "::1")
OF_NO_USE = lazy("Only this computer can open this address, no phone can: serve with --host 0.0.0.0 for a class.")


def state_link(shown: state.State, lesson: str) -> str:
    """The fragment of the address of what is seen, and of the lesson that is open."""
    return ";".join(filter(None, [f"{LESSON}{quote(lesson)}" if lesson else "",
                                  quote(state.write_state(shown), safe=SAFE)]))


def parse_link(text: str) -> tuple[str, str]:
    """The lesson that a link opens, and the state that it puts on the stage; each may be missing."""
    if not text.startswith(LESSON):
        return "", text
    lesson, _, rest = text.removeprefix(LESSON).partition(";")
    return lesson, rest


class Sharing:
    """Two buttons among a visitor's controls. The browser itself copies: its address is the link."""

    def __init__(self, gui: viser.GuiApi, store: BrowserStore, controls: Controls):
        self._gui, self._store, self._controls = gui, store, controls
        with gui.add_folder(None, order=LAST):
            gui.add_html("<i class='lab-beside lab-copy'></i>")
            gui.add_button(tr("Copy link"), icon=viser.Icon.LINK, hint=tr(
                "the address of just this scene, view and pinned run: it opens for everyone who can reach this server"))
            gui.add_html(BESIDE)
            code = gui.add_button(tr("QR code"), icon=viser.Icon.QRCODE,
                                  hint=tr("the same, to be read off this screen by a phone"))
        code.on_click(lambda _: self.show_code())

    def show_code(self) -> None:
        """Show what is seen as a code, as large as the window, and as words."""
        address = f"{self._store.here}#{state_link(self._controls.state, '')}"
        with self._gui.add_modal(tr("This scene")) as modal:
            if urlsplit(self._store.here).hostname in HERE:
                self._gui.add_html(f"<div class='lab-code'><p><b>{tr(OF_NO_USE)}</b></p></div>")
            if self._store.here and len(address) <= MOST_QR:
                picture = segno.make(address, error="l").svg_inline(border=2, omitsize=True)
                self._gui.add_html(f"<div class='lab-code'>{picture}</div>")
            command = f"<code>mpm-lab run --scene '{escape(state.write_state(self._controls.state))}'</code>"
            self._gui.add_html(f"<div class='lab-code'><p>{escape(address)}</p>"
                               f"<p>{tr('Without a page: {command}', command=command)}</p></div>")
            close = self._gui.add_button(tr("Close"))
        close.on_click(lambda _: modal.close())
