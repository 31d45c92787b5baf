"""The page's head: style, theme, language links, and the marks before widgets by which styles and scripts find them
(the viewer accepts style in html only, and its widgets have no names). Also its buttons: the presenter's view for a
projector (headline, stage and one plot in large letters), and the choice of problem."""

import colorsys
import json
from collections.abc import Callable
from html import escape
from pathlib import Path
from typing import Any

import viser

from app.colour_palette import TEXTS, rgb
from app.language.translation import LANGUAGES, current_language, lazy, load_catalogue, tr
from app.logo_and_font import MARK, font_faces_css
from app.names_and_units import number_format_script
from app.page.panels.body_titles import library_title
from app.page.panels.browser_store_and_window import BrowserStore
from app.templates import render_template
from solvers.bodies.body_file import library_names
from solvers.problems import PROBLEMS
from solvers.scene.scene import Scene

CONTROLS_WIDTH = 368  # pixels, of the viewer's panel until the style lays it out

# Marks for the style, each put before a widget:
BESIDE = "<i class='lab-beside'></i>"  # each of two buttons that stand in a row
BARE = "<i class='lab-bare'></i>"  # a row of buttons that needs all of the width
WEB = Path(__file__).parents[1] / "web"


def _joined_web_files(folder: str, ending: str) -> str:
    """Returns the text of all files of a folder in ``web/`` with an ending ("css"), joined in the order of names."""
    return "".join(path.read_text(encoding="utf-8") for path in sorted((WEB / folder).glob(f"*.{ending}")))


def initial_page_html() -> str:
    """Returns the html that the server adds to the viewer's page: style, frame, scripts and their texts."""
    words = json.dumps(load_catalogue(current_language()).translations_for_files("app/page/web/js/"),
                       ensure_ascii=False).replace("<", "\\u003c")
    frame = render_template(WEB / "ground.html", mark=MARK, languages=language_links())
    return f"<style>\n{font_faces_css()}{_joined_web_files('css', 'css')}</style>\n{frame}" \
           f"<script type='application/json' id='lab-words'>{words}</script>\n" \
           f"<script>\n{number_format_script()}{_joined_web_files('js', 'js')}</script>"


def set_up_theme(gui: viser.GuiApi, dark: bool = False) -> None:
    """Sets the viewer's colours, dark or light, and the place and width of its panel."""
    # The theme colour for which buttons have the accent colour: they are drawn two shades lighter.
    hue, light, full = colorsys.rgb_to_hls(*(part / 255 for part in rgb(TEXTS["accent"][dark])))
    red, green, blue = colorsys.hls_to_rgb(hue, max(0.0, 0.9 - (0.9 - light) * 8 / 6), full)
    gui.configure_theme(dark_mode=dark, show_logo=False, show_share_button=False,
                        brand_color=(round(255 * red), round(255 * green), round(255 * blue)))
    gui.main_panel.dock_right()
    gui.main_panel.set_width(CONTROLS_WIDTH)
    gui.set_panel_label("mpm-lab: how wrong is it?")


def language_links() -> str:
    """Returns html links to the page in the other languages (``js/languages.js`` keeps the state)."""
    return " ".join(f"<a class='lab-language' href='?lang={code}' lang='{code}' hreflang='{code}'>{other.name}</a>"
                    for code, other in LANGUAGES.items() if code != current_language())


def add_widget_marker(gui: viser.GuiApi, *names: str, words: str = "") -> viser.GuiHtmlHandle:
    """Marks the widget that is added next with CSS classes (``names``) and ``words`` beside its label. To change the
    mark, set the returned handle's content to :func:`widget_marker_html`."""
    return gui.add_html(widget_marker_html(*names, words=words))


def widget_marker_html(*names: str, words: str = "", **data: str) -> str:
    """Returns the html of a mark for :func:`add_widget_marker`, with further ``data`` for scripts."""
    said = "".join(f" data-{name}='{escape(text)}'" for name, text in data.items())
    return f"<i class='{' '.join(filter(None, ('lab-words', *names)))}' data-words='{escape(words)}'{said}></i>"


_BUTTON, _ON = "<i class='lab-present'></i>", "<i class='lab-present lab-presenting'></i>"
PRESENT, END = lazy("Present"), lazy("End")


class PresentationMode:
    """Button of the presenter's view, for projectors; Escape and ``?present`` in the address do the same."""

    def __init__(self, gui: viser.GuiApi):
        self.on = False
        self._mark = gui.add_html(_BUTTON)
        self._button = gui.add_button(
            tr(PRESENT), hint=tr("for a projector: stage and one plot, large text; ? lists the keys"))
        self._button.on_click(lambda _: self._toggle())

    def begin(self) -> None:
        """Switches the presenter's view on, if it is off."""
        if not self.on:
            self._toggle()

    def _toggle(self) -> None:
        self.on = not self.on
        self._mark.content = _ON if self.on else _BUTTON
        self._button.label = tr(END if self.on else PRESENT)


class ProblemButtons:
    """One visitor's choice of what moves: a button for each problem and one for a motion or particles of their own, in
    a narrow window one with a menu; ``choose`` receives a problem's key."""

    def __init__(self, gui: viser.GuiApi, store: BrowserStore, choose: Callable[[str], None]):
        self._html, self._choose = gui.add_html(""), choose
        store.heard["problem"] = self._on_message

    def show(self, scene: Scene, offered: bool, has_body: bool) -> None:
        """Marks the problem of the scene on the stage, or that a body of one's own is there (``has_body``); shows no
        buttons unless ``offered``: lessons may hide them."""
        titles = {name: tr(problem.scene.TITLE) for name, problem in PROBLEMS.items() if offered}
        own = tr("Your body") if has_body else tr("Your motion") if scene.to_dict().get("displacement") else ""
        bodies = {name: library_title(name) for name in library_names()}
        said = json.dumps({"titles": titles, "chosen": scene.problem, "own": own, "bodies": bodies})
        self._html.content = f"<i class='lab-problems' data-said='{escape(said)}'></i>"

    def _on_message(self, said: Any) -> None:
        if isinstance(said, str) and said in PROBLEMS:
            self._choose(said)
