"""The html that a browser loads first: the viewer's, with our title and icon, and a calm ground until there is a stage.

All else of the page comes over the wire later; until then the viewer would show its own panel and a half-drawn stage.
"""

import gzip
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import viser
import websockets.asyncio.server
from websockets.datastructures import Headers
from websockets.http11 import Request, Response

_ICON = ("data:image/svg+xml,%3Csvg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 16 16'%3E"
         "%3Crect width='16' height='16' rx='3' fill='%230072B2'/%3E%3Cpath d='M2 8q3-7 6 0t6 0' fill='none' "
         "stroke='white' stroke-width='1.6'/%3E%3Ccircle cx='5' cy='4.6' r='1.7' fill='%23D55E00'/%3E%3C/svg%3E")
_WEB = Path(__file__).parents[1] / "web"
_GROUND, *_SCRIPTS = ((_WEB / name).read_text(encoding="utf-8")
                       for name in ("ground.html", "names.js", "attendance.js", "tabs.js", "keeper.js", "figures.js",
                                    "drop.js"))
_VIEWERS = Path(viser.__file__).parent / "client" / "build" / "index.html"
_PATHS = ("/", "/index.html")


def index() -> str:
    """The viewer's html with ours in it."""
    html = _VIEWERS.read_text(encoding="utf-8")
    html = re.sub(r"<title>.*?</title>", "<title>mpm-lab</title>", html, count=1)
    html = re.sub(r'(rel="icon"\s+href=)"[^"]*"', lambda found: f'{found[1]}"{_ICON}"', html, count=1)
    own = f"{_GROUND}<script>\n{''.join(_SCRIPTS)}</script>"
    return html.replace('<div id="root"></div>', f'<div id="root"></div>\n{own}', 1)


@contextmanager
def own_index() -> Iterator[None]:
    """The web server that the viewer starts meanwhile sends :func:`index`; the viewer has no setting for it."""
    serve, body = websockets.asyncio.server.serve, index().encode()
    packed = gzip.compress(body)

    def serving(*args: Any, process_request: Callable[[Any, Request], Response | None], **options: Any) -> Any:
        def answer(connection: Any, request: Request) -> Response | None:
            response = process_request(connection, request)
            if response is None or request.path.partition("?")[0] not in _PATHS:
                return response
            zipped = response.headers["Content-Encoding"] == "gzip"
            sent = packed if zipped else body
            headers = Headers({**dict(response.headers.raw_items()), "Content-Length": str(len(sent))})
            return Response(response.status_code, response.reason_phrase, headers, sent)

        return serve(*args, process_request=answer, **options)

    websockets.asyncio.server.serve = serving  # type: ignore[assignment, misc]
    try:
        yield
    finally:
        websockets.asyncio.server.serve = serve  # type: ignore[misc]
