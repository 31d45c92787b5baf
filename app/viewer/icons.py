"""Icons of widgets, out of an archive that is opened once.

The viewer opens it anew for each icon and reads what is in it, some thousands of names: for a page's icons, which it
keeps afterwards, half a second, for which the first visitor of a server waited.
"""

from functools import lru_cache
from zipfile import ZipFile

from viser import _gui_api, _gui_handles, _icons

_ARCHIVE = _icons.ICONS_DIR / "tabler-icons.zip"


@lru_cache(1)
def _archive() -> ZipFile:
    """Open from now on."""
    return ZipFile(_ARCHIVE)


@lru_cache(256)
def svg(name: str) -> str:
    """An icon by its name."""
    return _archive().read(f"{name}.svg").decode()


def mend() -> None:
    """Have widgets take their icons from here."""
    for module in (_icons, _gui_api, _gui_handles):
        module.svg_from_icon = svg  # type: ignore[attr-defined]
