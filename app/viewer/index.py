"""The html that a browser loads first: the viewer's, with our title and icon, and a calm ground until there is a stage.

All else of the page comes over the wire later; until then the viewer would show its own panel and a half-drawn stage.
"""

import gzip
import re
from pathlib import Path

import viser
from websockets.datastructures import Headers
from websockets.http11 import Request, Response

_VIEWERS = Path(viser.__file__).parent / "client" / "build" / "index.html"
PATHS = ("/", "/index.html")


class Index:
    """The viewer's html with ``own`` in it, for the viewer has no setting for any; ``icon`` is an address."""

    def __init__(self, own: str, icon: str):
        html = _VIEWERS.read_text(encoding="utf-8")
        html = re.sub(r"<title>.*?</title>", "<title>mpm-lab</title>", html, count=1)
        html = re.sub(r'(rel="icon"\s+href=)"[^"]*"', lambda found: f'{found[1]}"{icon}"', html, count=1)
        self._body = html.replace('<div id="root"></div>', f'<div id="root"></div>\n{own}', 1).encode()
        self._packed = gzip.compress(self._body)

    def instead(self, request: Request, response: Response | None) -> Response | None:
        """What a request gets, for which the viewer has a ``response``, or none for a websocket."""
        if response is None or request.path.partition("?")[0] not in PATHS:
            return response
        sent = self._packed if response.headers["Content-Encoding"] == "gzip" else self._body
        headers = Headers({**dict(response.headers.raw_items()), "Content-Length": str(len(sent))})
        return Response(response.status_code, response.reason_phrase, headers, sent)
