"""The probe: drag a rectangle on the stage and read the errors of the particles in it. One without any puts it away."""

import numpy as np
import viser

from app.drawing import AWAY, DOT, in_plane, joined, lines
from app.page.camera import FlatCamera
from app.problems.stage import Stage
from app.words import number
from solvers.engine.frames import FrameArrays


class Probe:
    """One visitor's selected region and what was read in it."""

    def __init__(self, client: viser.ClientHandle, camera: FlatCamera):
        self._rectangle: tuple[tuple[float, float], tuple[float, float]] | None = None
        self._frame = lines(client.scene, "/probe", DOT, 1.5)
        self.text: str | None = None
        # Rectangle selection also takes the left drag, which would otherwise rotate the view.
        client.scene.on_rect_select()(lambda event: self._select(camera, event))

    def look(self, stage: Stage, arrays: FrameArrays, estimated: np.ndarray | None,
             true: np.ndarray | None) -> None:
        """Read mean and worst error, estimated and true (P,), of the particles in the region."""
        rectangle = self._rectangle
        if rectangle is None:
            self.text = None
            return
        inside = stage.region(*rectangle, arrays)
        if not inside.any():
            self._rectangle, self.text = None, None
            self._frame.points = np.full((1, 2, 3), AWAY, np.float32)
            return
        parts = [f"{np.count_nonzero(inside)} particles"]
        for name, sizes in (("estimated", estimated), ("true", true)):
            if sizes is not None and np.isfinite(sizes[inside]).any():
                here = sizes[inside]
                parts.append(f"{name} mean {number(float(np.nanmean(here)))}, worst {number(float(np.nanmax(here)))}")
        self.text = "; ".join(parts)

    def _select(self, camera: FlatCamera, event: viser.SceneRectSelectEvent) -> None:
        a, b = camera.on_stage(event.screen_min), camera.on_stage(event.screen_max)
        low, high = (min(a[0], b[0]), min(a[1], b[1])), (max(a[0], b[0]), max(a[1], b[1]))
        self._rectangle = (low, high)
        corners = in_plane(np.array([low[0], high[0], high[0], low[0]]), np.array([low[1], low[1], high[1], high[1]]),
                           0.03)
        self._frame.points = joined(corners, np.roll(corners, -1, axis=0))
