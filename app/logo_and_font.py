"""Visual identity of the page, exported files and pictures: a logo, and the font Inter. Both are local files."""

from base64 import b64encode
from pathlib import Path
from urllib.parse import quote

#: The logo, two lanes and a question mark, as svg.
MARK = (Path(__file__).parent / "page" / "web" / "mark.svg").read_text(encoding="utf-8")
ICON = f"data:image/svg+xml,{quote(MARK)}"  # the same in a browser's tab
FONTS = Path(__file__).parent / "fonts"
_RANGES = {"latin": "U+0000-00FF,U+0131,U+0152-0153,U+02BB-02DC,U+2000-206F,U+2070-209F,U+20AC,U+2122,U+2190-2193,"
                    "U+2212,U+2215,U+2248,U+2264-2265,U+FEFF,U+FFFD", "greek": "U+0370-03FF"}


def font_faces_css() -> str:
    """Returns the CSS rules that embed the font Inter, as the family 'Lab Inter'."""
    return "".join(
        f"@font-face {{ font-family: 'Lab Inter'; font-weight: 100 900; font-display: block; unicode-range: {ranges}; "
        f"src: url(data:font/woff2;base64,{b64encode((FONTS / f'inter-{part}.woff2').read_bytes()).decode()}) "
        "format('woff2'); }\n" for part, ranges in _RANGES.items())
