"""The page's furniture: title, icon and style. The viewer offers no way to set these but html of one's own."""

from __future__ import annotations

import colorsys

import viser

from app.colours import TRUTH

PAGE_TITLE = "mpm-lab"
CONTROLS_WIDTH, MEASUREMENTS_WIDTH = 352, 316

#: Put before a slider whose number box would show a logarithm: the style hides the box.
LOGARITHMIC = "<i class='lab-logarithmic'></i>"
#: Put before four boxes that stand two in a row.
PAIRED = "<div class='lab-paired'>Estimators, one or several</div>"

_ICON = ("data:image/svg+xml,%3Csvg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 16 16'%3E"
         "%3Crect width='16' height='16' rx='3' fill='%230072B2'/%3E%3Cpath d='M2 8q3-7 6 0t6 0' fill='none' "
         "stroke='white' stroke-width='1.6'/%3E%3Ccircle cx='5' cy='4.6' r='1.7' fill='%23D55E00'/%3E%3C/svg%3E")
_PIXEL = "data:image/gif;base64,R0lGODlhAQABAIAAAAAAAP///ywAAAAAAQABAAACAUwAOw=="
# An image's onload is the one moment in a page's life that html alone can hook: it sets the tab's title and icon.
# The viewer's own buttons (its server, its scene tree, its share link) are of no use to a visitor, and its warning
# of slow graphics, which would cover the colour bar, does not hold for so light a picture.
_HEAD = f"""<img src='{_PIXEL}' style='display:none' onload="document.title='{PAGE_TITLE}';
document.querySelector('link[rel=icon]').href=this.dataset.icon;
new MutationObserver(()=>document.querySelectorAll('.mantine-Notification-root').forEach(n=>{{
if(n.innerText.startsWith('Software WebGL'))n.style.display='none'}})).observe(document.body,{{childList:true,
subtree:true}})" data-icon="{_ICON}">
<style>
button:has(svg.tabler-icon-adjustments), button:has(svg.tabler-icon-list-search),
svg.tabler-icon-cloud-check {{ display: none !important; }}
div:has(> .lab-logarithmic) + div .mantine-NumberInput-root {{ display: none; }}
div:has(> .lab-logarithmic) + div .mantine-Slider-label {{ display: none; }}
div:has(> .lab-logarithmic) + div .mantine-Slider-root {{ margin: 0 14px 0 10px; }}
div:has(> .lab-logarithmic) + div {{ min-height: 28px; }}
div:has(> .lab-paired) + div, div:has(> .lab-paired) + div + div, div:has(> .lab-paired) + div + div + div,
div:has(> .lab-paired) + div + div + div + div {{ display: inline-block; width: 50%; }}
.lab-paired {{ padding: 0 10px 4px; font-size: 12.5px; letter-spacing: -0.75px; color: var(--mantine-color-dimmed); }}
.lab-notice {{ position: fixed; z-index: 5; pointer-events: none; bottom: 10px;
  left: {MEASUREMENTS_WIDTH + 20}px; right: {CONTROLS_WIDTH + 24}px; padding: 7px 12px;
  border-radius: 6px; font: 12.5px/1.4 system-ui, sans-serif;
  border-left: 4px solid; color: #222831; }}
.lab-refused {{ background: #fff6e0; border-color: #e69f00; }}
.lab-unstable, .lab-trouble {{ background: #fdecea; border-color: #c0392b; }}
.lab-wait {{ background: #eaf2fa; border-color: #0072b2; }}
.lab-readout {{ padding: 6px 12px 2px; font: 12px/1.5 system-ui, sans-serif; color: #222831;
  font-variant-numeric: tabular-nums; }}
.lab-readout table {{ width: 100%; border-collapse: collapse; }}
.lab-readout td:first-child {{ color: #6b7480; padding-right: 8px; white-space: nowrap; vertical-align: top; }}
.lab-readout table:first-child td:first-child {{ width: 1%; }}
.lab-readout td {{ vertical-align: top; padding-top: 0; padding-bottom: 0; }}
.lab-numbers {{ margin-top: 5px; border-top: 1px solid #dfe3e8; font-size: 11.5px; }}
.lab-numbers tr td:first-child {{ color: #222831; }}
.lab-numbers td:not(:first-child) {{ text-align: right; padding-left: 5px; white-space: nowrap; }}
.lab-worst {{ font-size: 10.5px; }} .lab-readout .lab-worst td {{ padding-right: 0; padding-left: 3px; }}
.lab-readout .lab-worst td:first-child {{ padding-left: 0; }}
.lab-numbers .lab-head td, .lab-numbers .lab-head td:first-child {{ color: #6b7480; }}
.lab-numbers .lab-silence {{ text-align: left !important; white-space: normal !important; color: #7a4a00;
  line-height: 1.3; }}
.lab-readout .lab-numbers td.lab-silence {{ color: #7a4a00; }} .lab-name {{ color: #222831; }}
.lab-worst td:nth-child(2) {{ text-align: left !important; }}
.lab-capped {{ background: #e69f00; color: #222; border-radius: 3px; padding: 0 4px; font-weight: 600; }}
.lab-heading {{ margin: 8px 12px -2px; text-align: center;
  font: 600 12px/1.3 system-ui, sans-serif; color: #222831; }}
.lab-heading span {{ font-weight: 400; color: #7a4a00; }}
.lab-about {{ padding: 4px 12px; font: 13px/1.5 system-ui, sans-serif; color: #222831; }}
.lab-about h3 {{ font-size: 14px; margin: 10px 0 4px; }} .lab-about p {{ margin: 4px 0 8px; }}
.lab-explanation {{ padding: 0 4px; }} .lab-about math[display=block] {{ margin: 6px 0; font-size: 13.5px; }}
div:has(> .lab-picked) + div {{ display: none !important; }}
.lab-cost {{ padding: 2px 12px 4px 8px; font: 12px/1.4 system-ui, sans-serif; color: #222831;
  font-variant-numeric: tabular-nums; }}
.lab-cost p {{ margin: 4px 2px; }} .lab-cost svg {{ display: block; }}
.lab-cost svg text {{ font: 10px system-ui, sans-serif; fill: #4a525c; }} .lab-cost .lab-number {{ font-size: 9px; }}
.lab-grid {{ stroke: #e6e9ee; }} .lab-axis {{ stroke: #9aa3ad; fill: none; }}
.lab-line {{ fill: none; stroke-width: 1; opacity: 0.45; }}
.lab-dot {{ cursor: pointer; outline: none; }}
.lab-dot:hover circle, .lab-dot:focus-visible circle {{ fill: #0072b233; }}
.lab-legend {{ display: flex; flex-wrap: wrap; gap: 0 10px; padding: 0 4px 4px; font-size: 11px; }}
.lab-legend span {{ display: inline-flex; align-items: center; gap: 3px; }}
.lab-runs {{ width: 100%; border-collapse: collapse; font-size: 11px; white-space: nowrap; }}
.lab-runs th {{ font-weight: 400; color: #6b7480; }}
.lab-runs th, .lab-runs td {{ text-align: right; padding: 1px 3px; }}
.lab-runs td:nth-child(2), .lab-runs th:nth-child(2) {{ text-align: left; }}
.lab-runs .lab-bad {{ color: #c0392b; text-align: center; }} .lab-runs tr:hover {{ background: #eaf2fa; }}
.lab-runs button {{ font: inherit; color: {TRUTH}; background: none; border: 1px solid #c6d4e2; border-radius: 3px;
  padding: 0 3px; min-width: 24px; cursor: pointer; }}
.lab-key {{ font-weight: 600; }}
</style>"""


def furnish(gui: viser.GuiApi) -> None:
    """Theme, title, icon and style of a page."""
    gui.configure_theme(dark_mode=False, show_logo=False, show_share_button=False, brand_color=_brand(TRUTH))
    gui.main_panel.dock_right()
    gui.main_panel.set_width(CONTROLS_WIDTH)
    gui.set_panel_label("mpm-lab: how wrong is it?")


def add_head(gui: viser.GuiApi) -> None:
    """The html that sets title, icon and style, in an element of its own so that it runs once."""
    gui.add_html(_HEAD)


def _brand(colour: str) -> tuple[int, int, int]:
    """The theme colour for which buttons come out as ``colour``: they are drawn two shades lighter."""
    rgb = [int(colour[k:k + 2], 16) / 255 for k in (1, 3, 5)]
    hue, light, full = colorsys.rgb_to_hls(*rgb)
    return tuple(round(255 * v) for v in colorsys.hls_to_rgb(hue, max(0.0, 0.9 - (0.9 - light) * 8 / 6), full))
