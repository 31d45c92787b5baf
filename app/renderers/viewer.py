"""The viewer as a renderer: marks as points and lines of a client's scene, in the plane z = 0, and labels over them."""

from typing import Any

import numpy as np
import viser

from app.frame.marks import AWAY, Dots, Label, Lines, Mark, Room
from app.renderers.lettering import Lettering
from app.viewer.widgets import put_arrays


class Sheet:
    """Draws marks under the name ``at`` of one client's scene; only what has changed is sent."""

    def __init__(self, client: viser.ClientHandle, lettering: Lettering, at: str):
        self._client, self._lettering, self._at = client, lettering, at
        self._root, self._visible = client.scene.add_frame(at, show_axes=False), True
        self._drawn: dict[str, tuple[Any, Mark]] = {}  # with its handle what was last seen under each name

    @property
    def visible(self) -> bool:
        return self._visible

    @visible.setter
    def visible(self, visible: bool) -> None:
        if visible != self._visible:  # said with every frame
            self._root.visible = self._visible = visible
            self._lettering.show(self._at, visible)

    @property
    def room(self) -> Room:
        return self._lettering.room

    def child(self, name: str) -> "Sheet":
        return Sheet(self._client, self._lettering, f"{self._at}/{name}")

    def show(self, *marks: Mark) -> None:
        changed, turned = [], []
        for mark in marks:
            if isinstance(mark, Label):
                self._lettering.write(self._at, mark)
                continue
            handle, before = self._drawn.get(mark.name, (None, None))
            seen = len(mark) > 0
            if seen and mark is not before:
                handle = handle or self._made(mark)
                changed.append((handle, self._arrays(handle, mark, before)))
                self._drawn[mark.name] = handle, mark
            if handle is not None and handle.visible != seen:
                turned.append((handle, seen))
        if changed:
            put_arrays(changed)
        for handle, seen in turned:
            handle.visible = seen

    def _made(self, mark: Dots | Lines) -> Any:
        s, name = self._client.scene, f"{self._at}/{mark.name}"
        match mark:
            case Lines():
                return s.add_line_segments(name, np.full((1, 2, 3), AWAY, np.float32), (0, 0, 0),
                                           thickness=mark.thickness, thickness_units="screen")
            case Dots():
                return s.add_point_cloud(name, np.full((1, 3), AWAY, np.float32), np.zeros((1, 3), np.uint8),
                                         point_size=mark.size / 2, point_shape=mark.shape, point_shading="flat",
                                         precision="float16" if mark.points.dtype == np.float16 else "float32")

    def _arrays(self, handle: Any, mark: Dots | Lines, before: Any) -> dict[str, np.ndarray]:
        """What of a thing's arrays is to be sent; all else is set here."""
        arrays = {"points": mark.segments if isinstance(mark, Lines) else mark.points}
        if before is None or mark.colours is not before.colours:
            arrays["colors"] = np.asarray(mark.colours, np.uint8)
        if isinstance(mark, Dots):
            if before is None or mark.size != before.size:
                handle.point_size = mark.size / 2  # the viewer counts from the middle
            if before is None or mark.origin != before.origin:
                handle.position = (*mark.origin, 0.0)
        return arrays
