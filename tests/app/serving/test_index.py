"""The html that a browser loads first."""

from __future__ import annotations

from urllib.parse import unquote

from websockets.datastructures import Headers
from websockets.http11 import Request, Response

from app.colours import ESTIMATE, TRUTH
from app.identity import ICON, MARK
from app.page.panels.head import GROUND
from app.viewer.index import Index


def test_it_has_our_title_our_mark_and_our_ground():
    plain = Response(200, "OK", Headers({"Content-Encoding": "identity"}), b"the viewer's")
    body = Index(GROUND, ICON).instead(Request("/", Headers()), plain).body.decode()
    icon = unquote(body.split('rel="icon"')[1].split('href="')[1].split('"')[0])
    assert icon == f"data:image/svg+xml,{MARK}" and ESTIMATE in MARK and TRUTH in MARK
    assert "<title>mpm-lab</title>" in body and GROUND in body
    assert Index(GROUND, ICON).instead(Request("/other.js", Headers()), plain) is plain
