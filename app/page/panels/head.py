"""The head of the page: style and theme. The viewer lets style be set by html of one's own only."""

import colorsys
from pathlib import Path

import viser

from app.colours import ESTIMATE, TRUTH, rgb

CONTROLS_WIDTH, MEASUREMENTS_WIDTH = 352, 316  # pixels of the right and of the left panel

#: Put before a slider whose number box would show a logarithm: the style hides the box.
LOGARITHMIC = "<i class='lab-logarithmic'></i>"
#: Put before the text beside such a slider.
TYPED = "<i class='lab-typed'></i>"
#: Put before each of the boxes that stand two in a row.
HALF_WIDE = "<i class='lab-half'></i>"
#: Put before each of two buttons that stand in a row.
BESIDE = "<i class='lab-beside'></i>"
#: Put before a row of buttons that needs all of the width.
BARE = "<i class='lab-bare'></i>"
#: Put before a box whose label is longer than the others'.
WIDE_LABEL = "<i class='lab-wide'></i>"

_PIXEL = "data:image/gif;base64,R0lGODlhAQABAIAAAAAAAP///ywAAAAAAQABAAACAUwAOw=="


def _web(*names: str) -> str:
    return "".join((Path(__file__).parents[1] / "web" / name).read_text(encoding="utf-8") for name in names)


_STYLE = _web("style.css", "room.css", "present.css")
#: A calm ground until there is a stage, and the scripts: what the html that a browser loads first has of ours.
GROUND = _web("ground.html") + "<script>\n" \
    + _web("names.js", "attendance.js", "tabs.js", "browser_store.js", "figures.js", "drop.js") + "</script>"
# An image's onload is the one moment in a page's life that html alone can hook. The viewer's own buttons (its server,
# its scene tree, its share link) are of no use to a visitor, and its warning of slow graphics, which would cover the
# colour bar, does not hold for so light a picture. How far a file has come is said where all else is.
_HEAD = f"""<img src='{_PIXEL}' style='display:none' onload="
new MutationObserver(()=>document.querySelectorAll('.mantine-Notification-root').forEach(n=>{{
if(/^(Software WebGL|Uploading )/.test(n.innerText))n.style.display='none'}})).observe(document.body,{{childList:true,
subtree:true}})">
<style>
:root {{ --lab-estimate: {ESTIMATE}; --lab-truth: {TRUTH}; --lab-left-panel: {MEASUREMENTS_WIDTH}px;
--lab-right-panel: {CONTROLS_WIDTH}px; }}
{_STYLE}</style>"""


def set_up(gui: viser.GuiApi) -> None:
    """Theme and panel of a page."""
    gui.configure_theme(dark_mode=False, show_logo=False, show_share_button=False, brand_color=_brand(TRUTH))
    gui.main_panel.dock_right()
    gui.main_panel.set_width(CONTROLS_WIDTH)
    gui.set_panel_label("mpm-lab: how wrong is it?")


def add_head(gui: viser.GuiApi) -> None:
    """The html that sets the style, in an element of its own so that it runs once."""
    gui.add_html(_HEAD)


def _brand(colour: str) -> tuple[int, int, int]:
    """The theme colour for which buttons come out as ``colour``: they are drawn two shades lighter."""
    hue, light, full = colorsys.rgb_to_hls(*(part / 255 for part in rgb(colour)))
    red, green, blue = colorsys.hls_to_rgb(hue, max(0.0, 0.9 - (0.9 - light) * 8 / 6), full)
    return round(255 * red), round(255 * green), round(255 * blue)
