"""The html that a browser loads first: the viewer's, with our title and icon, and a plain ground before there is a
stage; and its Content-Security-Policy.

Everything else of the page comes over the websocket; until then the viewer would show its own panel. The viewer's own
handler, which looks for files, remains, but no part of a path is ever looked up on disk, as the page is one text."""

import gzip
import re
from collections.abc import Callable
from http import HTTPStatus
from pathlib import Path

import numpy as np
import viser
import zstandard
from websockets.datastructures import Headers
from websockets.http11 import Request, Response

from app.language.translation import LANGUAGES, with_language
from app.templates import script_source

PATHS = ("/", "/index.html")
SCRIPT = r"<script\b[^>]*>(.*?)</script>"

#: Headers of every response: no sniffing of its type, no framing, no referrer for other sites.
ALWAYS = {"X-Content-Type-Options": "nosniff", "X-Frame-Options": "DENY", "Referrer-Policy": "same-origin"}
_NOTHING = "default-src 'none'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'"


def is_page_path(path: str) -> bool:
    """Whether a request's path, without its query, is that of the page."""
    return path in PATHS


def content_security_policy(html: str = "", sockets: str = "", more: tuple[str, ...] | None = ()) -> str:
    """Returns the value of the Content-Security-Policy header of a page: its scripts run and no others.

    ``sockets`` are addresses of its websockets: some browsers treat one to the page's host as another origin. A page
    that has some is the lab with its packed scripts, workers and pictures, not plain text. ``more`` are scripts that
    those in the page create; if None (unknown), any script in the page runs."""
    scripts = "'unsafe-inline'" if more is None else " ".join(
        script_source(script) for script in (*re.findall(SCRIPT, html, re.DOTALL), *more))
    allowed = {"script-src": scripts, "style-src": "'unsafe-inline'", "img-src": "data:", "connect-src": "'self'"}
    if sockets:
        allowed["script-src"] += " 'wasm-unsafe-eval'"
        allowed |= {"worker-src": "blob:", "font-src": "data:", "img-src": "data: blob:",
                    "connect-src": f"'self' {sockets} data:"}
    parts = (f"{kind} {where}" for kind, where in allowed.items()) if html else ()
    return "; ".join((_NOTHING, *parts))


POLICY = "Content-Security-Policy"
_VIEWERS = Path(viser.__file__).parent / "client" / "build" / "index.html"
_DIGITS = "!#$%()*+,-./0123456789:;=?@ABCDEFGHIJKLMNOPQRSTUVWXYZ[\\]^_abcdefghijklmnopqrstuvwxyz{|}~"
_GROUP, _BYTES = 5, 4  # five digits in this base are four bytes
_PACKED = re.compile(r'<script data-p="([^"]*)" data-ss="(\d+)" data-cs="(\d+)">')


def make_response(status: HTTPStatus, text: str, kind: str = "text/plain", cookie: str = "",
                  wait: float = 0) -> Response:
    """Returns an uncached response of a MIME type ``kind``; ``cookie`` is set, ``wait`` in s asks to retry later."""
    body = text.encode() + (b"\n" if kind == "text/plain" and text else b"")
    headers = Headers({"Content-Type": f"{kind}; charset=utf-8", "Content-Length": str(len(body)),
                       "Cache-Control": "no-store", "Connection": "close"})
    if kind == "text/html":
        headers[POLICY] = content_security_policy(text)
    if cookie:
        headers["Set-Cookie"] = cookie
    if wait:
        headers["Retry-After"] = str(max(1, round(wait)))
    return Response(status.value, status.phrase, headers, body)


def with_security_headers(connection: object, request: object, response: Response) -> Response:
    """Adds the headers common to all responses to ``response``, and returns it."""
    for name, value in {**ALWAYS, POLICY: content_security_policy()}.items():
        if name not in response.headers:
            response.headers[name] = value
    return response


class IndexPage:
    """Page that a browser loads first, by language: the viewer's html with ``ground()`` in it; ``icon`` is a URL."""

    def __init__(self, ground: Callable[[], str], icon: str):
        self._pages = {code: _localised_page(code, with_language(ground, code)(), icon) for code in LANGUAGES}

    def answer_in_language(self, request: Request, code: str) -> Response:
        """Returns the response to a request with one valid Host header: the page in a language (code), or 404."""
        if not is_page_path(request.path.partition("?")[0]):
            return make_response(HTTPStatus.NOT_FOUND, "There is no such page.")
        plain, packed, policy = self._pages[code]
        packs = "gzip" in ",".join(request.headers.get_all("Accept-Encoding"))
        sent = packed if packs else plain
        host = request.headers["Host"]
        sockets = "" if host.startswith("[") else f"ws://{host} wss://{host}"  # a policy cannot say digits of IPv6
        headers = Headers({"Content-Type": "text/html; charset=utf-8", "Content-Length": str(len(sent)),
                           "Content-Encoding": "gzip" if packs else "identity", "Connection": "close",
                           POLICY: policy.replace("{sockets}", sockets),
                           "Content-Language": code})
        return Response(HTTPStatus.OK.value, HTTPStatus.OK.phrase, headers, sent)


def _localised_page(code: str, own: str, icon: str) -> tuple[bytes, bytes, str]:
    """Returns the page in the language ``code``, with the html ``own`` in it: plain, gzipped, and its policy."""
    html = _VIEWERS.read_text(encoding="utf-8")
    script = unpacked_script(html)
    html = re.sub(r"<title>.*?</title>", "<title>mpm-lab</title>", html, count=1)
    html = re.sub(r'(rel="icon"\s+href=)"[^"]*"', lambda found: f'{found[1]}"{icon}"', html, count=1)
    html = re.sub(r'<html lang="\w+"', f'<html lang="{code}"', html, count=1)
    html = html.replace('<div id="root"></div>', f'<div id="root"></div>\n{own}', 1)
    policy = content_security_policy(html, "{sockets}", None if script is None else (script,))
    return html.encode(), gzip.compress(html.encode()), policy


def unpacked_script(html: str) -> str | None:
    """Returns the script that the viewer's html unpacks and runs; None if the html is not packed as in viser 1.1."""
    found = _PACKED.search(html)
    if found is None:
        return None
    style, script = int(found[2]), int(found[3])
    whole = zstandard.ZstdDecompressor().decompress(_decode_base85(found[1]), max_output_size=style + script)
    return whole[style:style + script].decode("utf-8")


def _decode_base85(text: str) -> bytes:
    """Decodes the viewer's base-85 digits, five for four bytes; a last group of n digits is n - 1 bytes."""
    value = np.zeros(128, dtype=np.int64)
    value[[ord(digit) for digit in _DIGITS]] = range(len(_DIGITS))
    digits = value[np.frombuffer(text.encode("ascii"), dtype=np.uint8)]
    whole = len(digits) // _GROUP * _GROUP
    groups = digits[:whole].reshape(-1, _GROUP) @ len(_DIGITS) ** np.arange(_GROUP)[::-1]
    rest = 0
    for digit in digits[whole:]:
        rest = rest * len(_DIGITS) + int(digit)
    return groups.astype(f">u{_BYTES}").tobytes() + rest.to_bytes(max(0, len(digits) - whole - 1), "big")
