"""The probe: drag a rectangle on the stage and read the errors of the particles in it. One without any puts it away."""

import numpy as np
import viser

from app.frame.marks import Lines, in_plane, joined
from app.frame.stage import Stage
from app.language.spoken import later, tr
from app.page.stage.camera import FlatCamera
from app.renderers.viewer import Sheet
from app.words import with_unit
from solvers.engine.frames import FrameArrays

ESTIMATED, TRUE = later("estimated mean {mean}, worst {worst}"), later("true mean {mean}, worst {worst}")


class Probe:
    """One visitor's selected region and what was read in it."""

    def __init__(self, client: viser.ClientHandle, sheet: Sheet, camera: FlatCamera):
        self._rectangle: tuple[tuple[float, float], tuple[float, float]] | None = None
        self._sheet = sheet
        self.text: str | None = None
        # Rectangle selection also takes the left drag, which would otherwise rotate the view.
        client.scene.on_rect_select()(lambda event: self._select(camera, event))

    def look(self, stage: Stage, arrays: FrameArrays, estimated: np.ndarray | None, true: np.ndarray | None,
             unit: str) -> None:
        """Read mean and worst error, estimated and true (P,) in a ``unit``, of the particles in the region."""
        rectangle = self._rectangle
        if rectangle is None:
            self.text = None
            return
        inside = stage.region(*rectangle, arrays)
        if not inside.any():
            self._rectangle, self.text = None, None
            self._show(np.empty((0, 2, 3), np.float32))
            return
        parts = [tr("{n} particles", n=np.count_nonzero(inside))]
        for said, sizes in ((ESTIMATED, estimated), (TRUE, true)):
            if sizes is not None and np.isfinite(sizes[inside]).any():
                mean, worst = (with_unit(float(of(sizes[inside])), unit) for of in (np.nanmean, np.nanmax))
                parts.append(tr(said, mean=mean, worst=worst))
        self.text = "; ".join(parts)

    def _select(self, camera: FlatCamera, event: viser.SceneRectSelectEvent) -> None:
        ends = camera.on_stage(event.screen_min), camera.on_stage(event.screen_max)
        (left, right), (bottom, top) = (sorted(coordinates) for coordinates in zip(*ends, strict=True))
        self._rectangle = (left, bottom), (right, top)
        corners = in_plane(np.array([left, right, right, left]), np.array([bottom, bottom, top, top]), 0.03)
        self._show(joined(corners, np.roll(corners, -1, axis=0)))

    def _show(self, frame: np.ndarray) -> None:
        self._sheet.show(Lines("rectangle", frame, self._sheet.room.palette.dot, 1.5))
