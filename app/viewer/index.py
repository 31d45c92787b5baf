"""The html that a browser loads first: the viewer's, with our title and icon, and a calm ground until there is a stage.

All else of the page comes over the wire later; until then the viewer would show its own panel and a half-drawn stage.
The viewer's own way of answering, which looks for a file, is not gone.
"""

import gzip
import re
from collections.abc import Callable
from http import HTTPStatus
from pathlib import Path

import viser
from websockets.datastructures import Headers
from websockets.http11 import Request, Response

from app.doors.page import has_page, policy
from app.language.spoken import LANGUAGES, carried
from app.language.wish import as_cookie
from app.viewer.answers import POLICY, said
from app.viewer.unpacking import unpacked_script

_VIEWERS = Path(viser.__file__).parent / "client" / "build" / "index.html"


class Index:
    """The viewer's html with what ``ground`` gives in it, in every language, for the viewer has no setting for any;
    ``icon`` is an address."""

    def __init__(self, ground: Callable[[], str], icon: str):
        self._pages = {code: _Page(code, carried(ground, code)(), icon) for code in LANGUAGES}

    def answer(self, request: Request, code: str) -> Response:
        """What a request for a page gets, which has one well-formed host, in a language."""
        if not has_page(request.path.partition("?")[0]):
            return said(HTTPStatus.NOT_FOUND, "There is no such page.")
        return self._pages[code].answer(request)


class _Page:
    """In one language."""

    def __init__(self, code: str, own: str, icon: str):
        self._code = code
        html = _VIEWERS.read_text(encoding="utf-8")
        script = unpacked_script(html)
        html = re.sub(r"<title>.*?</title>", "<title>mpm-lab</title>", html, count=1)
        html = re.sub(r'(rel="icon"\s+href=)"[^"]*"', lambda found: f'{found[1]}"{icon}"', html, count=1)
        html = re.sub(r'<html lang="\w+"', f'<html lang="{code}"', html, count=1)
        html = html.replace('<div id="root"></div>', f'<div id="root"></div>\n{own}', 1)
        self._body = html.encode()
        self._packed = gzip.compress(self._body)
        self._policy = policy(html, "{host}", None if script is None else (script,), unpacks=True)

    def answer(self, request: Request) -> Response:
        packs = "gzip" in ",".join(request.headers.get_all("Accept-Encoding"))
        sent = self._packed if packs else self._body
        headers = Headers({"Content-Type": "text/html; charset=utf-8", "Content-Length": str(len(sent)),
                           "Content-Encoding": "gzip" if packs else "identity", "Connection": "close",
                           POLICY: self._policy.replace("{host}", request.headers["Host"]),
                           "Content-Language": self._code, "Set-Cookie": as_cookie(self._code)})
        return Response(HTTPStatus.OK.value, HTTPStatus.OK.phrase, headers, sent)
