"""Which paths have a page, and what a browser is told that it may do with it.

All of the page is one text and what comes over its websocket, so that no part of a path is ever looked for on the disk.
"""

import base64
import hashlib
import re

PATHS = ("/", "/index.html")

#: What every answer says: it is what it says it is, is shown in no frame, and tells other sites no address.
ALWAYS = {"X-Content-Type-Options": "nosniff", "X-Frame-Options": "DENY", "Referrer-Policy": "same-origin"}
_NOTHING = "default-src 'none'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'"


def has_page(path: str) -> bool:
    """Whether this path of a request, without its query, is one of the page."""
    return path in PATHS


def policy(html: str = "", host: str = "", more: tuple[str, ...] | None = (), unpacks: bool = False) -> str:
    """What a page may do, as Content-Security-Policy.

    Parameters
    ----------
    html
        Of the page: its scripts run and no others.
    host
        Under which it has been asked for, with the port: some browsers take a websocket there for another place.
    more
        Scripts beside, which those of the page make; None where they are not known: then any in the page run.
    unpacks
        Whether the page is the lab with its packed scripts, workers and pictures, and not just words.
    """
    scripts = "'unsafe-inline'" if more is None else " ".join(
        f"'sha256-{_digest(script)}'" for script in (*_scripts(html), *more))
    allowed = {"script-src": scripts, "style-src": "'unsafe-inline'", "img-src": "data:", "connect-src": "'self'"}
    if unpacks:
        allowed["script-src"] += " 'wasm-unsafe-eval'"
        allowed |= {"worker-src": "blob:", "font-src": "data:", "img-src": "data: blob:",
                    "connect-src": f"'self' ws://{host} wss://{host} data:"}
    parts = (f"{kind} {where}" for kind, where in allowed.items()) if html else ()
    return "; ".join((_NOTHING, *parts))


def _scripts(html: str) -> list[str]:
    return re.findall(r"<script\b[^>]*>(.*?)</script>", html, re.DOTALL)


def _digest(script: str) -> str:
    """As a browser computes it: of what it has read, in which every end of a line is one character."""
    plain = script.replace("\r\n", "\n").replace("\r", "\n")
    return base64.b64encode(hashlib.sha256(plain.encode()).digest()).decode()
