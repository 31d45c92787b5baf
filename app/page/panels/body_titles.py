"""Titles of the bodies that come along, on the page."""

from app.language.translation import lazy, tr

TITLES = {"cantilever": lazy("Cantilever"), "plate_with_hole": lazy("Plate with a hole"),
          "swinging_sector": lazy("Swinging sector"), "thrown_block": lazy("Thrown block")}


def library_title(name: str) -> str:
    """Returns the title of a body by the name of its file."""
    return tr(TITLES[name])
