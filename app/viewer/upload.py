"""Upload: a file from a browser, taken in part by part and kept on disk, never in memory.

The viewer would hold whatever is sent. Its button for files is therefore only what a browser sends to; what comes is
checked and taken in here, and the viewer does not hear of it.
"""

import math
import tempfile
import threading
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

import viser
from viser._messages import FileTransferPartAck

START, PART = "FileTransferStartUpload", "FileTransferPart"
PART_BYTES = 512 * 1024  # as the viewer's page cuts a file
LARGEST = 32_000_000  # bytes of a file
LARGEST_PART = PART_BYTES + 1000  # bytes of a message with a part
_OWN = "lab_upload"  # where a button for files has its own
#: What such messages begin with, as the viewer's page writes them: fields in this order. Others are not even read.
HEADS = {kind: bytes([0x80 + fields, 0xA4]) + b"type" + bytes([0xA0 + len(kind)]) + kind.encode()
         for kind, fields in ((START, 7), (PART, 5))}
NO_ROOM = "The server has no room for the file; try again later"
TOO_LARGE = f"The file is larger than {LARGEST / 1e6:g} MB; give fewer times, or judge it with `mpm-lab judge`"


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

    @property
    def received(self) -> int:
        return min(self.size, self.parts * PART_BYTES)


class Upload:
    """One visitor's: one file at a time. ``on_file(name, path)`` gets a file that has come, in the ``folder``, where
    the next one will take its place; ``on_refusal`` a sentence. The web server's loop calls all but :meth:`close`."""

    def __init__(self, gui: viser.GuiApi, button: viser.GuiUploadButtonHandle, on_file: Callable[[str, Path], None],
                 on_refusal: Callable[[str], None]):
        self._gui, self._button, self._on_file, self._on_refusal = gui, button, on_file, on_refusal
        self._temporary = tempfile.TemporaryDirectory(prefix="mpm-lab-", ignore_cleanup_errors=True)
        self.folder = Path(self._temporary.name)
        self._coming_file: _ComingFile | None = None
        self._closed, self._lock = False, threading.Lock()
        object.__setattr__(button, _OWN, self)  # the viewer's own way takes its properties only

    @property
    def coming(self) -> str:
        """What is on its way, in words; "" for nothing."""
        file = self._coming_file
        return "" if file is None else f"The file is coming: {file.received / 1e6:.1f} of " \
                                         f"{file.size / 1e6:.1f} MB are here"

    def close(self) -> None:
        """The visitor has gone: nothing of a file stays."""
        with self._lock:
            self._closed = True
            if self._coming_file:
                self._coming_file.into.close()
            self._temporary.cleanup()

    def take(self, kind: str, said: dict[str, Any]) -> str | None:
        """Take in a message with good fields; why it is refused, if it is."""
        with self._lock:
            if self._closed:
                return "a file for nobody"
            try:
                return self._start(said) if kind == START else self._add(said)
            except OSError:
                self._coming_file = None
                self._on_refusal(NO_ROOM)
                return "a file for which there is no room"

    def _start(self, said: dict[str, Any]) -> str | None:
        if self._coming_file is not None:
            return "a file while another one is on its way"
        if said["size_bytes"] > LARGEST:
            self._on_refusal(TOO_LARGE)
            return "a file that is too large"
        if said["part_count"] != math.ceil(said["size_bytes"] / PART_BYTES):
            return "a file in parts that it cannot have"
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
        file.parts += 1
        self._follow(file)
        return None

    def _follow(self, file: _ComingFile) -> None:
        """Tell the browser how much has come; hand over a file that is complete."""
        self._gui._websock_interface.queue_message(FileTransferPartAck(
            self._button._impl.uuid, file.transfer, file.received, file.size))
        if file.received == file.size:
            file.into.close()
            self._coming_file = None
            self._on_file(file.name, self.folder / "coming")


def of(button: Any) -> Upload | None:
    """The upload of a button for files, if it has one."""
    return getattr(button, _OWN, None)
