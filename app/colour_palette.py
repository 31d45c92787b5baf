"""Colours of the page and of all pictures, light and dark: data are coloured, the interface is ink and one accent.

Blue is the truth, warm colours are estimates, magenta is crossings: Okabe and Ito's blue and (darkened) orange, which
remain distinguishable with common colour blindness. The lightness of the map of sizes rises evenly, so that equal steps
of error look equal, also in print. The page has the same palette as variables (``css/00-tokens.css``)."""

from collections import defaultdict
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import numpy as np


class Shades(NamedTuple):
    """Colour as "#rrggbb" on a light and on a dark background."""

    light: str
    dark: str


GROUNDS = {"ground": Shades("#ffffff", "#121419"), "panel": Shades("#f6f7fa", "#191c22"),
           "raised": Shades("#ffffff", "#22262e")}
#: Text, on any background: a contrast of at least 4.5.
TEXTS = {"ink": Shades("#15171c", "#f0f2f6"), "ink2": Shades("#454b58", "#c3c9d4"),
         "ink3": Shades("#5f6675", "#9aa2b1"), "accent": Shades("#4a3fb5", "#a79ff7"),
         "truth-ink": Shades("#005f96", "#7cc6f2"), "estimate-ink": Shades("#a84500", "#ffa466"),
         "warn-ink": Shades("#714400", "#ffd98a"), "bad-ink": Shades("#9c2318", "#ffb3a8"),
         "good-ink": Shades("#00664a", "#6fd8b5")}
#: Lines, marks and edges of controls, on any background: a contrast of at least 3.
LINES = {"truth": Shades("#0072b2", "#4fb0ea"), "estimate": Shades("#cf5a00", "#ff8b3d"),
         "transport": Shades("#cf5a00", "#ff8b3d"), "recovered": Shades("#6b2a00", "#f0b08c"),
         "companion": Shades("#c97d00", "#ffc766"), "twogrid": Shades("#b0156b", "#f07fb8"),
         "cross": Shades("#cc0078", "#ff62b3"), "edge": Shades("#7f8796", "#757d8d"),
         "dot": Shades("#15171c", "#f0f2f6"), "stem": Shades("#a8517f", "#d487ae"),
         "before": Shades("#868e9d", "#7d8594")}
#: Dividers and tints without meaning.
FAINT = {"line": Shades("#e2e5eb", "#2c313a"), "line2": Shades("#c5cad4", "#4a515e"),
         "cell": Shades("#cfd4dd", "#3a404b")}
PALETTE = GROUNDS | TEXTS | LINES | FAINT
PIECE_COLOURS = TEXTS["accent"], Shades("#7a71d6", "#7a71d6")  # of neighbours, where a bar is drawn in pieces
#: Areas of the causes of error, by the names of ``solvers.scene.error_causes``: crossings darker than their line, so
#: that any two of these, and the background, differ by 20 or more in CIE L*a*b*, also with common colour blindness.
CAUSES = {"crossings": Shades("#a8005f", "#ff80c4"), "coarse_grid": Shades("#2f86e0", "#2a7bd6"),
          "body_force": Shades("#5fd3a2", "#57dd9b"), "time_step": Shades("#8f96a3", "#515866")}

ESTIMATE, TRUTH = LINES["estimate"].light, LINES["truth"].light
ESTIMATE_INK, TRUTH_INK = TEXTS["estimate-ink"].light, TEXTS["truth-ink"].light  # of text about either
INK, INK2, INK3 = (TEXTS[name].light for name in ("ink", "ink2", "ink3"))
LINE, LINE2 = FAINT["line"].light, FAINT["line2"].light
PINNED = "#7f8796"  # a pinned run: grey
COLOUR_MAP = "viridis"
#: Methods: the rest of Okabe and Ito's set, dark enough for lines on white, each with a marker too; others are grey.
METHOD_COLOURS = defaultdict(lambda: "#777777", {"mpm": INK, "ugimp": "#009e73", "cpgimp": "#c2609a",
                                                 "bspline": "#b87d00", "cpdi": "#2f93cc"})
METHOD_MARKS = defaultdict(lambda: "o", {"mpm": "o", "ugimp": "s", "cpgimp": "^", "bspline": "D", "cpdi": "v"})


@lru_cache(1)
def colour_table() -> np.ndarray:
    """Returns the colour map as 256 rows of red, green, blue, 0 to 255 (uint8, read-only), from no error to the
    largest. It is matplotlib's, which would take long to import for the first visitor of a page."""
    rows = bytes.fromhex((Path(__file__).parent / "colour_map.txt").read_text(encoding="ascii"))
    return np.frombuffer(rows, np.uint8).reshape(-1, 3)


def rgb(colour: str) -> tuple[int, int, int]:
    """Returns red, green and blue, 0 to 255 each, of a colour "#rrggbb"."""
    return int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16)


def cause_css_variable(cause: str) -> str:
    """Returns the name of the CSS variable for the colour of a cause of error: "made-time-step"."""
    return f"made-{cause.replace('_', '-')}"


def css_variables() -> str:
    """Returns a CSS rule with the light shades of the palette and of the causes of error as variables."""
    named = PALETTE | {cause_css_variable(cause): shades for cause, shades in CAUSES.items()}
    return f":root {{ {' '.join(f'--{name}: {shades.light};' for name, shades in named.items())} }}\n"
