"""The web server with its doors: who asks, with what code, and what is said to it, before the viewer hears of it."""

import asyncio
import json
import logging
import re
from collections.abc import Awaitable, Callable, Iterator
from contextlib import contextmanager, suppress
from http import HTTPStatus
from pathlib import Path
from time import monotonic, sleep
from typing import Any, Protocol, cast
from urllib.parse import unquote

import viser
import websockets.asyncio.server
from websockets.datastructures import Headers
from websockets.exceptions import ConnectionClosed, InvalidMessage
from websockets.frames import CloseCode
from websockets.http11 import Request, Response

from app.doors.address import Addresses, is_ip, is_loopback
from app.doors.bucket import Bucket
from app.doors.code import ClassCode
from app.doors.refusals import Refusals
from app.viewer import messages, upload
from app.viewer.index import PATHS, Index
from app.viewer.wire import PROTOCOL, Buffer

LARGEST_MESSAGE = 1_000_000  # bytes; the websocket is closed before more of one has been read
WAITING = 4  # messages that are read ahead
# A browser sends 20 values of a widget and 50 camera messages a second at most, and some in one go after a pause.
MESSAGES, A_SECOND, PATIENCE = 200, 100, 4.0  # at once, in the long run; seconds for which more are put up with
BYTES_AS_ONE, REFUSED_AS = 1000, 3  # what large and refused messages count as
PART_AS = 4  # and a part of a file that is taken: 25 a second, 13 MB, in the long run
# Websockets opened, each with a page to make: a class that reloads ten times never gets there. One that is sent away
# takes so many more, as far as there are: who comes again and again would have the server make nothing but pages.
HANDSHAKES, HANDSHAKES_A_SECOND, MISDEED = 400, 1, 30
GOING, AWAY = 1.0, 10.0  # seconds that one who is sent away has to say goodbye, and in which its address must wait
SILENT = 60.0  # seconds in which a browser, however busy, says where its camera is; one that never speaks is none
TOO_MUCH, NOTHING_SAID = "too many messages", "nothing was said"
NO_CODE = "The class code is missing. Load the page again and type it."

_LOOKS = re.compile(r"/(here|away)/([\w-]{1,40})$")
_CODE_PAGE = (Path(__file__).parents[1] / "doors" / "code.html").read_text(encoding="utf-8")


class Lab(viser.ViserServer):
    """The viewer's server without its tunnel: nothing that is asked for makes the lab public. Its ``visitors`` are who
    has come through the doors."""

    visitors: Any = None

    def wait_until_told(self, seconds: float) -> None:
        """Until every browser has been sent the goodbye and all before it; not longer for one that takes nothing."""
        end = monotonic() + seconds
        states = self._websock_server._client_state_from_id
        while monotonic() < end and not (self.visitors.all_told() and all(
                cast(Buffer, state.message_buffer).all_sent for state in list(states.values()))):
            sleep(0.01)

    def request_share_url(self, verbose: bool = True) -> None:
        """There is none."""

    def disconnect_share_url(self) -> None:
        """There is nothing to disconnect."""


class Host(Protocol):
    """What the doors are those of: it knows who is in, and how it does."""

    def attend(self, token: str, watched: bool) -> bool: ...

    def health(self) -> dict[str, Any]: ...


class Doors:
    """The doors of one server. All but :meth:`guarding` is called on the web server's loop."""

    def __init__(self, addresses: Addresses, code: ClassCode | None):
        self._addresses, self._code, self._refusals = addresses, code, Refusals()
        self._handshakes = Bucket(HANDSHAKES, HANDSHAKES_A_SECOND)
        self._going: set[asyncio.Future] = set()  # websockets that are being closed
        self._away: dict[str, float] = {}  # until when an address must wait
        self._server: viser.ViserServer | None = None
        self._host: Host | None = None

    def watch(self, server: viser.ViserServer, host: Host) -> None:
        """This server's widgets are meant in what browsers say, and these visitors."""
        self._server, self._host = server, host

    @contextmanager
    def guarding(self, index: Index) -> Iterator[None]:
        """Web servers that start meanwhile have these doors, and send this ``index`` to those who come in; the viewer
        has no setting for any of it."""
        serve = websockets.asyncio.server.serve

        def serving(handler: Callable[[Any], Awaitable[None]], *args: Any, process_request: Callable[..., Any],
                    **options: Any) -> Any:
            async def handle(connection: Any) -> None:
                if connection.subprotocol != PROTOCOL:
                    self._refusals.note("a page of another version", self._who(connection))
                    await connection.close(1002, f"Version mismatch. Server: {viser.__version__}")
                    return
                silent = asyncio.get_running_loop().call_later(SILENT, self._cull, connection)
                self._listen(connection, silent)
                try:
                    await handler(connection)
                finally:
                    silent.cancel()

            def answer(connection: Any, request: Request) -> Response | None:
                answer = self._answer(connection, request)
                return answer or index.instead(request, process_request(connection, request))

            own = {"max_size": LARGEST_MESSAGE, "max_queue": WAITING, "logger": log}
            return serve(handle, *args, process_request=answer, **{**options, **own})

        log = logging.Logger("websockets.server", logging.ERROR)  # of this server alone
        log.addFilter(self._no_traces)
        websockets.asyncio.server.serve = serving  # type: ignore[assignment, misc]
        try:
            yield
        finally:
            websockets.asyncio.server.serve = serve  # type: ignore[misc]

    def _no_traces(self, record: logging.LogRecord) -> bool:
        """Who speaks no HTTP is refused; that is no error of ours. Who leaves before all is said has only left."""
        if ours := record.getMessage() != "opening handshake failed":
            return ours
        error = record.exc_info[1] if record.exc_info else None
        if not isinstance(error, InvalidMessage) or isinstance(error.__cause__, (EOFError, OSError)):
            return False
        self._refusals.note("a connection that does not speak HTTP")
        return False

    def _answer(self, connection: Any, request: Request) -> Response | None:
        """What a request gets instead of the lab; None for one that gets the lab."""
        who = self._who(connection)
        opens_socket = "websocket" in ",".join(request.headers.get_all("Upgrade")).lower()
        if refusal := self._addresses.refusal(request.headers):
            self._refusals.note(refusal, who)
            return _said(HTTPStatus.FORBIDDEN, refusal)
        path = request.path.partition("?")[0]
        if path == "/health" and self._host and not opens_socket:
            return _said(HTTPStatus.OK, json.dumps(self._host.health()), "application/json")
        if self._code and not opens_socket and path.endswith("/enter"):
            return self._enter(self._code, request.headers, who)
        if self._code and not self._code.knows(request.headers):
            if opens_socket:
                self._refusals.note(NO_CODE, who)
                return _said(HTTPStatus.FORBIDDEN, NO_CODE)
            return _said(HTTPStatus.OK if path in PATHS else HTTPStatus.FORBIDDEN, _CODE_PAGE, "text/html")
        if opens_socket:
            return self._wait(who)
        if not (looks := _LOOKS.search(path)):
            return None
        known = self._host is not None and self._host.attend(looks[2], looks[1] == "here")
        return _said(HTTPStatus.NO_CONTENT if known else HTTPStatus.NOT_FOUND, "")

    def _wait(self, who: str) -> Response | None:
        """Who opens a websocket may have to wait, because many do or because this address was sent away."""
        now = monotonic()
        self._away = {other: until for other, until in self._away.items() if until > now}
        wait = max(self._handshakes.wait(), self._away.get(who, now) - now)
        if wait:
            self._refusals.note("a visitor, because there were too many at once", who)
            return _said(HTTPStatus.SERVICE_UNAVAILABLE, "Too many come at once. Try again in a moment.", wait=wait)
        self._handshakes.pay()
        return None

    def _keep_away(self, who: str) -> None:
        """Somebody has done what no browser does."""
        self._away[who] = monotonic() + AWAY
        self._handshakes.pay(min(MISDEED, max(0.0, self._handshakes.left)))

    def _enter(self, code: ClassCode, headers: Headers, who: str) -> Response:
        guesses = headers.get_all("X-Class-Code")
        entry = code.enter(unquote(guesses[0][:1000]) if guesses else "", who)
        if entry.opens:
            return _said(HTTPStatus.OK, "", cookie=code.cookie)
        self._refusals.note("a wrong class code" if not entry.wait else "a class code after too many wrong ones", who)
        return _said(HTTPStatus.TOO_MANY_REQUESTS if entry.wait else HTTPStatus.FORBIDDEN, entry.sentence,
                     wait=entry.wait)

    def _cull(self, connection: Any) -> None:
        """Close a websocket that has said nothing."""
        self._refusals.note("a connection that says nothing", self._who(connection))
        going = asyncio.ensure_future(_send_away(connection, NOTHING_SAID))
        self._going.add(going)  # else it could be collected while it goes
        going.add_done_callback(self._going.discard)

    def _listen(self, connection: Any, silent: asyncio.TimerHandle) -> None:
        """Have a websocket give the viewer only what a browser may say, and at a browser's pace. The first word ends
        the ``silent`` time."""
        receive, rate, calm, who = connection.recv, Bucket(MESSAGES, A_SECOND), monotonic(), self._who(connection)

        async def checked(*args: Any, **options: Any) -> Any:
            nonlocal calm
            while True:
                try:
                    message = await receive(*args, **options)
                except ConnectionClosed as closed:
                    if closed.sent and closed.sent.code == CloseCode.MESSAGE_TOO_BIG:
                        self._refusals.note("a message above 1 MB", who)
                        self._keep_away(who)
                    raise
                refusal = messages.refusal(message, lambda widget: self._widget(connection, widget))
                of_file = refusal is None and upload.kind_of(message)
                rate.pay(PART_AS if of_file else 1 + len(message) / BYTES_AS_ONE + (REFUSED_AS if refusal else 0))
                if rate.left > 0.25 * rate.most:
                    calm = monotonic()
                elif monotonic() - calm > PATIENCE:
                    self._refusals.note(TOO_MUCH, who)
                    self._keep_away(who)
                    await _send_away(connection, TOO_MUCH)
                    raise connection.protocol.close_exc
                if rate.left < 0:
                    await asyncio.sleep(rate.wait(0))
                if refusal is not None:
                    self._refusals.note(refusal, who)
                elif not of_file:
                    silent.cancel()
                    return message

        connection.recv = checked

    def _who(self, connection: Any) -> str:
        """The IP address of whoever is at the other end, or that for which a proxy on this machine asks."""
        remote = connection.remote_address
        who = str(remote[0]) if isinstance(remote, tuple) else "somewhere"
        told = connection.request.headers.get_all("X-Real-IP") if self._addresses.names and is_loopback(who) else []
        return told[0] if len(told) == 1 and is_ip(told[0]) else who

    def _widget(self, connection: Any, widget: str) -> Any:
        """The widget with this id on the page behind a websocket. Of the viewer only its private parts know it."""
        server: Any = self._server
        live = server._websock_server._live_connections if server else {}
        visitor = next((number for number, other in live.items() if other is connection), None)
        page = server._connected_clients.get(visitor) if server else None
        return page.gui._gui_input_handle_from_uuid.get(widget) if page else None


async def _send_away(connection: Any, why: str) -> None:
    """Close a websocket, also one whose other end does not listen."""
    with suppress(asyncio.TimeoutError):
        await asyncio.wait_for(connection.close(1008, why), GOING)
    connection.transport.abort()
    await connection.wait_closed()


def _said(status: HTTPStatus, text: str, kind: str = "text/plain", cookie: str = "", wait: float = 0) -> Response:
    """An answer of our own, which nobody keeps."""
    body = text.encode() + (b"\n" if kind == "text/plain" and text else b"")
    headers = Headers({"Content-Type": f"{kind}; charset=utf-8", "Content-Length": str(len(body)),
                       "Cache-Control": "no-store", "Connection": "close", "X-Content-Type-Options": "nosniff"})
    if cookie:
        headers["Set-Cookie"] = cookie
    if wait:
        headers["Retry-After"] = str(max(1, round(wait)))
    return Response(status.value, status.phrase, headers, body)
