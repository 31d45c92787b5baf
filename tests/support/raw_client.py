"""A visitor without a browser: it speaks the viewer's own language over a bare websocket, and may say anything."""

import json
import threading
import uuid
from collections import Counter
from time import monotonic

from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from app.commands.bench.class_load import is_frame
from app.viewer.send_queue import PROTOCOL
from app.viewer.websocket_client import pack_message, unpack_messages
from tests.support.processes import HANG, wait_until

CAMERA = {"type": "ViewerCameraMessage", "wxyz": [0.0, 1.0, 0.0, 0.0], "position": [0.0, 0.0, 30.0], "fov": 0.07,
          "near": 1.0, "far": 600.0, "image_height": 720, "image_width": 600, "look_at": [0.0, 0.0, 0.0],
          "up_direction": [0.0, 1.0, 0.0]}


class RawClient:
    """One websocket. It reads all that comes, on a thread of its own: ``widgets`` are the inputs that the page has, by
    id, with what the page has said of them; ``frames`` counts the pictures of particles."""

    def __init__(self, address, headers=None, arrive=True, **options):
        self.socket = connect(address.replace("http", "ws", 1), subprotocols=[PROTOCOL], compression=None,
                              additional_headers=headers, max_size=None, ping_interval=None, open_timeout=HANG,
                              **options)
        self.widgets, self.kinds, self.frames, self.closed, self.html = {}, Counter(), 0, None, {}
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()
        if arrive:
            self.send(CAMERA)

    def send(self, message):
        """Say something; bytes go as they are."""
        self.socket.send(message if isinstance(message, bytes | str) else pack_message(message))

    def set(self, widget, value, **others):
        self.send({"type": "GuiUpdateMessage", "uuid": widget, "updates": {"value": value, **others}})

    def follow(self, link):
        """Say, as a browser does, which scene its address has: who has none sees the opening, beside a pinned run."""
        self.set(self.find("kept by the browser"), json.dumps({"link": link}))

    def enter(self, widget, text, store="kept by the browser"):
        """Type a text and finish it, as with Enter; ``store`` is the label of the widget through which that is said."""
        self.set(self.find(store), json.dumps({"entered": [widget, text]}))

    def find(self, label):
        """The id of the widget with this label or this hint, once it is there."""
        wait_until(lambda: label in self._labels(), label)
        return self._labels()[label]

    def label(self, widget):
        return self.widgets[widget]["props"].get("label", self.widgets[widget]["type"])

    def rate(self, seconds):
        """Frames a second, over some time from now."""
        begun, frames = monotonic(), self.frames
        threading.Event().wait(seconds)
        return (self.frames - frames) / (monotonic() - begun)

    def close(self):
        self.socket.close()
        self._reader.join(10)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def _labels(self):
        return {widget["props"].get(text): name for text in ("hint", "label")
                for name, widget in dict(self.widgets).items()}

    def _read(self):
        try:
            for raw in self.socket:
                messages = unpack_messages(raw)
                for message in messages:
                    self._hear(message)
                self.frames += any(map(is_frame, messages))
        except ConnectionClosed:
            pass
        self.closed = self.socket.close_code

    def _hear(self, message):
        kind = message["type"]
        self.kinds[kind] += 1
        if kind == "GuiUpdateMessage":
            for name, value in message["updates"].items():
                widget = self.widgets.get(message["uuid"], {"props": {}})
                (widget if name == "value" else widget["props"])[name] = value
                if name == "content":
                    self.html[message["uuid"]] = value
        elif kind == "GuiRemoveMessage":
            self.widgets.pop(message["uuid"], None)
        elif kind == "GuiHtmlMessage":
            self.html[message["uuid"]] = message["props"]["content"]
        elif kind.startswith("Gui") and ("value" in message or kind == "GuiUploadButtonMessage"):
            self.widgets[message["uuid"]] = message


def unknown_widget_id():
    """An id that no widget has."""
    return str(uuid.uuid4())
