"""What is drawn on when nobody looks: a sheet that keeps its marks, and a scene of the viewer's that sends nothing."""

from types import SimpleNamespace

import numpy as np

from app.frame.primitives import StageMetrics


class Handle(SimpleNamespace):
    """Something that was drawn. Its properties are set one by one, or by messages to the browser."""

    def __init__(self, name):
        super().__init__(name=name, text="", points=np.zeros((0, 3)), visible=True, font_screen_scale=1.0, anchor="",
                         position=(0.0, 0.0, 0.0))
        buffer = SimpleNamespace(push_all=lambda messages: None)
        self._impl = SimpleNamespace(props=self, api=SimpleNamespace(
            _owner_id="", _websock_interface=SimpleNamespace(get_message_buffer=lambda: buffer)))


class RecordingScene:
    """Remembers what was drawn, by the last part of its name."""

    def __init__(self):
        self.made = {}

    def __getattr__(self, kind):
        return lambda name, *args, **options: self.made.setdefault(name.rsplit("/", 1)[1], Handle(name))


class RecordingSurface:
    """Keeps what was shown last under each name."""

    def __init__(self):
        self.marks, self.visible, self.stage_metrics = {}, True, StageMetrics(600.0)

    def show_marks(self, *marks):
        self.marks.update((mark.name, mark) for mark in marks)

    def add_child(self, name):
        return RecordingSurface()
