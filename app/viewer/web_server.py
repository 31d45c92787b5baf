"""The web server with its doors: who asks, with what code, and what is said to it, before the viewer hears of it."""

import asyncio
import json
import logging
import re
from collections.abc import Awaitable, Callable, Iterator
from contextlib import contextmanager, suppress
from functools import partial
from http import HTTPStatus
from pathlib import Path
from time import monotonic, sleep
from typing import Any, cast
from urllib.parse import unquote

import viser
import websockets.asyncio.server
from websockets.datastructures import Headers
from websockets.exceptions import ConnectionClosed, InvalidMessage
from websockets.http11 import Request, Response

from app.access.allowed_hosts import FOREIGN_PAGE, Addresses, has_stray_whitespace
from app.access.class_code import TEACHER, AccessIdentity, ClassCode
from app.access.log_limit import Refusals, log_failure
from app.access.network_limits import TokenBucket, TokenBuckets, network_of
from app.language import translation
from app.language.translation import ENGLISH, current_language, language_cache, lazy, tr, with_language
from app.templates import render_template
from app.viewer import viser_patches
from app.viewer.connection import HEADS_WITHIN, BrowserConnection, BrowserConnections, address_of, send_away
from app.viewer.incoming_messages import PARTS, PARTS_A_SECOND, IncomingLimiter
from app.viewer.index_page import Index, has_page, make_response, with_security_headers
from app.viewer.send_queue import PROTOCOL, SendBuffer

LARGEST_MESSAGE = 1_000_000  # bytes; the websocket is closed before more of one has been read
WAITING = 4  # messages that are read ahead
# Websockets opened from one network, each with a page to make: a class that reloads twice within half a minute. One
# that is sent away takes so many more, as far as there are: who comes again and again would have the server make
# nothing but pages. There is no such number for all: whoever used it up would keep everybody out.
HANDSHAKES, HANDSHAKES_A_SECOND, MISDEED = 80, 2, 30
AWAY = 10.0  # seconds in which the address of one who was sent away must wait
STOPPING = 0.2  # seconds that browsers have to say goodbye when the server ends
SILENT = 60.0  # seconds in which a browser, however busy, says where its camera is; one that never speaks is none
NOTHING_SAID, CROWDED = "nothing was said", "too many say nothing"
NO_CODE = lazy("The class code is missing. Load the page again and type it.")

_LOOKS = re.compile(r"/(here|away)/([\w-]{1,40})$")
_CODE_PAGE = Path(__file__).parents[1] / "access" / "code.html"


@language_cache(1)
def _code_page() -> str:
    """What asks for the class code."""
    return render_template(_CODE_PAGE, language=current_language())


class Lab(viser.ViserServer):
    """The viewer's server without its tunnel; its ``visitors`` have come through its ``doors``."""

    visitors: Any = None
    doors: "AccessControl"

    def wait_until_told(self, seconds: float) -> None:
        """Until every browser has been sent the goodbye and all before it; not longer for one that takes nothing."""
        end = monotonic() + seconds
        states = self._websock_server._client_state_from_id
        while monotonic() < end and not (self.visitors.all_told() and all(
                cast(SendBuffer, state.message_buffer).all_sent for state in list(states.values()))):
            sleep(0.01)

    def stop(self) -> None:
        """The end. Who does not say goodbye in turn is cut off."""
        loop = self._websock_server._background_event_loop
        if loop is not None:
            with suppress(RuntimeError):  # it has ended
                loop.call_soon_threadsafe(loop.call_later, STOPPING, self.doors.cut)
        super().stop()

    def request_share_url(self, verbose: bool = True) -> None:
        """There is none."""

    def disconnect_share_url(self) -> None:
        """There is nothing to disconnect."""


class AccessControl:
    """The doors of one server. All but :meth:`guarding` is called on the web server's loop."""

    def __init__(self, addresses: Addresses, code: ClassCode | None):
        self._addresses, self._code, self._refusals = addresses, code, Refusals()
        self._handshakes = TokenBuckets(lambda: TokenBucket(HANDSHAKES, HANDSHAKES_A_SECOND))
        self._parts = TokenBuckets(lambda: TokenBucket(PARTS, PARTS_A_SECOND))
        self._lines = BrowserConnections(trusts_proxy=bool(addresses.names))
        self._going: set[asyncio.Future] = set()  # websockets that are being closed
        self._away: dict[str, float] = {}  # until when an address must wait
        self._server: viser.ViserServer | None = None
        self._visitors: Any = None  # who is in

    def watch(self, server: Lab, visitors: Any) -> None:
        """This server's widgets are meant in what browsers say, and these visitors."""
        self._server, self._visitors = server, visitors
        server.doors, server.visitors = self, visitors

    def cut(self) -> None:
        """All connections."""
        self._lines.cut()

    @contextmanager
    def guarding(self, index: Index) -> Iterator[None]:
        """Gives these doors, and this ``index``, to the web servers that start meanwhile."""
        serve = websockets.asyncio.server.serve

        def serving(handler: Callable[[Any], Awaitable[None]], *args: Any, process_request: object,
                    **options: Any) -> Any:
            def answer(connection: BrowserConnection, request: Request) -> Response | None:
                answer = self._answer(connection, request, index)
                connection.answered()
                return answer

            asyncio.get_running_loop().set_exception_handler(viser_patches.of_loop)
            own = {"max_size": LARGEST_MESSAGE, "max_queue": WAITING, "logger": log, "open_timeout": HEADS_WITHIN,
                   "create_connection": partial(BrowserConnection, self._lines),
                   "process_request": answer, "process_response": with_security_headers}
            return serve(partial(self._handle, handler), *args, **{**options, **own})

        log = logging.Logger("websockets.server", logging.ERROR)  # of this server alone
        log.addFilter(self._no_traces)
        websockets.asyncio.server.serve = serving  # type: ignore[assignment, misc]
        try:
            yield
        finally:
            websockets.asyncio.server.serve = serve  # type: ignore[misc]

    def _no_traces(self, record: logging.LogRecord) -> bool:
        """Refuses who speaks no HTTP, ignores who leaves early, and logs any other failure in one line."""
        error = record.exc_info[1] if record.exc_info else None
        if record.getMessage() != "opening handshake failed":
            if isinstance(error, Exception):
                log_failure(viser_patches.MESSAGE, error)
            return not isinstance(error, Exception)
        if not isinstance(error, InvalidMessage) or isinstance(error.__cause__, (EOFError, OSError)):
            return False
        self._refusals.note("a connection that does not speak HTTP")
        return False

    async def _handle(self, handler: Callable[[Any], Awaitable[None]], connection: Any) -> None:
        """What becomes of a websocket. The viewer gets it when it has spoken: before, nothing is made for it."""
        who = self._who(connection)
        if connection.subprotocol != PROTOCOL:
            self._refusals.note("a page of another version", who)
            await connection.close(1002, f"Version mismatch. Server: {viser.__version__}")
            return
        hearing = IncomingLimiter(connection, who, self._refusals, self._parts.of(network_of(who)),
                          partial(self._widget, connection), self._keep_away)
        if gone := self._lines.silent.enter(connection, network_of(who)):
            self._close(gone, CROWDED)
        silent = asyncio.get_running_loop().call_later(SILENT, self._close, connection, NOTHING_SAID)
        try:
            await hearing.first_word()
        except ConnectionClosed:
            return
        finally:
            silent.cancel()
            self._lines.silent.leave(connection)
        pulse = asyncio.create_task(connection.ping_until_closed())
        try:
            await handler(connection)
        finally:
            pulse.cancel()

    def _answer(self, connection: BrowserConnection, request: Request, index: Index) -> Response | None:
        """What a request gets; None for one that gets a websocket."""
        path, _, query = request.path.partition("?")
        code = translation.preferred_language(query, ",".join(request.headers.get_all("Accept-Language")))
        return with_language(self._answered, code)(connection, request, index, path)

    def _answered(self, connection: BrowserConnection, request: Request, index: Index, path: str) -> Response | None:
        """The same, in the visitor's language."""
        who, headers = self._who(connection), request.headers
        opens_socket = "websocket" in ",".join(headers.get_all("Upgrade")).lower()
        refusal = FOREIGN_PAGE if has_stray_whitespace(connection.head) else \
            self._addresses.refusal(headers, opens_socket)
        if refusal:
            self._refusals.note(refusal, who)
            return make_response(HTTPStatus.FORBIDDEN, refusal)
        known = not self._code or self._code.knows(headers)
        if path == "/health" and self._visitors and not opens_socket:
            health = self._visitors.health()
            shown = health if known else {"ready": health["ready"]}
            return make_response(HTTPStatus.OK, json.dumps(shown), "application/json")
        if self._code and not opens_socket and path.endswith("/enter"):
            return self._enter(self._code, headers, who)
        if not known:
            if opens_socket:
                self._refusals.note(NO_CODE, who)
                return make_response(HTTPStatus.FORBIDDEN, tr(NO_CODE))
            return make_response(HTTPStatus.OK if has_page(path) else HTTPStatus.FORBIDDEN, _code_page(), "text/html")
        if opens_socket:
            return self._wait(who)
        if not (looks := _LOOKS.search(path)):
            return index.answer(request, current_language())
        there = self._visitors is not None and self._visitors.attend(looks[2], looks[1] == "here")
        return make_response(HTTPStatus.NO_CONTENT if there else HTTPStatus.NOT_FOUND, "")

    def guest(self, visitor: int) -> AccessIdentity | None:
        """Returns with whose code a visitor has come, the teacher's where none is needed; None for one who left."""
        if self._code is None:
            return AccessIdentity(TEACHER)
        connection = self._connection(visitor)
        return None if connection is None else self._code.guest(connection.request.headers)

    def language(self, visitor: int) -> str:
        """The code of the language in which the page of a visitor who is here has come."""
        connection = self._connection(visitor)
        return ENGLISH if connection is None else translation.of_cookie(connection.request.headers.get_all("Cookie"))

    def _connection(self, visitor: int) -> Any:
        """The websocket of a visitor who is here. Of the viewer only its private parts know it."""
        server: Any = self._server
        return server._websock_server._live_connections.get(visitor) if server else None

    def _wait(self, who: str) -> Response | None:
        """Makes those wait who open a websocket after many of their network, or after being sent away."""
        now, handshakes = monotonic(), self._handshakes.of(network_of(who))
        self._away = {other: until for other, until in self._away.items() if until > now}
        wait = max(handshakes.wait(), self._away.get(who, now) - now)
        if wait:
            self._refusals.note("a visitor, because there were too many at once", who)
            return make_response(HTTPStatus.SERVICE_UNAVAILABLE, tr("Too many come at once. Try again in a moment."),
                                 wait=wait)
        handshakes.pay()
        return None

    def _keep_away(self, who: str) -> None:
        """Somebody has done what no browser does."""
        self._away[who] = monotonic() + AWAY
        handshakes = self._handshakes.of(network_of(who))
        handshakes.pay(min(MISDEED, max(0.0, handshakes.left)))

    def _enter(self, code: ClassCode, headers: Headers, who: str) -> Response:
        guesses = headers.get_all("X-Class-Code")
        entry = code.enter(unquote(guesses[0][:1000]) if guesses else "", who)
        if entry.cookie and code.knows(headers) and not entry.more:
            return make_response(HTTPStatus.NO_CONTENT, "")  # of no use to one who is in
        if entry.cookie:
            return make_response(HTTPStatus.OK, "", cookie=entry.cookie)
        self._refusals.note("a wrong class code" if not entry.wait else "a class code after too many wrong ones", who)
        return make_response(HTTPStatus.TOO_MANY_REQUESTS if entry.wait else HTTPStatus.FORBIDDEN, entry.sentence,
                             wait=entry.wait)

    def _close(self, connection: Any, why: str) -> None:
        """Close a websocket that has said nothing."""
        self._refusals.note("a connection that says nothing", self._who(connection))
        going = asyncio.ensure_future(send_away(connection, why))
        self._going.add(going)  # else it could be collected while it goes
        going.add_done_callback(self._going.discard)

    def _who(self, connection: Any) -> str:
        return address_of(connection, trusts_proxy=self._lines.trusts_proxy)

    def _widget(self, connection: Any, widget: str) -> Any:
        """The widget with this id on the page behind a websocket. Of the viewer only its private parts know it."""
        server: Any = self._server
        live = server._websock_server._live_connections if server else {}
        visitor = next((number for number, other in live.items() if other is connection), None)
        page = server._connected_clients.get(visitor) if server else None
        return page.gui._gui_input_handle_from_uuid.get(widget) if page else None
