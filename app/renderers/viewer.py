"""The viewer as a renderer: marks as points, lines and labels of a client's scene, in the plane z = 0."""

from typing import Any
from weakref import WeakKeyDictionary, WeakSet

import numpy as np
import viser

from app.frame.marks import AWAY, RECTANGLE, Dots, Label, Lines, Mark, Room, wrapped
from app.viewer.widgets import put_props


class Sheet:
    """Draws marks under the name ``at`` of one client's scene; only what has changed is sent."""

    def __init__(self, client: viser.ClientHandle, at: str):
        self._client, self._at = client, at
        self._lettering = _LETTERING.setdefault(client.scene, _Lettering())
        self._lettering.sheets.add(self)
        self._root = client.scene.add_frame(at, show_axes=False)
        self._drawn: dict[str, tuple[Any, Mark]] = {}  # with its handle what was last seen under each name

    @property
    def visible(self) -> bool:
        return self._root.visible

    @visible.setter
    def visible(self, visible: bool) -> None:
        self._root.visible = visible

    @property
    def room(self) -> Room:
        camera, (x0, x1, y0, y1) = self._client.camera, RECTANGLE
        return Room(min(camera.image_width / (x1 - x0), camera.image_height / (y1 - y0)), self._lettering.factor)

    def child(self, name: str) -> "Sheet":
        return Sheet(self._client, f"{self._at}/{name}")

    def show(self, *marks: Mark) -> None:
        for mark in marks:
            handle, before = self._drawn.get(mark.name, (None, None))
            seen = bool(mark.text if isinstance(mark, Label) else len(mark))
            if seen and mark != before:
                handle = handle or self._made(mark)
                self._update(handle, mark, before)
                self._drawn[mark.name] = handle, mark
            if handle is not None and handle.visible != seen:
                handle.visible = seen

    def letter(self) -> None:
        """Write the labels as large as those of their scene are now."""
        for handle, mark in list(self._drawn.values()):
            if isinstance(mark, Label):
                handle.font_screen_scale = self._lettering.factor * mark.size

    def _made(self, mark: Mark) -> Any:
        s, name = self._client.scene, f"{self._at}/{mark.name}"
        match mark:
            case Label():
                return s.add_label(name, wrapped(mark.text, mark.width), position=(mark.x, mark.y, 0.0),
                                   anchor=mark.anchor, font_screen_scale=self._lettering.factor * mark.size)
            case Lines():
                return s.add_line_segments(name, np.full((1, 2, 3), AWAY, np.float32), (0, 0, 0),
                                           thickness=mark.thickness, thickness_units="screen")
            case Dots():
                return s.add_point_cloud(name, np.full((1, 3), AWAY, np.float32), np.zeros((1, 3), np.uint8),
                                         point_size=mark.size / 2, point_shape=mark.shape, point_shading="flat",
                                         precision="float16" if mark.points.dtype == np.float16 else "float32")

    def _update(self, handle: Any, mark: Mark, before: Any) -> None:
        if isinstance(mark, Label):
            for name, value in (("text", wrapped(mark.text, mark.width)), ("anchor", mark.anchor),
                                ("font_screen_scale", self._lettering.factor * mark.size)):
                if getattr(handle, name) != value:
                    setattr(handle, name, value)
            if before is None or (mark.x, mark.y) != (before.x, before.y):
                handle.position = (mark.x, mark.y, 0.0)
            return
        changed = {"points": mark.segments if isinstance(mark, Lines) else mark.points}
        if before is None or mark.colours is not before.colours:
            changed["colors"] = np.asarray(mark.colours, np.uint8)
        put_props(handle, changed)
        if isinstance(mark, Lines):
            return
        if before is None or mark.size != before.size:
            handle.point_size = mark.size / 2  # the viewer counts from the middle
        if before is None or mark.origin != before.origin:
            handle.position = (*mark.origin, 0.0)


class _Lettering:
    """How many times as large as usual the labels of a scene are written, and the sheets that they are on."""

    def __init__(self) -> None:
        self.factor, self.sheets = 1.0, WeakSet[Sheet]()  # a sheet knows its scene: held here, it would keep that


_LETTERING: WeakKeyDictionary[viser.SceneApi, _Lettering] = WeakKeyDictionary()


def enlarge(s: viser.SceneApi, factor: float) -> None:
    """Write all labels of a scene so many times as large as usual."""
    lettering = _LETTERING.setdefault(s, _Lettering())
    if lettering.factor != factor:
        lettering.factor = factor
        for sheet in list(lettering.sheets):
            sheet.letter()
