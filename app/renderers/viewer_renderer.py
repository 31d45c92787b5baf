"""Renderer for the viewer: marks as points and lines of a client's scene, in the plane z = 0, with labels above."""

import json
from functools import lru_cache
from html import escape
from threading import RLock
from typing import Any

import numpy as np
import viser

from app.frame.layout import EDGE
from app.frame.primitives import AWAY, Dots, Label, Lines, Mark, StageMetrics, wrap_text
from app.viewer.widget_validation import set_node_arrays

USUAL = (736.0, 358.0, 120.0)  # pixels of the free box and of the gutter left of it, until the browser sends them


class LabelLayer:
    """The labels on one browser's stage, and the visible rectangle and pixel size of that stage.

    The page gives the canvas the rectangle's aspect ratio. Only :meth:`send` sends anything, and only changes."""

    def __init__(self, gui: viser.GuiApi):
        self._html = gui.add_html("")
        self._lock = RLock()
        self._labels: dict[str, dict[str, Label]] = {}  # by names of surfaces
        self._hidden: set[str] = set()
        self._changed = True
        self._box, self._letters, self.dark = USUAL, 1.0, False
        self._bounds_key: tuple | None = None  # box, letters and theme of the present bounds
        self._rectangle = (-EDGE, 1 + EDGE, 0.0, 0.5)

    @property
    def stage_metrics(self) -> StageMetrics:
        """The bounds of the stage in the browser; cached, as they are needed several times per frame."""
        now = self._box, self._letters, self.dark
        if now != self._bounds_key:
            (width, height, gutter), self._bounds_key = self._box, now
            self._bounds = StageMetrics(width, self._letters, height / width, gutter / width, self.dark)
        return self._bounds

    def set_pixel_layout(self, width: float, height: float, gutter: float, letters: float = 1.0) -> bool:
        """Sets the pixels of the stage's width (x from 0 to 1), height and gutter left of it, and the scale of letters
        (1 is usual); returns whether any has changed."""
        before = self._box, self._letters
        self._box, self._letters = (max(120.0, width), max(60.0, height), max(0.0, gutter)), max(0.5, letters)
        self._changed |= before != (self._box, self._letters)
        return before != (self._box, self._letters)

    def set_visible_rectangle(self, rectangle: tuple[float, float, float, float]) -> None:
        """Sets the visible rectangle (x0, x1, y0, y1) of the stage's plane."""
        if rectangle != self._rectangle:
            self._rectangle, self._changed = rectangle, True

    def write(self, sheet: str, label: Label) -> None:
        """Adds or replaces a label of a surface (by its path); a label without text is removed."""
        with self._lock:
            labels = self._labels.setdefault(sheet, {})
            if labels.get(label.name) == label or not (label.text or label.name in labels):
                return
            labels[label.name] = label
            if not label.text:
                del labels[label.name]
            self._changed = True

    def show(self, sheet: str, visible: bool) -> None:
        """Shows or hides the labels of a surface (by its path) and of surfaces below that path."""
        with self._lock:
            if visible == (sheet in self._hidden):
                (self._hidden.discard if visible else self._hidden.add)(sheet)
                self._changed = True

    @property
    def visible_labels(self) -> list[tuple[str, Label]]:
        """All visible labels, each after the path of its surface."""
        return [(sheet, label) for sheet, labels in self._labels.items()
                if not any(sheet == hidden or sheet.startswith(f"{hidden}/") for hidden in self._hidden)
                for label in labels.values()]

    def send(self) -> None:
        """Sends the labels to the browser, if anything has changed."""
        with self._lock:
            if not self._changed:
                return
            self._changed = False
            x0, x1, y0, y1 = self._rectangle
            labels = [encode_label(sheet, label, x0, y1, x1 - x0, y1 - y0) for sheet, label in self.visible_labels]
            high = round((1 + 2 * EDGE) * (y1 - y0) / (x1 - x0), 4)
            said = escape(json.dumps({"high": high, "box": self._box[:2], "labels": []}, separators=(",", ":")))
        self._html.content = f"<i class='lab-stage' data-said='{said.removesuffix(']}')}{','.join(labels)}]}}'></i>"


@lru_cache(4000)  # most stay when one changes, and are the same on many stages
def encode_label(sheet: str, label: Label, left: float, top: float, width: float, height: float) -> str:
    """Returns a label's data for the browser, as JSON within HTML, with its position as fractions of a box from its
    left and top."""
    said = {"name": f"{sheet}/{label.name}", "text": wrap_text(label.text, label.width), "role": label.role,
            "x": round((label.x - left) / width, 4), "y": round((top - label.y) / height, 4), "anchor": label.anchor}
    further = {"size": (label.size, 1.0), "tone": (label.tone, "plain"), "bold": (label.bold, False),
               "sign": (label.sign, ""), "spans": (label.spans, ())}
    return escape(json.dumps(said | {name: value for name, (value, usual) in further.items() if value != usual},
                             separators=(",", ":")))


class ViewerSurface:
    """Surface whose marks are nodes below a ``path`` of one browser's scene tree; only changes are sent."""

    def __init__(self, client: viser.ClientHandle, lettering: LabelLayer, path: str):
        self._client, self._lettering, self._at = client, lettering, path
        self._root, self._visible = client.scene.add_frame(path, show_axes=False), True
        self._drawn: dict[str, tuple[Any, Mark]] = {}  # by name, the handle and the mark last drawn

    @property
    def visible(self) -> bool:
        return self._visible

    @visible.setter
    def visible(self, visible: bool) -> None:
        if visible != self._visible:  # set with every frame
            self._root.visible = self._visible = visible
            self._lettering.show(self._at, visible)

    @property
    def stage_metrics(self) -> StageMetrics:
        return self._lettering.stage_metrics

    def add_child(self, name: str) -> "ViewerSurface":
        return ViewerSurface(self._client, self._lettering, f"{self._at}/{name}")

    def show_marks(self, *marks: Mark) -> None:
        changed, turned = [], []
        for mark in marks:
            if isinstance(mark, Label):
                self._lettering.write(self._at, mark)
                continue
            handle, before = self._drawn.get(mark.name, (None, None))
            seen = len(mark) > 0
            if seen and mark is not before:
                handle = handle or self._add_handle(mark)
                changed.append((handle, self._changed_arrays(handle, mark, before)))
                self._drawn[mark.name] = handle, mark
            if handle is not None and handle.visible != seen:
                turned.append((handle, seen))
        if changed:
            set_node_arrays(changed)
        for handle, seen in turned:
            handle.visible = seen

    def _add_handle(self, mark: Dots | Lines) -> Any:
        s, name = self._client.scene, f"{self._at}/{mark.name}"
        match mark:
            case Lines():
                return s.add_line_segments(name, np.full((1, 2, 3), AWAY, np.float32), (0, 0, 0),
                                           thickness=mark.thickness, thickness_units="screen")
            case Dots():
                return s.add_point_cloud(name, np.full((1, 3), AWAY, np.float32), np.zeros((1, 3), np.uint8),
                                         point_size=mark.size / 2, point_shape=mark.shape, point_shading="flat",
                                         precision="float16" if mark.points.dtype == np.float16 else "float32")

    def _changed_arrays(self, handle: Any, mark: Dots | Lines, before: Any) -> dict[str, np.ndarray]:
        """Sets size and origin of a mark's node, and returns the arrays that have to be sent, by the viewer's names."""
        arrays = {"points": mark.segments if isinstance(mark, Lines) else mark.points}
        if before is None or mark.colours is not before.colours:
            arrays["colors"] = np.asarray(mark.colours, np.uint8)
        if isinstance(mark, Dots):
            if before is None or mark.size != before.size:
                handle.point_size = mark.size / 2  # the viewer's size is the radius
            if before is None or mark.origin != before.origin:
                handle.position = (*mark.origin, 0.0)
        return arrays
