"""What the stages share: the place of things, the colour bar, and points, lines and labels in the plane z = 0."""

import textwrap
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Literal
from weakref import ReferenceType, WeakKeyDictionary, ref

import numpy as np
import viser

from app.scale import MOST_TICKS, ColourScale
from app.viewer.handles import put_props
from app.words import power_text

RECTANGLE = (-0.105, 1.055, -0.11, 1.09)  # x0, x1, y0, y1 of the stage; every problem is drawn to fit
COLOUR_BAR, COLOUR_BAR_HEIGHT = 1.015, 0.024
TICK_GAP = 0.024  # labels have a white ground, which must stay clear of the colours
FLASH_SECONDS = 0.25  # how long a crossing stays marked on the screen
DOT, FAINT, CELL, FLASH = (24, 28, 34), (190, 197, 206), (168, 176, 187), (204, 0, 120)
UNKNOWN = 225  # grey of a particle whose error nobody knows
LETTER_WIDTH = 6.0  # pixels, of an average letter of usual size
LINE_HEIGHT = 15.0  # of a line of such letters, with what is around it
AWAY = -50.0  # where points that are not shown wait, far outside the view

Anchor = Literal["top-left", "top-center", "top-right", "center-left", "center-center", "center-right", "bottom-left",
                 "bottom-center", "bottom-right"]


class ColourBar:
    """The scale that estimate and truth share, at the top of the stage, with its numbers."""

    def __init__(self, s: viser.SceneApi, scale: ColourScale):
        self._scale = scale
        self._drawn: tuple[str, str, float, bool, bool] | None = None
        self.root = s.add_frame("/colours", show_axes=False)
        ends = COLOUR_BAR_HEIGHT / 2
        bar = points(s, "/colours/bar", COLOUR_BAR_HEIGHT, "square")
        bar.points = in_plane(np.linspace(ends, 1 - ends, 256), COLOUR_BAR)
        bar.colors = scale.gradient(256)
        self._ticks = [label(s, f"/colours/tick{k}", "", 0.0, COLOUR_BAR - TICK_GAP, "top-center", 0.85)
                       for k in range(MOST_TICKS)]
        self._title = label(s, "/colours/title", "", 0.0, COLOUR_BAR + TICK_GAP, "bottom-left")

    def draw(self, measures: str, unit: str) -> None:
        """Show the scale as it is now, with what it measures."""
        scale = self._scale
        if (now := (measures, unit, scale.top, scale.logarithmic, scale.exceeded)) == self._drawn:
            return
        self._drawn = now
        write(self._title, f"{measures} / {power_text(scale.power)}{unit}")
        for tick, (at, text) in zip(self._ticks, scale.ticks() + [(AWAY, "")] * MOST_TICKS, strict=False):
            tick.text, tick.position = text, (at, COLOUR_BAR - TICK_GAP, 0.0)


def shades(scale: ColourScale, sizes: np.ndarray | None, count: int) -> np.ndarray:
    """Colours (P, 3) of error sizes; plain grey where nothing is known."""
    if sizes is None or not np.isfinite(sizes).any():
        return np.full((count, 3), UNKNOWN, np.uint8)
    return scale.colours(sizes)


def flash_colours(seconds_ago: np.ndarray) -> np.ndarray:
    """Colours (P, 3) that fade from the flash to the white of the ground."""
    fade = np.clip(seconds_ago / FLASH_SECONDS, 0, 1)[:, None]
    return (np.array(FLASH) + fade * (255 - np.array(FLASH))).astype(np.uint8)


def one_in(particles: int, most: int) -> int:
    """Of how many particles one is marked where it crosses, so that at most ``most`` of all can be: marks of more would
    bury what they lie on."""
    return -(-particles // most)


def points(s: viser.SceneApi, name: str, size: float, shape: Literal["circle", "square"] = "circle",
           precision: Literal["float16", "float32"] = "float32") -> viser.PointCloudHandle:
    """Points of ``size`` across: the viewer counts from the middle.

    Points, because they alone show a colour exactly as it is given; lines and meshes are toned and lit.
    """
    return s.add_point_cloud(name, np.full((1, 3), AWAY, np.float32), np.zeros((1, 3), np.uint8),
                             point_size=size / 2, point_shape=shape, precision=precision, point_shading="flat")


def put(handle: viser.PointCloudHandle | viser.LineSegmentsHandle, points: np.ndarray,
        colours: np.ndarray | None = None) -> None:
    """Move points (n, 3) or line segments (n, 2, 3), and colour points, (n, 3) or all alike (3,), in one message.

    For what changes with every frame: in the handle's own precision and 8 bits, and nobody writes to the arrays again.
    """
    put_props(handle, {"points": points} if colours is None else {"points": points, "colors": colours})


def put_few(cloud: viser.PointCloudHandle, points: np.ndarray, colours: np.ndarray | None = None) -> None:
    """As :func:`put`, for points of which there are often none: nothing is sent then."""
    if len(points):
        put(cloud, points, colours)
    elif not (len(cloud.points) == 1 and cloud.points[0, 0] == AWAY):
        put(cloud, np.full((1, 3), AWAY, np.float32), colours if colours is None else np.zeros((1, 3), np.uint8))


def lines(s: viser.SceneApi, name: str, colour: tuple[int, int, int], thickness: float) -> viser.LineSegmentsHandle:
    """Line segments of a thickness in pixels, none yet."""
    return s.add_line_segments(name, np.full((1, 2, 3), AWAY, np.float32), colour, thickness=thickness,
                               thickness_units="screen")


def label(s: viser.SceneApi, name: str, text: str, x: float, y: float, anchor: Anchor,
          size: float = 1.0) -> viser.LabelHandle:
    factor = _LETTERING.setdefault(s, _Lettering()).factor
    handle = s.add_label(name, text, position=(x, y, 0.0), anchor=anchor, font_screen_scale=factor * size)
    resize(s, handle, size)
    return handle


@dataclass
class _Lettering:
    """The labels of a scene by name, with their usual sizes, and how many times as large they are written. A label
    knows its scene: held here, it would keep that for ever."""

    factor: float = 1.0
    sizes: dict[str, tuple[ReferenceType[viser.LabelHandle], float]] = field(default_factory=dict)


_LETTERING: WeakKeyDictionary[viser.SceneApi, _Lettering] = WeakKeyDictionary()


def resize(s: viser.SceneApi, handle: viser.LabelHandle, size: float) -> None:
    """Give a label of a scene another usual size."""
    lettering = _LETTERING.setdefault(s, _Lettering())
    lettering.sizes[handle.name] = ref(handle), size
    if handle.font_screen_scale != lettering.factor * size:
        handle.font_screen_scale = lettering.factor * size


def enlarge(s: viser.SceneApi, factor: float) -> None:
    """Write all labels of a scene so many times as large as usual."""
    lettering = _LETTERING.setdefault(s, _Lettering())
    if lettering.factor != factor:
        lettering.factor = factor
        for known, size in list(lettering.sizes.values()):
            if handle := known():
                resize(s, handle, size)


def letters(s: viser.SceneApi, pixels: float, size: float = 1.0) -> int:
    """How many letters of a label of this usual size there is room for in so many pixels."""
    return max(1, int(pixels / (LETTER_WIDTH * size * _LETTERING.setdefault(s, _Lettering()).factor)))


def extent(s: viser.SceneApi, text: str, size: float = 1.0) -> tuple[float, float]:
    """Pixels that a label of this usual size takes, about: its width and height."""
    scale, lines = size * _LETTERING.setdefault(s, _Lettering()).factor, text.split("\n")
    return LETTER_WIDTH * scale * max(map(len, lines)), LINE_HEIGHT * scale * len(lines)


def write(handle: viser.LabelHandle, text: str, width: int = 1000) -> None:
    """Put a text into a label, in lines of at most ``width`` characters; send it only when it has changed."""
    text = wrapped(text, width)
    if handle.text != text:
        handle.text, handle.visible = text, bool(text)  # else its ground would show


@lru_cache(1000)
def wrapped(text: str, width: int) -> str:
    """The text in lines of at most so many characters."""
    return "\n".join(textwrap.wrap(text, width))


def in_plane(x: np.ndarray, y: np.ndarray | float, z: float = 0.0) -> np.ndarray:
    """Points (n, 3) from coordinates (n,) or one for all; written in place, for it is done with every frame."""
    points = np.empty((len(x), 3), np.float32)
    points[:, 0], points[:, 1], points[:, 2] = x, y, z
    return points


def joined(starts: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """Line segments (n, 2, 3) between points (n, 3)."""
    return np.stack([starts, ends], axis=1)


def rgb(colour: str) -> tuple[int, int, int]:
    """Red, green and blue, 0 to 255, of "#rrggbb"."""
    return int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16)
