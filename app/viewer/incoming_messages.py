"""Validation of incoming messages, field by field, and their rate limit. Invalid ones do not reach the viewer.

The viewer trusts its clients: it would set any attribute of any widget to any value, and open a tunnel on request."""

import asyncio
import math
from collections.abc import Callable
from time import monotonic
from typing import Any

import msgspec
from websockets.exceptions import ConnectionClosed
from websockets.frames import CloseCode

from app.access.network_limits import TokenBucket
from app.access.rate_limited_log import RefusalLog
from app.viewer import upload, widget_validation
from app.viewer.browser_connection import close_websocket

MOST_BYTES = 32_000  # of a message; usual ones have some hundred
LONGEST_NAME = 1000  # letters of a file's name
NEAR = 1e-6  # between a camera and what it looks at
FAR = 1e6  # limit of cameras and positions
LARGEST_CANVAS = 32_768  # pixels
STEEP = 1e-6  # least component of a click's ray normal to the stage; a parallel one never meets it
# A browser sends at most 20 values of a widget and 50 camera messages per second, and bursts after a pause.
MESSAGES, A_SECOND, PATIENCE = 200, 100, 4.0  # burst, rate; seconds for which more are tolerated
BYTES_AS_ONE, REFUSED_AS = 1000, 3  # weights of large and refused messages
PART_AS = 4  # and of an accepted part of a file
PARTS, PARTS_A_SECOND = 64, 25  # of files per network: a burst of 32 MB, a rate of 13 MB/s
TOO_MUCH = "too many messages"

Rule = Callable[[Any], bool]  # whether a decoded field of a message is valid


def _numbers(count: int, reach: float = FAR) -> Rule:
    return lambda value: (type(value) is list and len(value) == count
                          and all(widget_validation.is_number_between(part, -reach, reach) for part in value))


def _between(low: float, high: float) -> Rule:
    return lambda value: widget_validation.is_number_between(value, low, high)


def _whole(low: int, high: int) -> Rule:
    return lambda value: type(value) is int and low <= value <= high


def _text(longest: int) -> Rule:
    return lambda value: type(value) is str and len(value) <= longest


def _or_none(rule: Rule) -> Rule:
    return lambda value: value is None or rule(value)


def _is_unit_quaternion(value: Any) -> bool:
    """Whether a decoded field is a unit quaternion, [w, x, y, z]."""
    return _numbers(4, 1.01)(value) and abs(math.hypot(*value) - 1) < 0.01


_SPACE, _words = _numbers(3), _text(widget_validation.LONGEST_TEXT)
#: Every kind of message that the page needs, with all of its fields.
FIELDS: dict[str, dict[str, Rule]] = {
    "GuiUpdateMessage": {  # a visitor may change only the value of a widget
        "uuid": _words, "updates": lambda value: type(value) is dict and list(value) == ["value"]},
    "ViewerCameraMessage": {
        "wxyz": _is_unit_quaternion, "position": _SPACE, "fov": _between(1e-3, math.pi), "near": _between(0, FAR),
        "far": _between(0, FAR), "image_height": _whole(1, LARGEST_CANVAS), "image_width": _whole(1, LARGEST_CANVAS),
        "look_at": _SPACE, "up_direction": _SPACE},
    "ScenePointerMessage": {
        "event_type": lambda value: value in ("click", "rect-select"), "ray_origin": _or_none(_SPACE),
        "ray_direction": _or_none(lambda value: _SPACE(value) and abs(value[2]) > STEEP),
        "screen_pos": lambda value: type(value) is list and len(value) <= 2 and all(map(_numbers(2), value)),
        "modifier": _or_none(_words)},
    upload.START: {"source_component_uuid": _words, "transfer_uuid": _words, "filename": _text(LONGEST_NAME),
                   "mime_type": _words, "part_count": _whole(0, 2**53), "size_bytes": _whole(0, 2**53)},
    upload.PART: {"source_component_uuid": _words, "transfer_uuid": _words, "part_index": _whole(0, 2**53),
                  "content": lambda value: type(value) is bytes},
    "FileTransferPartAck": {"source_component_uuid": _or_none(_words), "transfer_uuid": _words,
                            "transferred_bytes": _whole(0, 2**53), "total_bytes": _whole(0, 2**53)}}


def why_message_refused(message: bytes | str, find: Callable[[str], Any], who: str = "") -> str | None:
    """Returns why a websocket's message from the IP address ``who`` is refused, in words for the log, or None. Parts of
    uploads are handled here. ``find`` returns the page's widget with an id, or None."""
    part_of_file = upload.upload_message_kind(message)
    most = upload.LARGEST_PART if part_of_file == upload.PART else MOST_BYTES
    if not isinstance(message, bytes) or len(message) > most:
        return "a message that is no message of the page"
    try:
        said = msgspec.msgpack.decode(message)
    except (ValueError, RecursionError, TypeError):
        return "a message that is no message of the page"
    kind = said.pop("type", None) if type(said) is dict else None
    fields = FIELDS.get(kind) if type(kind) is str else None
    if fields is None:
        return "a message of a kind that the page has no use for"
    if kind in upload.HEADS and kind != part_of_file:
        return "a file that no page sends"
    if said.keys() != fields.keys() or not all(rule(said[name]) for name, rule in fields.items()):
        return f"a {kind} with fields that it cannot have"
    if kind == "ViewerCameraMessage" and math.dist(said["position"], said["look_at"]) < NEAR:
        return "a camera that looks nowhere"
    if kind == "ScenePointerMessage":
        return None if _is_pointer_event(said) else "a place that nobody can point at"
    if part_of_file:
        box = upload.uploads_of_button(find(said["source_component_uuid"]))
        return "a file that nobody has asked for" if box is None else box.handle_message(part_of_file, said, who)
    if kind == "GuiUpdateMessage":
        widget = find(said["uuid"])
        return "a widget that is not there" if widget is None else \
            widget_validation.why_value_refused(widget, said["updates"]["value"])
    return None


def _is_pointer_event(said: dict[str, Any]) -> bool:
    """Whether a decoded pointer message is complete: a click has a ray and a position, a rectangle two corners."""
    if said["event_type"] == "click":
        return said["ray_origin"] is not None and said["ray_direction"] is not None and len(said["screen_pos"]) == 1
    return len(said["screen_pos"]) == 2


class IncomingMessageFilter:
    """Filter of a websocket's incoming messages: replaces its ``recv``, and passes only valid ones on to the viewer.

    ``who`` is the IP address, ``find`` returns a widget by its id, ``parts`` limits parts of files of its network, and
    ``keep_away`` is called if the client misbehaves. Refusals are logged in ``refusals``."""

    def __init__(self, connection: Any, who: str, refusals: RefusalLog, parts: TokenBucket, find: Callable[[str], Any],
                 keep_away: Callable[[], None]):
        self._connection, self._address, self._refusals = connection, who, refusals
        self._parts, self._find, self._keep_away = parts, find, keep_away
        self._receive, self._rate, self._calm = connection.recv, TokenBucket(MESSAGES, A_SECOND), monotonic()
        self._first: bytes | None = None
        connection.recv = self._next_valid_message

    async def wait_for_first_message(self) -> None:
        """Waits for the first valid message, which the viewer receives later; raises what ``recv`` raises."""
        self._first = await self._next_valid_message()

    async def _next_valid_message(self, *args: Any, **options: Any) -> Any:
        """Returns the next valid message that the viewer needs, as ``recv`` would; delays a client above its rate."""
        if self._first is not None:
            first, self._first = self._first, None
            return first
        while True:
            message = await self._receive_within_size(*args, **options)
            why = why_message_refused(message, self._find, self._address)
            of_file = why is None and upload.upload_message_kind(message)
            self._rate.debit(PART_AS if of_file else 1 + len(message) / BYTES_AS_ONE + (REFUSED_AS if why else 0))
            await self._throttle()
            if of_file:
                self._parts.debit()
                await asyncio.sleep(self._parts.delay(0))
            if why is not None:
                self._refusals.record(why, self._address)
            elif not of_file:
                return message

    async def _receive_within_size(self, *args: Any, **options: Any) -> Any:
        try:
            return await self._receive(*args, **options)
        except ConnectionClosed as closed:
            if closed.sent and closed.sent.code == CloseCode.MESSAGE_TOO_BIG:
                self._refusals.record("a message above 1 MB", self._address)
                self._keep_away()
            raise

    async def _throttle(self) -> None:
        """Waits while the client is above its rate limit; closes the websocket and raises if that continues."""
        if self._rate.tokens > 0.25 * self._rate.most:
            self._calm = monotonic()
        elif monotonic() - self._calm > PATIENCE:
            self._refusals.record(TOO_MUCH, self._address)
            self._keep_away()
            await close_websocket(self._connection, TOO_MUCH)
            raise self._connection.protocol.close_exc
        if self._rate.tokens < 0:
            await asyncio.sleep(self._rate.delay(0))
