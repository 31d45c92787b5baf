"""Answers of our own to requests, and what all answers say of themselves."""

from http import HTTPStatus

from websockets.datastructures import Headers
from websockets.http11 import Request, Response

from app.doors import page

POLICY = "Content-Security-Policy"


def said(status: HTTPStatus, text: str, kind: str = "text/plain", cookie: str = "", wait: float = 0) -> Response:
    """An answer of our own, which nobody keeps."""
    body = text.encode() + (b"\n" if kind == "text/plain" and text else b"")
    headers = Headers({"Content-Type": f"{kind}; charset=utf-8", "Content-Length": str(len(body)),
                       "Cache-Control": "no-store", "Connection": "close"})
    if kind == "text/html":
        headers[POLICY] = page.policy(text)
    if cookie:
        headers["Set-Cookie"] = cookie
    if wait:
        headers["Retry-After"] = str(max(1, round(wait)))
    return Response(status.value, status.phrase, headers, body)


def dressed(connection: object, request: Request, response: Response) -> Response:
    """Any answer, and what all say."""
    for name, value in {**page.ALWAYS, POLICY: page.policy()}.items():
        if name not in response.headers:
            response.headers[name] = value
    return response
