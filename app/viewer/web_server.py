"""The web server with access control: checks origin, class code and limits before the viewer is involved."""

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
from urllib.parse import parse_qs, unquote

import viser
import websockets.asyncio.server
from websockets.datastructures import Headers
from websockets.exceptions import ConnectionClosed, InvalidMessage
from websockets.http11 import Request, Response

from app.access.allowed_hosts import FOREIGN_PAGE, Addresses, has_invalid_host_characters
from app.access.code_login import TEACHER, CodeLogin, CookieIdentity
from app.access.network_limits import TokenBucket, TokenBuckets, network_of
from app.access.rate_limited_log import RefusalLog, log_failure
from app.language import translation
from app.language.translation import current_language, language_cache, lazy, tr, with_language
from app.templates import render_template
from app.viewer import browser_connection, viser_patches
from app.viewer.browser_connection import BrowserConnection, BrowserConnections, address_of, close_websocket
from app.viewer.incoming_messages import PARTS, PARTS_A_SECOND, IncomingMessageFilter
from app.viewer.index_page import IndexPage, is_page_path, make_response, with_security_headers
from app.viewer.send_queue import PROTOCOL, SendBuffer

LARGEST_MESSAGE = 1_000_000  # bytes; the websocket is closed before more of one has been read
WAITING = 4  # messages that are read ahead
# Websockets from one network, each with a page to build: a class that reloads twice within half a minute; and from one
# browser, known by its key where a class code is required. Where none is, a client that is sent away costs its network
# so many tokens more: reconnecting repeatedly would keep the server building pages. There is no common limit: whoever
# exhausted it would keep everybody out.
HANDSHAKES, HANDSHAKES_A_SECOND, MISDEED = 80, 2, 30
RELOADS, RELOADS_A_SECOND = 40, 0.5
AWAY = 10.0  # seconds that a browser must wait after being sent away, or its address where it has no key
STOPPING = 0.2  # timeout of closing handshakes in s when the server ends
SILENT = 60.0  # seconds within which every browser sends its camera's position
NOTHING_SAID, CROWDED = "nothing was said", "too many say nothing"
NO_CODE = lazy("The class code is missing. Load the page again and type it.")

_LOOKS = re.compile(r"/(here|away)/([\w-]{1,40})$")
_CODE_PAGE = Path(__file__).parents[1] / "access" / "code.html"


@language_cache(1)
def _code_page() -> str:
    """Returns the html of the page that asks for the class code, in the current language."""
    return render_template(_CODE_PAGE, language=current_language())


class LabServer(viser.ViserServer):
    """The viewer's server without its tunnel; ``visitors`` has the pages of those who have passed ``access``."""

    visitors: Any = None

    def __init__(self, access: "AccessControl", **options: Any):
        self.access = access  # first: a server that is still starting may be stopped
        super().__init__(**options)

    def wait_until_sent(self, seconds: float) -> None:
        """Waits, at most so many seconds, until all pages are closed and every browser has been sent its messages."""
        end = monotonic() + seconds
        states = self._websock_server._client_state_from_id
        while monotonic() < end and not (self.visitors.has_no_pending_page() and all(
                cast(SendBuffer, state.message_buffer).all_sent for state in list(states.values()))):
            sleep(0.01)

    def stop(self) -> None:
        """Stops the server; connections whose closing handshake takes longer than ``STOPPING`` are aborted."""
        loop = self._websock_server._background_event_loop
        if loop is not None:
            with suppress(RuntimeError):  # it has ended
                loop.call_soon_threadsafe(loop.call_later, STOPPING, self.access.connections.abort_all)
        super().stop()

    def request_share_url(self, verbose: bool = True) -> None:
        """Does nothing: there is no tunnel."""

    def disconnect_share_url(self) -> None:
        """Does nothing: there is no tunnel."""


class AccessControl:
    """Access control of one server: allowed addresses, class code (None: none is required), rate limits. All but
    :meth:`guard_servers` is called on the web server's loop."""

    def __init__(self, addresses: Addresses, code: CodeLogin | None):
        self._addresses, self._code, self._refusals = addresses, code, RefusalLog()
        self._handshakes = TokenBuckets(lambda: TokenBucket(HANDSHAKES, HANDSHAKES_A_SECOND))
        self._reloads = TokenBuckets(lambda: TokenBucket(RELOADS, RELOADS_A_SECOND))  # by key
        self._parts = TokenBuckets(lambda: TokenBucket(PARTS, PARTS_A_SECOND))
        self.connections = BrowserConnections(trusts_proxy=bool(addresses.names))
        self._going: set[asyncio.Future] = set()  # websockets that are being closed
        self._away: dict[str, float] = {}  # time until which a browser, by key or address, must wait
        self._server: viser.ViserServer | None = None
        self._visitors: Any = None  # admitted visitors

    def attach_server(self, server: LabServer, visitors: Any) -> None:
        """Sets the server and the pages of its ``visitors``, here and in the server; messages refer to its widgets."""
        self._server, self._visitors = server, visitors
        server.visitors = visitors

    @contextmanager
    def guard_servers(self, index: IndexPage) -> Iterator[None]:
        """Context manager: web servers started within use this access control, and send ``index`` as their page."""
        serve = websockets.asyncio.server.serve

        def serving(handler: Callable[[Any], Awaitable[None]], *args: Any, process_request: object,
                    **options: Any) -> Any:
            def answer(connection: BrowserConnection, request: Request) -> Response | None:
                answer = self._answer_request(connection, request, index)
                connection.on_answered()
                return answer

            asyncio.get_running_loop().set_exception_handler(viser_patches.log_loop_failure)
            own = {"max_size": LARGEST_MESSAGE, "max_queue": WAITING, "logger": log, "process_request": answer,
                   "open_timeout": browser_connection.HEADS_WITHIN, "process_response": with_security_headers,
                   "create_connection": partial(BrowserConnection, self.connections)}
            return serve(partial(self._handle_websocket, handler), *args, **{**options, **own})

        log = logging.Logger("websockets.server", logging.ERROR)  # of this server alone
        log.addFilter(self._filter_log_record)
        websockets.asyncio.server.serve = serving  # type: ignore[assignment, misc]
        try:
            yield
        finally:
            websockets.asyncio.server.serve = serve  # type: ignore[misc]

    def _filter_log_record(self, record: logging.LogRecord) -> bool:
        """Log filter: refuses clients that send no HTTP, ignores early disconnects, logs others in a line."""
        error = record.exc_info[1] if record.exc_info else None
        if record.getMessage() != "opening handshake failed":
            if isinstance(error, Exception):
                log_failure(viser_patches.MESSAGE, error)
            return not isinstance(error, Exception)
        if not isinstance(error, InvalidMessage) or isinstance(error.__cause__, (EOFError, OSError)):
            return False
        self._refusals.record("a connection that does not speak HTTP")
        return False

    async def _handle_websocket(self, handler: Callable[[Any], Awaitable[None]], connection: Any) -> None:
        """Passes a websocket to the viewer's ``handler`` after its first message; nothing is built for it before."""
        who = self._address_of(connection)
        if connection.subprotocol != PROTOCOL:
            self._refusals.record("a page of another version", who)
            await connection.close(1002, f"Version mismatch. Server: {viser.__version__}")
            return
        hearing = IncomingMessageFilter(connection, who, self._refusals, self._parts.get(network_of(who)),
                                        partial(self._find_widget, connection), partial(self._block, connection))
        if gone := self.connections.silent.add(connection, network_of(who)):
            self._close_silent_websocket(gone, CROWDED)
        silent = asyncio.get_running_loop().call_later(SILENT, self._close_silent_websocket, connection, NOTHING_SAID)
        try:
            await hearing.wait_for_first_message()
        except ConnectionClosed:
            return
        finally:
            silent.cancel()
            self.connections.silent.discard(connection)
        pulse = asyncio.create_task(connection.ping_until_closed())
        try:
            await handler(connection)
        finally:
            pulse.cancel()

    def _answer_request(self, connection: BrowserConnection, request: Request, index: IndexPage) -> Response | None:
        """Returns the response to a request, in the browser's language; None for one that may open a websocket."""
        path, _, query = request.path.partition("?")
        code = translation.preferred_language(query, ",".join(request.headers.get_all("Accept-Language")))
        return with_language(self._respond_in_language, code)(connection, request, index, path)

    def _respond_in_language(self, connection: BrowserConnection, request: Request, index: IndexPage,
                             path: str) -> Response | None:
        """Returns the response to a request for a ``path``, in the current language; None to open a websocket."""
        who, headers = self._address_of(connection), request.headers
        opens_socket = "websocket" in ",".join(headers.get_all("Upgrade")).lower()
        refusal = FOREIGN_PAGE if has_invalid_host_characters(connection.head) else \
            self._addresses.refusal(headers, opens_socket)
        if refusal:
            self._refusals.record(refusal, who)
            return make_response(HTTPStatus.FORBIDDEN, refusal)
        known = not self._code or self._code.is_authorised(headers)
        if path == "/health" and not opens_socket:
            health = self._visitors.health() if self._visitors else {"ready": False}
            shown, ready = health if known else {"ready": health["ready"]}, health["ready"]
            return make_response(HTTPStatus.OK if ready else HTTPStatus.SERVICE_UNAVAILABLE, json.dumps(shown),
                                 "application/json", wait=not ready)
        if self._code and not opens_socket and path.endswith("/enter"):
            return self._log_in(self._code, headers, who)
        if not known:
            if opens_socket:
                self._refusals.record(NO_CODE, who)
                return make_response(HTTPStatus.FORBIDDEN, tr(NO_CODE))
            return make_response(HTTPStatus.OK if is_page_path(path) else HTTPStatus.FORBIDDEN, _code_page(),
                                 "text/html")
        if opens_socket:
            return self._rate_limit_refusal(who, self._browser_key(headers))
        if not (looks := _LOOKS.search(path)):
            return index.answer_in_language(request, current_language())
        there = self._visitors is not None and self._visitors.set_watched(looks[2], looks[1] == "here")
        return make_response(HTTPStatus.NO_CONTENT if there else HTTPStatus.NOT_FOUND, "")

    def identify(self, visitor: int) -> CookieIdentity | None:
        """Returns whose code a visitor used, the teacher's if none is required; None if the visitor has left."""
        if self._code is None:
            return CookieIdentity(TEACHER)
        connection = self._websocket_of(visitor)
        return None if connection is None else self._code.identify(connection.request.headers)

    def language(self, visitor: int) -> str:
        """Returns the language (code) of a visitor's page, English if the visitor has left."""
        return translation.preferred_language(self._query_of(visitor), "")

    def first_message(self, visitor: int) -> str:
        """Returns the message that ``js/00-socket.js`` has put into the address of a visitor's websocket, or ""."""
        return parse_qs(self._query_of(visitor)).get("first", [""])[0]

    def _query_of(self, visitor: int) -> str:
        """Returns the query in the address of a visitor's websocket; "" if the visitor has left."""
        connection = self._websocket_of(visitor)
        return "" if connection is None else connection.request.path.partition("?")[2]

    def _websocket_of(self, visitor: int) -> Any:
        """Returns the websocket of a visitor, from private attributes of the viewer; None if the visitor has left."""
        server: Any = self._server
        return server._websock_server._live_connections.get(visitor) if server else None

    def _browser_key(self, headers: Headers) -> str:
        """Returns the key in the cookie of a browser that has given a code; "" where none is required."""
        identity = self._code.identify(headers) if self._code else None
        return identity.key if identity else ""

    def _rate_limit_refusal(self, who: str, key: str) -> Response | None:
        """Returns a refusal for websockets of a network or browser with many, or one that must wait; else None."""
        now = monotonic()
        self._away = {other: until for other, until in self._away.items() if until > now}
        buckets = [self._handshakes.get(network_of(who)), *([self._reloads.get(key)] if key else [])]
        wait = max(self._away.get(key or who, now) - now, *(bucket.delay() for bucket in buckets))
        if wait:
            self._refusals.record("a visitor, because there were too many at once", who)
            return make_response(HTTPStatus.SERVICE_UNAVAILABLE, tr("Too many come at once. Try again in a moment."),
                                 wait=wait)
        for bucket in buckets:
            bucket.debit()
        return None

    def _block(self, connection: Any) -> None:
        """Makes a misbehaving browser wait ``AWAY`` seconds, or without a key its IP address, whose network must also
        wait longer between websockets."""
        who, key = self._address_of(connection), self._browser_key(connection.request.headers)
        self._away[key or who] = monotonic() + AWAY
        if not key:
            handshakes = self._handshakes.get(network_of(who))
            handshakes.debit(min(MISDEED, max(0.0, handshakes.tokens)))

    def _log_in(self, code: CodeLogin, headers: Headers, who: str) -> Response:
        """Returns the response to a class code in a request's headers, with a cookie if the code is right."""
        guesses = headers.get_all("X-Class-Code")
        entry = code.log_in(unquote(guesses[0][:1000]) if guesses else "", who)
        if entry.cookie and code.is_authorised(headers) and not entry.more:
            return make_response(HTTPStatus.NO_CONTENT, "")  # already admitted
        if entry.cookie:
            return make_response(HTTPStatus.OK, "", cookie=entry.cookie)
        self._refusals.record("a wrong class code" if not entry.wait else "a class code after too many wrong ones", who)
        return make_response(HTTPStatus.TOO_MANY_REQUESTS if entry.wait else HTTPStatus.FORBIDDEN, entry.refusal,
                             wait=entry.wait)

    def _close_silent_websocket(self, connection: Any, why: str) -> None:
        """Starts to close a websocket that has sent nothing, with the reason ``why``; logs that."""
        self._refusals.record("a connection that says nothing", self._address_of(connection))
        going = asyncio.ensure_future(close_websocket(connection, why))
        self._going.add(going)  # keeps a reference, so that it is not garbage-collected
        going.add_done_callback(self._going.discard)

    def _address_of(self, connection: Any) -> str:
        return address_of(connection, trusts_proxy=self.connections.trusts_proxy)

    def _find_widget(self, connection: Any, widget: str) -> Any:
        """Returns the widget with an id on the page of a websocket, from private attributes of the viewer, or None."""
        server: Any = self._server
        live = server._websock_server._live_connections if server else {}
        visitor = next((number for number, other in live.items() if other is connection), None)
        page = server._connected_clients.get(visitor) if server else None
        return page.gui._gui_input_handle_from_uuid.get(widget) if page else None
