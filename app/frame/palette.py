"""The colours of what is drawn beside the map of errors, as numbers, on a light and on a dark ground."""

from dataclasses import dataclass

from app.colours import PALETTE, rgb

Colour = tuple[int, int, int]


@dataclass(frozen=True)
class Palette:
    """The ground; particles in a plot and lines beside words; axes; lines of cells through a plot and behind a body;
    edges of cells; crossings; a particle whose error nobody knows; what is exact; outlines of domains on the map's
    colours."""

    ground: Colour
    dot: Colour
    axis: Colour
    grid: Colour
    cell: Colour
    crossing: Colour
    unknown: Colour
    exact: Colour
    outline: Colour


def _palette(ground: str) -> Palette:
    def of(name: str) -> Colour:
        return rgb(getattr(PALETTE[name], ground))

    return Palette(of("ground"), of("dot"), of("line2"), of("line"), of("cell"), of("cross"), of("cell"), of("truth"),
                   of("ground"))


LIGHT, DARK = _palette("light"), _palette("dark")
