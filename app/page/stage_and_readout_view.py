"""The view of the run or of what replaces it: the stage, the headline above it, the numbers below it."""

import threading
from collections.abc import Callable

import viser

from app.frame.headline import HeadlineWithFacts
from app.page.headline_panel import HeadlinePanel
from app.page.panels.browser_store_and_window import LETTERS, BrowserStore, BrowserWindow, LayoutMetrics
from app.page.panels.page_header import set_up_theme
from app.page.readout_panel import ReadoutContent, ReadoutPanel
from app.page.stage_source import StageContent, StageSource, ViewChoice
from app.page.viewer_canvas import ViewerCanvas
from app.viewer.widget_validation import is_number_between


class StageAndReadoutView:
    """One visitor's view of the first source that is on: picture, headline above it, numbers below it."""

    def __init__(self, client: viser.ClientHandle, canvas: ViewerCanvas):
        self._client, self._canvas = client, canvas
        self._notice, self._headline = client.gui.add_html(""), HeadlinePanel(client.gui)
        self._numbers = ReadoutPanel(client)
        self._drawing = threading.Lock()
        self._sources: tuple[StageSource, ...] = ()
        self._choice: Callable[[], ViewChoice] | None = None

    def build(self, store: BrowserStore) -> None:
        """Builds numbers and plots."""
        self._numbers.build(self._client.gui)
        BrowserWindow(store, self._on_resized, self._set_dark)
        store.heard |= {"seek": self._seek_timeline_fraction, "read": self._on_timeline_pointed,
                        "scale": self._toggle_scale_unit}

    def begin(self, choice: Callable[[], ViewChoice], sources: tuple[StageSource, ...]) -> None:
        """Starts drawing the first of the ``sources`` that is on; ``choice`` returns the visitor's view options."""
        self._sources, self._choice = sources, choice
        self.draw()

    def stop(self) -> None:
        """Ends drawing for good; returns when the present drawing is complete."""
        with self._drawing:
            self._choice = None

    @property
    def source(self) -> StageSource:
        return next(source for source in self._sources if source.is_on)

    def draw(self) -> None:
        """Draws what the source on the stage shows now; does nothing before :meth:`begin` or after :meth:`stop`."""
        with self._drawing:
            choice = self._choice and self._choice()
            if choice is not None and (content := self.source.stage_content(choice)) is not None:
                if isinstance(content, StageContent):
                    self._canvas.draw(content, choice)
                else:
                    self._canvas.draw_instead(content)

    def read_numbers(self, choice: ViewChoice) -> ReadoutContent | None:
        """Returns the numbers of what is drawn with these view options; None if nothing has changed."""
        return self.source.numbers(choice, self._canvas.picture, self._canvas.probe.text)

    def refresh(self, choice: ViewChoice, numbers: ReadoutContent | None, in_lesson: bool,
                headline: HeadlineWithFacts) -> None:
        """Shows the numbers unless None, the sources' notice, and the ``headline`` or, if empty, the source's own."""
        source, picture = self.source, self._canvas.picture
        if numbers:
            self._numbers.reading = in_lesson or numbers.scene is None
            self._numbers.show(numbers, choice.quantity, choice.latest)
        notice = None
        for each in self._sources:  # a file has notices before it is on the stage
            if (notice := each.notice()) or each.is_on:
                break
        self._notice.content = "" if notice is None else notice.html
        said = headline or (picture and source.sentence(choice, picture))
        if said:
            self._headline.show(said, source.needs_immediate_headline)
        self._canvas.camera.refit_while_settling()
        if self._canvas.is_outdated:
            self.draw()

    def _toggle_scale_unit(self, _: object) -> None:
        self._canvas.toggle_scale_unit()
        self.draw()

    def _on_resized(self, size: LayoutMetrics) -> None:
        """Fits labels and plots to another size of the browser's window, and redraws the stage if it changes."""
        self._numbers.set_timeline_height(max(20, round(size.plot_height)))
        if self._canvas.lettering.set_pixel_layout(size.width, size.height, size.left, size.letters / LETTERS):
            self.draw()

    def _set_dark(self, dark: bool) -> None:
        set_up_theme(self._client.gui, dark)
        self._canvas.set_dark(dark)
        self._numbers.set_dark(dark)
        self.draw()

    def _on_timeline_pointed(self, fraction: object) -> None:
        """Shows the curves' values at a ``fraction`` of the time axis, 0 to 1; anything else: the pointer has left."""
        self._numbers.show_values_at(
            float(fraction) if is_number_between(fraction, 0, 1) else None)  # type: ignore[arg-type]

    def _seek_timeline_fraction(self, fraction: object) -> None:
        """Goes to the time at a ``fraction`` of the time axis, 0 to 1, that the visitor has clicked."""
        if is_number_between(fraction, 0, 1):
            assert isinstance(fraction, float | int)
            self.source.seek(self._numbers.time_at(fraction))
