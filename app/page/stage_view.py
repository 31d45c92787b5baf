"""The view of the run or of what replaces it: the stage, the headline above it, the numbers below it."""

import threading
from collections.abc import Callable

import viser

from app.frame.headline import Headline
from app.page.headline import HeadlinePanel
from app.page.panels.browser_store import LETTERS, BrowserStore, BrowserWindow, LayoutMetrics
from app.page.panels.page_header import set_up_theme
from app.page.readout_panel import Numbers, ReadoutPanel
from app.page.stage_source import StageSource, ViewChoice
from app.page.viewer_canvas import ViewerCanvas
from app.viewer.widgets import is_number_between


class StageView:
    """Draws the first of its sources that is on. The page's head is built at once, the numbers by :meth:`build`."""

    def __init__(self, client: viser.ClientHandle, canvas: ViewerCanvas):
        self._client, self._canvas = client, canvas
        self._notice, self._headline = client.gui.add_html(""), HeadlinePanel(client.gui)
        self._numbers = ReadoutPanel(client)
        self._drawing = threading.Lock()
        self._sources: tuple[StageSource, ...] = ()
        self._choice: Callable[[], ViewChoice] | None = None

    def build(self, store: BrowserStore, seek: Callable[[float], None]) -> None:
        """Builds the numbers; ``seek`` is called with the time in s that the visitor clicks in the plot over time."""
        self._seek = seek
        self._numbers.build(self._client.gui)
        BrowserWindow(store, self._on_resized, self._set_dark)
        store.heard |= {"seek": self._seek_timeline_fraction, "read": self._on_timeline_pointed}

    def begin(self, choice: Callable[[], ViewChoice], sources: tuple[StageSource, ...]) -> None:
        """Starts drawing."""
        self._sources, self._choice = sources, choice
        self.draw()

    def stop(self) -> None:
        """Stops drawing; returns when the present drawing is complete."""
        with self._drawing:
            self._choice = None

    @property
    def source(self) -> StageSource:
        """The source on the stage now."""
        return next(source for source in self._sources if source.is_on)

    def draw(self) -> None:
        """Draws the stage."""
        with self._drawing:
            if (self._choice is not None
                and (display := self.source.stage_content(choice := self._choice())) is not None):
                self._canvas.draw(display, choice)

    def read_numbers(self, choice: ViewChoice) -> Numbers | None:
        """Returns the numbers of what is drawn; None if nothing has changed."""
        return self.source.numbers(choice, self._canvas.picture, self._canvas.probe.text)

    def refresh(self, choice: ViewChoice, numbers: Numbers | None, in_lesson: bool, headline: Headline) -> None:
        """Shows the numbers, the notice, and the ``headline`` or, if that is empty, the source's own."""
        source, picture = self.source, self._canvas.picture
        if numbers:
            self._numbers.reading = in_lesson or numbers.scene is None
            self._numbers.show(numbers, choice.quantity, choice.latest)
        notice = None
        for each in self._sources:  # a file has notices before it is on the stage
            if (notice := each.notice()) or each.is_on:
                break
        self._notice.content = "" if notice is None else notice.html
        if picture is not None:
            self._headline.show(headline or source.sentence(choice, picture), source.needs_immediate_headline)
        self._canvas.camera.refit_while_settling()

    def _on_resized(self, size: LayoutMetrics) -> None:
        """Handles another size of the window."""
        self._numbers.timeline.height = max(20, round(size.plot_height))
        if self._canvas.lettering.set_pixel_layout(size.width, size.height, size.left, size.letters / LETTERS):
            self.draw()

    def _set_dark(self, dark: bool) -> None:
        """Switches to the dark or the light theme."""
        set_up_theme(self._client.gui, dark)
        self._canvas.set_dark(dark)
        self._numbers.timeline.set_dark(dark)
        self.draw()

    def _on_timeline_pointed(self, said: object) -> None:
        """Handles the pointer's position on the time axis, a fraction, or its leaving."""
        self._numbers.timeline.show_values_at(float(said) if is_number_between(said, 0, 1) else None)  # type: ignore[arg-type]

    def _seek_timeline_fraction(self, said: object) -> None:
        """Handles a click on the time axis."""
        if is_number_between(said, 0, 1) and self.source.needs_immediate_headline is False:
            assert isinstance(said, float | int)
            self._seek(self._numbers.timeline.time_at(said))
