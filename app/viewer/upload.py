"""Uploads: a browser's file, received part by part and kept on disk, not in memory.

The viewer would store whatever is sent. Its upload button is only the address that a browser sends to; parts are
validated and stored here, and do not reach the viewer."""

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
PART_BYTES = 512 * 1024  # of each part from the viewer's page
LARGEST = 32_000_000  # bytes of a file; also in TOO_LARGE
LARGEST_PART = PART_BYTES + 1000  # bytes of a message with a part
ROOM = DiskQuota(128_000_000, 256_000_000)  # bytes on the disk for the files of one network, and of all visitors
STUCK = 30.0  # seconds without a part after which another file may replace an unfinished one
GONE_WITHIN = 2.0  # timeout in s for deleting a folder that a killed process may still write to
_OWN = "lab_upload"  # attribute of a button that holds its upload
#: First bytes of such messages from the viewer's page, with fields in this order. Others are not parsed.
HEADS = {kind: bytes([0x80 + fields, 0xA4]) + b"type" + bytes([0xA0 + len(kind)]) + kind.encode()
         for kind, fields in ((START, 7), (PART, 5))}
NO_ROOM = lazy("The server has no room for the file; try again later")
TOO_LARGE = lazy("The file is larger than 32 MB; give fewer times, or judge it with `mpm-lab judge`")


def upload_message_kind(message: bytes | str) -> str | None:
    """Returns ``START`` or ``PART`` if an undecoded message starts an upload or is a part of a file; else None."""
    return next((kind for kind, head in HEADS.items() if isinstance(message, bytes) and message.startswith(head)), None)


@dataclass
class _IncomingFile:
    """File being received into an open file on disk; ``size`` in bytes, ``since`` on the monotonic clock in s."""

    transfer: str
    name: str
    size: int
    into: IO[bytes]
    parts: int = 0  # received so far
    since: float = field(default_factory=monotonic)  # time of the last part

    @property
    def received_bytes(self) -> int:
        return min(self.size, self.parts * PART_BYTES)


class VisitorUploads:
    """Uploads of one visitor by a ``button``, one at a time. ``on_file(name, path)`` receives a complete file, which
    the next one will replace; ``on_refusal`` a sentence. All but :meth:`close` is called on the web server's loop."""

    def __init__(self, gui: viser.GuiApi, button: viser.GuiUploadButtonHandle, on_file: Callable[[str, Path], None],
                 on_refusal: Callable[[str], None]):
        self._gui, self._button, self._on_file, self._on_refusal = gui, button, on_file, on_refusal
        self._folder: Path | None = None  # made for the first one
        self._coming_file: _IncomingFile | None = None
        self._reserved: list[tuple[str, int]] = []  # address and bytes, of the present file and the one being received
        self._open, self._lock = False, threading.Lock()
        object.__setattr__(button, _OWN, self)  # the viewer's own setter accepts its properties only

    @property
    def folder(self) -> Path:
        """The folder of this visitor's files; deleted at the end of the process at the latest."""
        if self._folder is None:
            self._folder = Path(tempfile.mkdtemp(prefix="mpm-lab-"))
            weakref.finalize(self, shutil.rmtree, self._folder, ignore_errors=True)
        return self._folder

    @property
    def progress_text(self) -> str:
        """The progress of the present upload in words, or ""."""
        file = self._coming_file
        return "" if file is None else tr("The file is coming: {received:.1f} of {size:.1f} MB are here",
                                          received=file.received_bytes / 1e6, size=file.size / 1e6)

    def open(self) -> None:
        """Accepts files from now on."""
        self._open = True

    def close(self) -> None:
        """Refuses further parts when the visitor leaves."""
        with self._lock:
            self._open = False
            self._delete_incomplete_file()

    def delete_files(self) -> None:
        """Deletes all files of the visitor, once no process works with them any more, and releases their quota."""
        end = monotonic() + GONE_WITHIN
        while self._folder and self._folder.exists() and monotonic() < end:
            shutil.rmtree(self._folder, ignore_errors=True)
            sleep(0.02)
        with self._lock:
            self._release_quota(0)

    def handle_message(self, kind: str, said: dict[str, Any], who: str = "") -> str | None:
        """Handles a message (``START`` or ``PART``) from an IP address; returns why it is refused, or None."""
        with self._lock:
            if not self._open:
                return "a file for nobody"
            try:
                return self._start(said, who) if kind == START else self._add_part(said)
            except OSError:
                self._delete_incomplete_file()
                return self._refuse_for_lack_of_space()

    def _start(self, said: dict[str, Any], who: str) -> str | None:
        if self._coming_file is not None:
            if monotonic() - self._coming_file.since < STUCK:
                return "a file while another one is on its way"
            self._delete_incomplete_file()
        if said["size_bytes"] > LARGEST:
            self._on_refusal(TOO_LARGE)
            return "a file that is too large"
        if said["part_count"] != math.ceil(said["size_bytes"] / PART_BYTES):
            return "a file in parts that it cannot have"
        if not ROOM.reserve(who, said["size_bytes"]):
            return self._refuse_for_lack_of_space()
        self._reserved.append((who, said["size_bytes"]))
        into = open(self.folder / "coming", "wb")  # closed with its last part
        self._coming_file = _IncomingFile(said["transfer_uuid"], said["filename"], said["size_bytes"], into)
        self._acknowledge_part(self._coming_file)
        return None

    def _add_part(self, said: dict[str, Any]) -> str | None:
        file = self._coming_file
        if file is None or said["transfer_uuid"] != file.transfer:
            return "a part of no file"
        expected = min(PART_BYTES, file.size - file.received_bytes)
        if said["part_index"] != file.parts or len(said["content"]) != expected:
            return "a part of a file that is not the next one"
        file.into.write(said["content"])
        file.parts, file.since = file.parts + 1, monotonic()
        self._acknowledge_part(file)
        return None

    def _acknowledge_part(self, file: _IncomingFile) -> None:
        """Tells the browser how many bytes of a file have arrived; passes a complete file to ``on_file``."""
        self._gui._websock_interface.queue_message(FileTransferPartAck(
            self._button._impl.uuid, file.transfer, file.received_bytes, file.size))
        if file.received_bytes == file.size:
            file.into.close()
            self._coming_file = None
            self._release_quota(1)  # the previous file is replaced
            self._on_file(file.name, self.folder / "coming")

    def _refuse_for_lack_of_space(self) -> str:
        self._on_refusal(NO_ROOM)
        return "a file for which there is no room"

    def _delete_incomplete_file(self) -> None:
        """Deletes the file being received, if any, and releases its quota."""
        if self._coming_file is not None:
            self._coming_file.into.close()
            self._coming_file = None
            (self.folder / "coming").unlink(missing_ok=True)
            who, size = self._reserved.pop()
            ROOM.release(who, size)

    def _release_quota(self, kept: int) -> None:
        """Releases the disk quota of all files but the last ``kept``."""
        while len(self._reserved) > kept:
            ROOM.release(*self._reserved.pop(0))


def uploads_of_button(button: Any) -> VisitorUploads | None:
    """Returns the uploads that belong to a widget, None if it is no upload button of the page."""
    return getattr(button, _OWN, None)
