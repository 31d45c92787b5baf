"""Serving the page: engines, the web server and one :class:`~app.page.page.Page` per visitor."""

import contextlib
import io
import logging
import signal
import sys
import threading
import warnings
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from time import sleep
from typing import Any
from urllib.parse import quote

from app.access.allowed_hosts import Addresses
from app.access.code_login import BOARD, CLASS, TEACHER, CodeLogin, CookieIdentity, generate_code
from app.access.rate_limited_log import RateLimitFilter
from app.classroom.class_board_state import ClassBoardState
from app.classroom.class_context import LessonContext
from app.language.translation import lazy, tr, with_language
from app.lessons import catalogue
from app.logo_and_font import ICON
from app.page.features.opening_tour import OPENING
from app.page.listening_address import THIS_MACHINE, authority, network_address, require_free
from app.page.precompiled_scenes import usual_scenes
from app.page.shutdown import exit_within, run_in_background
from app.page.visit.engine_links import EventRateCounter, PageEngineLinks
from solvers.engine.engine_messages import FRAME_SECONDS
from solvers.engine.engine_pool import EnginePool
from solvers.workers.cpu_count import available_cpus

HEARS_WITHIN, TOLD_WITHIN = 0.2, 0.5  # seconds until it notices its end, and at most to notify visitors
CLOSED_WITHIN, ENDS_WITHIN = 0.3, 1.3  # seconds in which pages close, and after which it exits in any case
MAKERS = 2  # pages made in parallel; each takes some 30 ms of a processor
MOST_ENGINES = 4  # each holds its own copy of Taichi and of every kernel; more gain little

FULL = lazy("Every place on this server is taken. This page tries again by itself; nothing needs to be done.")
OVER = lazy("The lab is closed. This page reloads when it opens again.")
FAILED = lazy("The page could not be made. Reload it, or see the terminal for the reason.")
AGAIN = "<i class='lab-again'></i>"  # makes the browser reload the page after a while


class Visitors:
    """Connected visitors: a page for each of at most ``places``, closed when its visitor leaves.

    ``make_page(client, links)`` returns a page; ``show(client, html)`` replaces a browser's content by a message; a
    client for which ``expects(client)`` is true needs no free place. Clients differ by ``client_id``. Thread-safe: a
    visitor may leave while the page is being made, or even before :meth:`connect`."""

    def __init__(self, pool: EnginePool, places: int, make_page: Callable[[Any, PageEngineLinks], Any],
                 show: Callable[[Any, str], None], expects: Callable[[Any], bool] = lambda client: False):
        self._pool, self._places, self._make_page, self._show = pool, places, make_page, show
        self._expects = expects
        self._lock, self._frames = threading.Lock(), EventRateCounter()
        self._pages: dict[int, Any] = {}  # places taken; None while the page is being made
        self._pageless: set[int] = set()  # connected, but refused or with a page that failed
        self._left: set[int] = set()  # gone before ``connect``, or while their page was being made
        self._over = False  # shutting down: pages still being made are discarded

    def connect(self, client: Any) -> None:
        """Makes a client's page before it returns, or shows the client why there is none: the lab is full or closed."""
        visitor = client.client_id
        with self._lock:
            if visitor in self._left:
                self._left.discard(visitor)
                return
            over, admitted = self._over, not self._over and (len(self._pages) < self._places or self._expects(client))
            if admitted:
                self._pages[visitor] = None
            else:
                self._pageless.add(visitor)
        if admitted:
            self._admit(client)
        else:
            self._show(client, tr(OVER) if over else tr(FULL) + AGAIN)

    def disconnect(self, client: Any) -> None:
        """Closes the page of a client that has left, now or as soon as the page is made."""
        visitor = client.client_id
        with self._lock:
            if visitor in self._pageless:
                self._pageless.remove(visitor)
                return
            page = self._pages.get(visitor)
            if page is None:
                self._left.add(visitor)
                return
            del self._pages[visitor]
        page.close()

    def set_watched(self, token: str, watched: bool) -> bool:
        """Tells the page with this token whether its browser shows it; returns False if there is no such page."""
        with self._lock:
            page = next((page for page in self._pages.values() if page and page.token == token), None)
        if page is not None:
            page.set_watched(watched)
        return page is not None

    def close_all_pages(self) -> list[threading.Thread]:
        """Shows all visitors that the lab closes; returns the threads started to close their pages."""
        with self._lock:
            pages, self._over = list(filter(None, self._pages.values())), True
            self._pages = {visitor: page for visitor, page in self._pages.items() if page is None}
        closing = [threading.Thread(target=with_language(self._close_with_message, page.language), args=(page,),
                                    daemon=True) for page in pages]
        for thread in closing:
            thread.start()
        return closing

    def has_no_pending_page(self) -> bool:
        """Returns whether no page is still open or being made, after :meth:`close_all_pages`."""
        return not self._pages

    def health(self) -> dict[str, Any]:
        """Returns the server's state for monitoring: ready, sessions, places, engines, playing, frames_per_second."""
        return {"ready": self._pool.wait_ready(0), "sessions": len(self._pages), "places": self._places,
                "engines": len(self._pool.process_ids), "playing": self._pool.playing_sessions,
                "frames_per_second": self._frames.events_per_second}

    def _close_with_message(self, page: Any) -> None:
        page.stop_output()
        self._show(page.client, tr(OVER))
        page.client.flush()
        page.close()

    def _admit(self, client: Any) -> None:
        """Makes the page of a client that has a place; frees the place and shows a message if that fails."""
        visitor, links, page = client.client_id, PageEngineLinks(self._pool, self._frames), None
        try:
            page = self._make_page(client, links)
        except Exception:
            logging.getLogger(__name__).exception("the page of visitor %d could not be made", visitor)
            links.close()
        with self._lock:
            gone, over = visitor in self._left, self._over
            self._left.discard(visitor)
            if page is not None and not (gone or over):
                self._pages[visitor] = page
                return
            if not gone:
                self._pageless.add(visitor)
        if page is not None:
            page.close()
        if not gone:
            self._show(client, tr(OVER if over else FAILED))
        with self._lock:
            self._pages.pop(visitor, None)


def serve(host: str, port: int, max_sessions: int, warm_up: bool = True, code: str = "",
          names: tuple[str, ...] = (), frames: float = 1 / FRAME_SECONDS, lesson: str = "",
          teacher: bool = False, core: bool = False, board: bool = False) -> None:
    """Serves the page until interrupted; raises ``ServeError`` if host and port cannot be bound.

    At most ``max_sessions`` visitors are served, each with up to ``frames`` frames per second. With ``warm_up`` usual
    scenes are compiled in the background. Visitors need the class ``code``; without one it is generated if other
    machines can connect. ``names`` are host names of proxies. The ``lesson``, if any, is opened for everyone. With
    ``teacher`` its notes are shown, on a public server to those with the teacher's code. With ``core`` lessons begin
    with their core alone. A ``board`` shows the class's answers to those with its own code; it tells visitors apart by
    the cookies of a class code."""
    addresses = Addresses(host, names)
    code = code or (generate_code() if board or not addresses.is_local_only else "")
    codes = {CLASS: code, TEACHER: generate_code() if teacher and code else "", BOARD: generate_code() if board else ""}
    require_free(host, port)
    # The engines start before the page's imports: they need longest.
    pool, server = EnginePool(OPENING.scene, _engine_count(), 1 / frames), None
    classroom = LessonContext(lesson, teacher, core=core)
    shared = None
    if board:
        original, *translations = catalogue.load_every_language(lesson)
        shared = ClassBoardState(original, classroom.outcomes, core, translations)
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # exits as by Ctrl-C
    log = logging.StreamHandler()
    log.addFilter(RateLimitFilter())
    logging.getLogger().addHandler(log)
    try:
        server = _start_server(host, port, pool, max_sessions, addresses, codes, classroom, shared)
        _announce(authority(THIS_MACHINE.get(host, host), server.get_port()),
                  f"http://{authority(network_address(host), server.get_port())}/", codes)
        lessons = catalogue.load_lessons()  # in idle time: the first visitor needs them
        if warm_up:
            pool.prewarm(usual_scenes(lessons, lesson))
        while True:  # the system may deliver Ctrl-C to another thread, without waking this one
            sleep(HEARS_WITHIN)
    finally:
        with exit_within(ENDS_WITHIN):
            pool.request_stop()  # first: engines take longest
            closing = [] if server is None else server.visitors.close_all_pages()
            closing.append(run_in_background(classroom.outcomes.close))
            if shared is not None:
                shared.stop_computations()
            if server is not None:
                server.wait_until_sent(TOLD_WITHIN)
            pool.close(CLOSED_WITHIN)
            for thread in closing:
                thread.join(CLOSED_WITHIN / max(1, len(closing)))
            if server is not None:
                with contextlib.redirect_stdout(io.StringIO()):
                    server.stop()


def _start_server(host: str, port: int, pool: EnginePool, max_sessions: int, addresses: Addresses,
                  codes: Mapping[str, str], classroom: LessonContext, board: ClassBoardState | None = None) -> Any:
    from app.classroom.class_context import JoinInfo, LecturerContext
    from app.page.page import Page
    from app.page.panels.page_header import initial_page_html, set_up_theme
    from app.viewer import viser_patches
    from app.viewer.index_page import IndexPage
    from app.viewer.send_queue import batch_messages, patch_viser
    from app.viewer.web_server import AccessControl, LabServer

    patch_viser()
    pool.set_delivery_context(batch_messages)
    viser_patches.log_callback_failures()
    # A frame may be drawn for a visitor who has just left; that is no error.
    warnings.filterwarnings("ignore", message="Queued a .* on a closed connection")
    code = codes[CLASS]
    doors = AccessControl(addresses, CodeLogin(code, port, codes[TEACHER], codes[BOARD]) if code else None)
    # The viewer would print its own banner.
    with contextlib.redirect_stdout(io.StringIO()), doors.guard_servers(IndexPage(initial_page_html, ICON)):
        server = LabServer(doors, host=host, port=port, verbose=False)
    set_up_theme(server.gui)

    def make_page(client: Any, links: PageEngineLinks) -> Any:
        whose, key = doors.identify(client.client_id) or CookieIdentity(CLASS)
        seat = board.add_seat(key) if board and whose == CLASS else None
        lectern = LecturerContext(board, JoinInfo(f"http://{authority(network_address(host), port)}/", code)) \
            if board and whose == BOARD else None
        try:
            return Page(client, links, replace(classroom, teacher=classroom.teacher and whose == TEACHER, seat=seat),
                        lectern, doors.first_message(client.client_id))
        except Exception:
            if seat:
                seat.leave()
            raise

    def expects(client: Any) -> bool:
        """Returns whether a client is the lecturer's page, which needs no free place."""
        return (doors.identify(client.client_id) or CookieIdentity(CLASS)).role == BOARD

    visitors = Visitors(pool, max_sessions, make_page, _replace_page_content, expects)
    doors.attach_server(server, visitors)
    server.on_client_disconnect(visitors.disconnect)  # first, so that no disconnect is missed
    # On threads of their own, so that callbacks of present visitors do not wait for new pages.
    makers = ThreadPoolExecutor(MAKERS, "page")

    def connect(client: Any) -> None:
        makers.submit(with_language(visitors.connect, doors.language(client.client_id)), client)

    server.on_client_connect(connect)
    return server


def _announce(address: str, link: str, codes: Mapping[str, str]) -> None:
    """Prints the local ``address``, the ``link`` for other machines and the codes (by role) to standard error."""
    print(f"mpm-lab is at http://{address} (Ctrl-C ends it)", file=sys.stderr, flush=True)
    if code := codes[CLASS]:
        link_of_class = f"{link}#code={quote(code)}"
        print(f"the class code is {code}; {link_of_class} brings it along", file=sys.stderr, flush=True)
        if sys.stderr.isatty():
            import segno  # for a QR code of block characters on the board

            out = io.StringIO()
            segno.make(link_of_class, error="l", micro=False).terminal(out, compact=True)
            print(out.getvalue(), file=sys.stderr, flush=True)
    if notes := codes[TEACHER]:
        print(f"the teacher's code, which shows the notes too, is {notes}; {link}#code={quote(notes)} brings it along",
              file=sys.stderr, flush=True)
    if own := codes[BOARD]:
        print(f"the board's code, for the lecturer alone, is {own}; {link}#code={quote(own)} opens the board",
              file=sys.stderr, flush=True)


def _replace_page_content(client: Any, sentence: str) -> None:
    client.gui.reset()
    client.scene.reset()
    client.gui.add_html(f"<div class='lab-notice lab-refused lab-alone'>{sentence}</div>")


def _engine_count() -> int:
    """Returns the number of engine processes: one fewer than the processors, so that the page keeps one; 1 to 4."""
    return min(MOST_ENGINES, max(1, available_cpus() - 1))
