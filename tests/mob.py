"""A mob at the doors of a lab, until it is ended: ``python -m tests.mob ADDRESS CODE``.

It guesses codes, sends 1,000 messages a second, gives a file that is a bomb and one that never comes whole, and opens
500 lines that say nothing. All of it comes from one address, another one than that of the class: all of 127.0.0.0/8 is
this machine.
"""

from __future__ import annotations

import asyncio
import io
import logging
import os
import sys
import zipfile
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager, suppress
from itertools import count
from urllib.parse import quote

import websockets.asyncio.client as client
from websockets.exceptions import WebSocketException

from app.viewer import upload
from app.viewer.client import packed, unpacked
from app.viewer.wire import PROTOCOL
from tests.raw import CAMERA

FROM = "127.0.0.55"
HALF_OPEN = 500
GUESSES, MESSAGES = 50, 1000  # a second
GONE = (OSError, WebSocketException, asyncio.IncompleteReadError, TimeoutError)


class Mob:
    """At ``address`` (host:port); who has the ``code`` comes in as a visitor."""

    def __init__(self, address: str, code: str):
        self.host, port = address.split(":")
        self.port, self.code, self.cookie = int(port), code, ""

    async def riot(self) -> None:
        self.cookie = (await self.ask(self.code)).partition("Set-Cookie: ")[2].partition(";")[0]
        print("here", flush=True)
        await asyncio.gather(self.guess(), self.talk(), self.bomb(), self.half_open())

    async def ask(self, code: str) -> str:
        """The answer's head."""
        reader, writer = await asyncio.open_connection(self.host, self.port, local_addr=(FROM, 0))
        try:
            writer.write((f"GET /enter HTTP/1.1\r\nHost: {self.host}:{self.port}\r\n"
                          f"X-Class-Code: {quote(code)}\r\n\r\n").encode())
            return (await asyncio.wait_for(reader.readuntil(b"\r\n\r\n"), 20)).decode()
        finally:
            writer.close()

    @asynccontextmanager
    async def page(self, wanted: Callable[[dict], bool]) -> AsyncIterator[tuple[client.ClientConnection, str]]:
        """A socket, which is read, and the id of the first widget on its page that is ``wanted``."""
        async with client.connect(f"ws://{self.host}:{self.port}", subprotocols=[PROTOCOL], compression=None,
                                  max_size=None, ping_interval=None, open_timeout=20, close_timeout=1,
                                  local_addr=(FROM, 0), additional_headers={"Cookie": self.cookie}) as socket:
            await socket.send(packed(CAMERA))
            found = ""
            async for raw in socket:
                if found := next((said["uuid"] for said in unpacked(raw) if wanted(said)), ""):
                    break
            reading = asyncio.create_task(drained(socket))
            try:
                yield socket, found
            finally:
                reading.cancel()

    async def guess(self) -> None:
        for k in count():
            with suppress(*GONE):
                await self.ask(f"wrong-{k}")
            await asyncio.sleep(1 / GUESSES)

    async def talk(self) -> None:
        """Whoever is sent away comes again."""
        def is_slider(said: dict) -> bool:
            return str(said.get("props", {}).get("label")).startswith("Cells")

        while True:
            with suppress(*GONE):
                async with self.page(is_slider) as (socket, slider):
                    for cells in count():
                        value = {"value": 39.0 + cells % 4}
                        await socket.send(packed({"type": "GuiUpdateMessage", "uuid": slider, "updates": value}))
                        if cells % 10 == 0:
                            await asyncio.sleep(10 / MESSAGES)
            await asyncio.sleep(0.5)

    async def half_open(self) -> None:
        """As many as there can be; those that are cut are opened again."""
        lines: list[asyncio.StreamWriter] = []
        while True:
            lines = [line for line in lines if not line.is_closing()]
            for _ in range(min(50, HALF_OPEN - len(lines))):
                with suppress(*GONE):
                    _, line = await asyncio.open_connection(self.host, self.port, local_addr=(FROM, 0))
                    line.write(b"GET / HTTP/1.1\r\nHost: ")
                    lines.append(line)
            await asyncio.sleep(0.2)

    async def bomb(self) -> None:
        """A file that is large once it is unpacked, and one of 31.9 MB whose last part never comes."""
        await asyncio.gather(self._give("bomb.npz", bomb(), True),
                             self._give("half.csv", os.urandom(31_900_000), False))

    async def _give(self, name: str, content: bytes, whole: bool) -> None:
        for number in count():
            with suppress(*GONE):
                async with self.page(lambda said: said["type"] == "GuiUploadButtonMessage") as (socket, box):
                    await give(socket, box, name, content, f"file {number}", whole)
                    await asyncio.sleep(20)
            await asyncio.sleep(1)


async def drained(socket: client.ClientConnection) -> None:
    with suppress(*GONE):
        async for _ in socket:
            pass


async def give(socket: client.ClientConnection, box: str, name: str, content: bytes, transfer: str,
               whole: bool) -> None:
    """Send a file as a browser does, or all but the last part of it, at 10 MB a second."""
    size = upload.PART_BYTES
    parts = [content[at:at + size] for at in range(0, len(content), size)]
    await socket.send(packed({"type": upload.START, "source_component_uuid": box, "transfer_uuid": transfer,
                              "filename": name, "mime_type": "", "part_count": len(parts), "size_bytes": len(content)}))
    for k, part in enumerate(parts if whole else parts[:-1]):
        await socket.send(packed({"type": upload.PART, "source_component_uuid": box, "transfer_uuid": transfer,
                                  "part_index": k, "content": part}))
        await asyncio.sleep(0.05)


def bomb() -> bytes:
    """400 MB of nothing, in 400 kB."""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr("x.npy", bytes(400_000_000))
    return out.getvalue()


if __name__ == "__main__":
    logging.getLogger("websockets.client").disabled = True
    os.nice(19)  # what the mob costs itself is for other machines to bear
    asyncio.run(Mob(*sys.argv[1:3]).riot())
