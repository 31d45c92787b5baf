"""Upload: a file from a browser, taken in part by part and kept on disk, never in memory.

The viewer would hold whatever is sent. Its button for files is therefore only what a browser sends to; what comes is
checked and taken in here, and the viewer does not hear of it.
"""

import math
import shutil
import tempfile
import threading
import weakref
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from time import monotonic, sleep
from typing import IO, Any

import viser
from viser._messages import FileTransferPartAck

from app.access.network_limits import DiskQuota
from app.language.translation import lazy, tr

START, PART = "FileTransferStartUpload", "FileTransferPart"
PART_BYTES = 512 * 1024  # as the viewer's page cuts a file
LARGEST = 32_000_000  # bytes of a file; TOO_LARGE says it
LARGEST_PART = PART_BYTES + 1000  # bytes of a message with a part
ROOM = DiskQuota(128_000_000, 256_000_000)  # bytes on the disk for the files of one network, and of all visitors
STUCK = 30.0  # seconds without a part after which a file is not waited for, if another one is to come
GONE_WITHIN = 2.0  # seconds in which a folder can be emptied in which a process that was killed has just written
_OWN = "lab_upload"  # where a button for files has its own
#: What such messages begin with, as the viewer's page writes them: fields in this order. Others are not even read.
HEADS = {kind: bytes([0x80 + fields, 0xA4]) + b"type" + bytes([0xA0 + len(kind)]) + kind.encode()
         for kind, fields in ((START, 7), (PART, 5))}
NO_ROOM = lazy("The server has no room for the file; try again later")
TOO_LARGE = lazy("The file is larger than 32 MB; give fewer times, or judge it with `mpm-lab judge`")


def kind_of(message: bytes | str) -> str | None:
    """Of a message that brings a file, or begins to, which of the two it is."""
    return next((kind for kind, head in HEADS.items() if isinstance(message, bytes) and message.startswith(head)), None)


@dataclass
class _ComingFile:
    """A file on its way."""

    transfer: str
    name: str
    size: int
    into: IO[bytes]
    parts: int = 0  # that have come
    since: float = field(default_factory=monotonic)  # the last one

    @property
    def received(self) -> int:
        return min(self.size, self.parts * PART_BYTES)


class Upload:
    """One visitor's: one file at a time. ``on_file(name, path)`` gets a file that has come, in the ``folder``, where
    the next one will take its place; ``on_refusal`` a sentence. The web server's loop calls all but :meth:`close`."""

    def __init__(self, gui: viser.GuiApi, button: viser.GuiUploadButtonHandle, on_file: Callable[[str, Path], None],
                 on_refusal: Callable[[str], None]):
        self._gui, self._button, self._on_file, self._on_refusal = gui, button, on_file, on_refusal
        self._folder: Path | None = None  # made for the first one
        self._coming_file: _ComingFile | None = None
        self._taken: list[tuple[str, int]] = []  # of the room: of the file that is there, and of the one that comes
        self._open, self._lock = False, threading.Lock()
        object.__setattr__(button, _OWN, self)  # the viewer's own way takes its properties only

    @property
    def folder(self) -> Path:
        """Where files of this visitor are; it goes with the last of this process at the latest."""
        if self._folder is None:
            self._folder = Path(tempfile.mkdtemp(prefix="mpm-lab-"))
            weakref.finalize(self, shutil.rmtree, self._folder, ignore_errors=True)
        return self._folder

    @property
    def coming(self) -> str:
        """What is on its way, in words; "" for nothing."""
        file = self._coming_file
        return "" if file is None else tr("The file is coming: {received:.1f} of {size:.1f} MB are here",
                                          received=file.received / 1e6, size=file.size / 1e6)

    def open(self) -> None:
        """From now on files are taken in: all is there that they are for."""
        self._open = True

    def close(self) -> None:
        """The visitor has gone: nothing more of a file comes."""
        with self._lock:
            self._open = False
            self._drop()

    def clear(self) -> None:
        """Nothing of a file stays, once nobody works with it any more."""
        end = monotonic() + GONE_WITHIN
        while self._folder and self._folder.exists() and monotonic() < end:
            shutil.rmtree(self._folder, ignore_errors=True)
            sleep(0.02)
        with self._lock:
            self._give_back(0)

    def take(self, kind: str, said: dict[str, Any], who: str = "") -> str | None:
        """Take in a message with good fields from an IP address; why it is refused, if it is."""
        with self._lock:
            if not self._open:
                return "a file for nobody"
            try:
                return self._start(said, who) if kind == START else self._add(said)
            except OSError:
                self._drop()
                return self._no_room()

    def _start(self, said: dict[str, Any], who: str) -> str | None:
        if self._coming_file is not None:
            if monotonic() - self._coming_file.since < STUCK:
                return "a file while another one is on its way"
            self._drop()
        if said["size_bytes"] > LARGEST:
            self._on_refusal(TOO_LARGE)
            return "a file that is too large"
        if said["part_count"] != math.ceil(said["size_bytes"] / PART_BYTES):
            return "a file in parts that it cannot have"
        if not ROOM.take(who, said["size_bytes"]):
            return self._no_room()
        self._taken.append((who, said["size_bytes"]))
        into = open(self.folder / "coming", "wb")  # closed with its last part
        self._coming_file = _ComingFile(said["transfer_uuid"], said["filename"], said["size_bytes"], into)
        self._follow(self._coming_file)
        return None

    def _add(self, said: dict[str, Any]) -> str | None:
        file = self._coming_file
        if file is None or said["transfer_uuid"] != file.transfer:
            return "a part of no file"
        expected = min(PART_BYTES, file.size - file.received)
        if said["part_index"] != file.parts or len(said["content"]) != expected:
            return "a part of a file that is not the next one"
        file.into.write(said["content"])
        file.parts, file.since = file.parts + 1, monotonic()
        self._follow(file)
        return None

    def _follow(self, file: _ComingFile) -> None:
        """Tell the browser how much has come; hand over a file that is complete."""
        self._gui._websock_interface.queue_message(FileTransferPartAck(
            self._button._impl.uuid, file.transfer, file.received, file.size))
        if file.received == file.size:
            file.into.close()
            self._coming_file = None
            self._give_back(1)  # what was there has to go
            self._on_file(file.name, self.folder / "coming")

    def _no_room(self) -> str:
        self._on_refusal(NO_ROOM)
        return "a file for which there is no room"

    def _drop(self) -> None:
        """What has come of a file that does not come whole goes."""
        if self._coming_file is not None:
            self._coming_file.into.close()
            self._coming_file = None
            (self.folder / "coming").unlink(missing_ok=True)
            who, size = self._taken.pop()
            ROOM.give_back(who, size)

    def _give_back(self, but: int) -> None:
        """The room of all files but so many of the last."""
        while len(self._taken) > but:
            ROOM.give_back(*self._taken.pop(0))


def upload_of_button(button: Any) -> Upload | None:
    """The upload of a button for files, if it has one."""
    return getattr(button, _OWN, None)
