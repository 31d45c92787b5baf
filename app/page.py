"""The page: one visitor's stage, panels and session, tied together."""

from __future__ import annotations

import html
import logging
import threading

import viser

from app.camera import FlatCamera
from app.panels.about import ABOUT
from app.panels.controls import QUANTITIES, Controls
from app.panels.furniture import add_head, furnish
from app.panels.lessons import add_lessons
from app.panels.measurements import Measurements
from app.scale import ColourScale
from app.session import Notice, Session
from app.stage_bar import RECTANGLE, BarStage
from solvers.bar.scene import BarScene
from solvers.engine.memory import FrameArrays
from solvers.engine.messages import FrameReport
from solvers.engine.pool import EnginePool

REFRESH_SECONDS = 0.2  # for numbers, plots and notices; the stage follows every frame
FIRST_SCENE = BarScene(periods=1)


class Page:
    """Private to one client. Frames draw on the engine's reader thread, the rest on a thread of its own."""

    def __init__(self, client: viser.ClientHandle, pool: EnginePool):
        self._client = client
        self._closed = threading.Event()
        self._drawing = threading.Lock()
        self._last: tuple[FrameReport, FrameArrays] | None = None
        self._controls: Controls | None = None
        self._scale = ColourScale()
        furnish(client.gui)
        add_head(client.gui)
        self._notice = client.gui.add_html("")
        self._stage = BarStage(client, self._scale)
        self._camera = FlatCamera(client, RECTANGLE)
        self._measurements = Measurements(client)
        self._session = Session(pool, FIRST_SCENE, self._on_frame)
        tabs = client.gui.add_tab_group()
        with tabs.add_tab("Explore", viser.Icon.ADJUSTMENTS_HORIZONTAL):
            self._controls = Controls(client.gui, self._session, self._scale, self._redraw)
        with tabs.add_tab("Lessons", viser.Icon.SCHOOL):
            add_lessons(client.gui)
        with tabs.add_tab("About", viser.Icon.INFO_CIRCLE):
            client.gui.add_html(ABOUT)
        threading.Thread(target=self._refresh_loop, name="page-refresh", daemon=True).start()

    def close(self) -> None:
        """The visitor has gone."""
        self._closed.set()
        self._session.close()

    def _on_frame(self, report: FrameReport, arrays: FrameArrays) -> None:
        if report.fresh:
            self._scale.forget()
        self._last = (report, arrays)
        self._redraw()

    def _redraw(self) -> None:
        if self._last is None or self._controls is None or self._closed.is_set():
            return
        with self._drawing:
            report, arrays = self._last
            label = self._controls.quantity
            _, unit = QUANTITIES[label]
            active = report.scene.active_estimators
            self._stage.draw(report.scene, arrays, active[0] if active else None,
                             list(QUANTITIES).index(label), label, unit, report.time, self._session.speed)

    def _refresh_loop(self) -> None:
        while not self._closed.wait(REFRESH_SECONDS):
            try:
                self._refresh()
            except Exception:  # one bad refresh must not silence the page for the rest of the visit
                logging.getLogger(__name__).exception("the page could not be refreshed")

    def _refresh(self) -> None:
        key, unit = QUANTITIES[self._controls.quantity]
        self._measurements.refresh(self._session, self._controls.estimator, key, unit)
        notice = _notice_html(self._session.notice())
        if notice != self._notice.content:
            self._notice.content = notice
        self._camera.settle()


def _notice_html(notice: Notice | None) -> str:
    if notice is None:
        return ""
    sentence = html.escape(notice.sentence[:1].upper() + notice.sentence[1:])
    return f"<div class='lab-notice lab-{notice.kind}' role='status'>{sentence}</div>"
