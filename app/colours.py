"""The colours of the page and of every picture: one for the estimate, one for the truth, one map for sizes.

The pair is from Okabe and Ito's set, which people with any of the common colour blindnesses tell apart; the
map's lightness rises evenly, so that equal steps of error look equally far apart, in print as well.
"""

from collections import defaultdict

import numpy as np

ESTIMATE = "#D55E00"
TRUTH = "#0072B2"
PINNED = "#8A929C"  # a run that stays beside the one that is changed: grey
COLOUR_MAP = "viridis"
#: Methods side by side, in what the set has left; each has a mark of its own as well. A method without either is grey.
METHOD_COLOURS = defaultdict(lambda: "#777777", {"mpm": "#000000", "ugimp": "#009E73", "cpgimp": "#CC79A7",
                                                 "bspline": "#E69F00", "cpdi": "#56B4E9"})
METHOD_MARKS = defaultdict(lambda: "o", {"mpm": "o", "ugimp": "s", "cpgimp": "^", "bspline": "D", "cpdi": "v"})


def colour_table() -> np.ndarray:
    """The colour map as 256 rows of red, green, blue, 0 to 255 (uint8), from no error to the largest."""
    from matplotlib import colormaps  # here, because it takes long to import and few commands draw

    return (255 * colormaps[COLOUR_MAP](np.arange(256))[:, :3]).round().astype(np.uint8)


def rgb(colour: str) -> tuple[int, int, int]:
    """Red, green and blue, 0 to 255, of "#rrggbb"."""
    return int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16)
