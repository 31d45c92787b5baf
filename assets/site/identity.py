"""How the site looks: the lab's colours, taken from the page's own style, and its type."""

import re
from pathlib import Path
from typing import Any

from app import logo_and_font

TOKENS = Path(logo_and_font.__file__).parent / "page" / "web" / "css" / "00-tokens.css"
#: What the theme calls a colour, and what the page does.
COLOURS = {"color-brand-primary": "accent", "color-brand-content": "accent", "color-brand-visited": "accent",
           "color-foreground-primary": "ink", "color-foreground-secondary": "ink2", "color-foreground-muted": "ink3",
           "color-background-primary": "ground", "color-background-secondary": "panel",
           "color-background-border": "line", "color-sidebar-item-background--hover": "accent-weak"}
STYLE = "identity.css"


def setup(app: Any) -> dict:
    """Colours for the theme, and a file of type beside its own."""
    app.connect("config-inited", colours)
    app.connect("builder-inited", letters)
    app.add_css_file(STYLE)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def colours(app: Any, config: Any) -> None:
    """The page's light and dark colours as the theme's."""
    light, dark = (dict(re.findall(r"--([\w-]+): (#\w+)", block)) for block in
                   re.findall(r":root[^{]*\{([^}]*--ground[^}]*)\}", TOKENS.read_text(encoding="utf-8")))
    for name, tokens in (("light", light), ("dark", dark)):
        config.html_theme_options[f"{name}_css_variables"] = {
            **{theirs: tokens[ours] for theirs, ours in COLOURS.items()},
            **{f"lab-{token}": tokens[token] for token in ("accent-weak", "estimate-ink")},
            "font-stack": "'Lab Inter', system-ui, sans-serif"}


def letters(app: Any) -> None:
    """The letters that come with the lab."""
    if app.builder.format == "html":
        folder = Path(app.outdir) / "_static"
        folder.mkdir(parents=True, exist_ok=True)
        (folder / STYLE).write_text(logo_and_font.font_faces_css(), encoding="utf-8")
