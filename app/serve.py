"""Serving the page: engines, the web server and one :class:`~app.page.Page` per visitor."""

from __future__ import annotations

import contextlib
import io
import os
import socket
import sys
import threading
import warnings

from solvers.engine.pool import EnginePool


class ServeError(Exception):
    """The page cannot be served; the message says why."""


def serve(host: str, port: int, max_sessions: int) -> None:
    """Serve the page until interrupted. Raises :class:`ServeError` when host and port cannot be had."""
    _require_free(host, port)
    from app.page import FIRST_SCENE  # the engines start first: they need longest

    pool, server = EnginePool(FIRST_SCENE, engines=max(1, (os.cpu_count() or 2) - 1)), None
    try:
        server = _start_server(host, port, pool, max_sessions)
        address = f"http://{_address(host)}:{server.get_port()}"
        print(f"mpm-lab is at {address} (Ctrl-C ends it)", file=sys.stderr, flush=True)
        threading.Event().wait()
    finally:
        pool.close()
        if server is not None:
            with contextlib.redirect_stdout(io.StringIO()):
                server.stop()


def _start_server(host: str, port: int, pool: EnginePool, max_sessions: int):
    import viser

    from app.page import Page
    from app.panels.furniture import add_head, furnish

    # A frame may be drawn for a visitor who left a moment ago; that is nobody's fault.
    warnings.filterwarnings("ignore", message="Queued a .* on a closed connection")
    with contextlib.redirect_stdout(io.StringIO()):  # it would announce itself in a box of its own
        server = viser.ViserServer(host=host, port=port, verbose=False)
    furnish(server.gui)
    pages: dict[int, Page] = {}
    lock = threading.Lock()

    @server.on_client_connect
    def connect(client: viser.ClientHandle) -> None:
        with lock:
            full = len(pages) >= max_sessions
        if full:
            add_head(client.gui)
            client.gui.add_html("<div class='lab-notice lab-refused'>"
                                f"All {max_sessions} places are taken. Reload the page in a while.</div>")
            return
        page = Page(client, pool)
        with lock:
            pages[client.client_id] = page

    @server.on_client_disconnect
    def disconnect(client: viser.ClientHandle) -> None:
        with lock:
            page = pages.pop(client.client_id, None)
        if page:
            page.close()

    return server


def _address(host: str) -> str:
    return "127.0.0.1" if host in ("", "0.0.0.0") else host


def _require_free(host: str, port: int) -> None:
    """The web server would silently take the next port; a person who typed a number means it."""
    try:
        with socket.socket() as trial:
            trial.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            trial.bind((host, port))
    except OSError as error:
        raise ServeError(f"cannot listen on {host}:{port} ({(error.strerror or str(error)).lower()}); "
                         "choose another with --port or --host") from error
