"""Hearing: a websocket gives the viewer only what a browser may say, and at a browser's pace."""

import asyncio
from collections.abc import Callable
from time import monotonic
from typing import Any

from websockets.exceptions import ConnectionClosed
from websockets.frames import CloseCode

from app.doors.faults import Refusals
from app.doors.network import Bucket
from app.viewer import messages, upload
from app.viewer.line import send_away

# A browser sends 20 values of a widget and 50 camera messages a second at most, and some in one go after a pause.
MESSAGES, A_SECOND, PATIENCE = 200, 100, 4.0  # at once, in the long run; seconds for which more are put up with
BYTES_AS_ONE, REFUSED_AS = 1000, 3  # what large and refused messages count as
PART_AS = 4  # and a part of a file that is taken
PARTS, PARTS_A_SECOND = 64, 25  # of files, of all of one network: one of 32 MB at once, 13 MB a second in the long run
TOO_MUCH = "too many messages"


class Hearing:
    """Of one websocket, whose ``recv`` it takes the place of.

    Parameters
    ----------
    connection, who
        The websocket, and the IP address at its other end.
    refusals
        Where it is noted what is refused.
    parts
        What it shares with others of its network: parts of files that are taken.
    find
        Gives a widget of the page behind it by its id, or None.
    keep_away
        Is told the address of one that says what no browser does.
    """

    def __init__(self, connection: Any, who: str, refusals: Refusals, parts: Bucket, find: Callable[[str], Any],
                 keep_away: Callable[[str], None]):
        self._connection, self._who, self._refusals = connection, who, refusals
        self._parts, self._find, self._keep_away = parts, find, keep_away
        self._receive, self._rate, self._calm = connection.recv, Bucket(MESSAGES, A_SECOND), monotonic()
        self._first: bytes | None = None
        connection.recv = self._next

    async def first_word(self) -> None:
        """Until something has been said that a browser may say; the viewer hears it later. Raises what ``recv`` raises
        when the websocket is closed."""
        self._first = await self._next()

    async def _next(self, *args: Any, **options: Any) -> Any:
        if self._first is not None:
            first, self._first = self._first, None
            return first
        while True:
            message = await self._received(*args, **options)
            refusal = messages.refusal(message, self._find, self._who)
            of_file = refusal is None and upload.kind_of(message)
            self._rate.pay(PART_AS if of_file else 1 + len(message) / BYTES_AS_ONE + (REFUSED_AS if refusal else 0))
            await self._keep_pace()
            if of_file:
                self._parts.pay()
                await asyncio.sleep(self._parts.wait(0))
            if refusal is not None:
                self._refusals.note(refusal, self._who)
            elif not of_file:
                return message

    async def _received(self, *args: Any, **options: Any) -> Any:
        try:
            return await self._receive(*args, **options)
        except ConnectionClosed as closed:
            if closed.sent and closed.sent.code == CloseCode.MESSAGE_TOO_BIG:
                self._refusals.note("a message above 1 MB", self._who)
                self._keep_away(self._who)
            raise

    async def _keep_pace(self) -> None:
        """Wait for a while after too much; who goes on with it is sent away."""
        if self._rate.left > 0.25 * self._rate.most:
            self._calm = monotonic()
        elif monotonic() - self._calm > PATIENCE:
            self._refusals.note(TOO_MUCH, self._who)
            self._keep_away(self._who)
            await send_away(self._connection, TOO_MUCH)
            raise self._connection.protocol.close_exc
        if self._rate.left < 0:
            await asyncio.sleep(self._rate.wait(0))
