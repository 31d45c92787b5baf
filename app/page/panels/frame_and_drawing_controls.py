"""Controls for looking back and closer: the slider through frames, the traced particle, and drawing options."""

from collections.abc import Callable

import viser

from app.frame.colour_scale import ColourScale
from app.frame.error_view_captions import DIFFERENCE, SIDE_BY_SIDE
from app.language.translation import lazy, tr
from app.page.panels.quantity_and_estimator_widgets import QuantityAndEstimatorWidgets
from app.page.visit.history import LAST_PERIODS
from app.page.visit.recent_frames import RecentFrames
from app.page.visit.run_session import RunSession
from app.page.visit.traced_particle_series import ParticleTracer
from app.problems.views import VIEWS
from solvers.untrusted import number_parsing, quoting

ALL, LATEST = lazy("all"), lazy("last {n} periods")
LINEAR, LOGARITHMIC = lazy("linear"), lazy("logarithmic")


class FrameAndTraceControls:
    """One visitor's widgets for past frames and a traced particle; ``on_view`` redraws the stage."""

    def __init__(self, session: RunSession, recent: RecentFrames, trace: ParticleTracer, on_view: Callable[[], None]):
        self._session, self._recent, self._trace, self._on_view = session, recent, trace, on_view
        self.latest = False  # whether plots show the last periods only
        self._refused = False

    def build_slider(self, gui: viser.GuiApi) -> viser.GuiSliderHandle[int]:
        """Builds and returns the slider through past frames, from the oldest (negative number) to the newest, 0."""
        self._slider = gui.add_slider(tr("Look back"), -1, 0, 1, 0, disabled=True, hint=_hint(0, 0.0))
        self._slider.on_update(self._on_slider_moved)
        self._at = 0
        return self._slider

    def build_plot_widgets(self, gui: viser.GuiApi) -> None:
        """Builds the widgets for the range of the plots over time and for the particle traced in them."""
        shown = tr(ALL), tr(LATEST, n=LAST_PERIODS)
        show = gui.add_dropdown(tr("Plots show"), shown, initial_value=shown[self.latest],
                                hint=tr("how much of the run the plots over time show"))
        self._number = gui.add_text(tr("Trace particle"), "", hint=tr(
            "its number, or click it on the stage: its error, its estimates and its crossings are plotted over time; "
            "empty for none"))
        self._end = gui.add_button(tr("Stop tracing"), visible=False, color="gray",
                                   hint=tr("take its mark and its plot away"))
        show.on_update(lambda _: setattr(self, "latest", show.value == shown[True]))
        self._number.on_update(self._on_number_typed)
        self._end.on_click(lambda _: self._choose(None))
        self._followed: int | None = None

    @property
    def traced_particle(self) -> int | None:
        return None if self._trace.traced is None else self._trace.traced.particle

    def trace(self, particle: int | None) -> None:
        """Traces a particle, by its number, from the start of the next run; None for no particle."""
        self._trace.choose(particle, in_next_run=True)

    def refresh(self) -> None:
        """Updates the slider's range and the traced particle's number; sends only what has changed."""
        report, (most, periods), back = self._session.report, self._recent.stored_frames_and_periods, self._recent.back
        paused = report is not None and not report.playing and most > 0
        self._slider.disabled = not paused
        if paused:
            self._slider.min, self._slider.hint = -most, _hint(most, periods)
        if back != self._at:
            self._at, self._slider.value = back, -back  # type: ignore[misc]
        traced = self._trace.traced
        followed = None if traced is None else traced.particle
        self._end.visible = traced is not None
        if followed != self._followed:
            self._followed = followed
            self._number.value = "" if followed is None else str(followed)  # type: ignore[misc]

    def seek(self, time: float) -> None:
        """Pauses the run and shows the stored frame nearest to a time in s."""
        if not self._recent.seek(time):
            self._session.play(False)
        self._on_view()

    def seek_if_stored(self, time: float) -> bool:
        """Shows the frame at a time in s as :meth:`seek` does, or returns False if none is stored so far back."""
        first, last = self._recent.span
        if kept := first <= time <= last:
            self.seek(time)
        return kept

    def _on_slider_moved(self, event: viser.GuiEvent) -> None:
        if event.client is not None:  # otherwise the page has set it
            self._at = -round(event.target.value)
            self._recent.go_back(self._at)
            self._on_view()

    def _on_number_typed(self, event: viser.GuiEvent) -> None:
        if event.client is None or self._session.report is None:
            return
        text, particles = self._number.value.strip(), self._session.report.particles
        if text and not ((number := number_parsing.parse_count(text)) is not None and number < particles):
            self._session.refuse(tr("Trace particle: '{typed}' is not the number of one; give one from 0 to {last}, or "
                                    "nothing", typed=quoting.quote(text, 20), last=particles - 1))
            self._refused = True
            return
        if self._refused:
            self._session.refuse("")
            self._refused = False
        self._choose(int(text) if text else None)

    def _choose(self, particle: int | None) -> None:
        self._trace.choose(particle)
        self._on_view()


def _hint(frames: int, periods: float) -> str:
    if not frames:
        return tr("while paused: earlier frames, numbered back from the last one, 0.")
    return tr("while paused: earlier frames, numbered back from the last one, 0. The last {frames} frames are kept, "
              "{periods:.2g} periods.", frames=frames, periods=periods)


class DrawingWidgets:
    """One visitor's drawing options; ``on_view`` redraws the stage."""

    def __init__(self, session: RunSession, scale: ColourScale, history: FrameAndTraceControls,
                 stage: QuantityAndEstimatorWidgets, on_view: Callable[[], None]):
        self._session, self._scale, self._looking, self._on_view = session, scale, history, on_view
        self._stage = stage
        self.difference = self.domains = False

    @property
    def summary(self) -> str:
        """The options that differ from the defaults as text, or else what there is to set."""
        traced = self._looking.traced_particle
        said = [tr("difference")] * self.difference + [tr(LOGARITHMIC)] * self._scale.logarithmic \
            + [tr("colours held")] * self._scale.held + [tr("domains")] * self.domains \
            + [tr("particle {particle}", particle=traced)] * (traced is not None)
        return ", ".join(said) or tr("colours, trace, domains")

    def build(self, gui: viser.GuiApi, part: Callable[[str], viser.GuiFolderHandle]) -> None:
        """Builds the widgets for the session's scene; ``part`` returns the folder for a control of lessons (name)."""
        scale = self._scale

        def on_domains(_: viser.GuiEvent) -> None:
            self.domains = domains.value
            self._on_view()

        def on_difference(_: viser.GuiEvent) -> None:
            self.difference = compare.value == tr(DIFFERENCE)
            self._session.set_frame_options(differences=self.difference)
            self._on_view()

        def on_colours(_: viser.GuiEvent) -> None:
            scale.logarithmic, scale.held = kind.value == tr(LOGARITHMIC), hold.value
            scale.reset()
            self._on_view()

        with part("colours"):
            kind = gui.add_dropdown(tr("Colours"), (tr(LINEAR), tr(LOGARITHMIC)),
                                    hint=tr("of estimate and truth alike"),
                                    initial_value=tr(LOGARITHMIC if scale.logarithmic else LINEAR))
            hold = gui.add_checkbox(tr("Hold colours"), scale.held,
                                    hint=tr("keep the colour scale while settings change"))
            for widget in (kind, hold):
                widget.on_update(on_colours)
        with part("magnify"):
            self._stage.build_magnification(gui)
        if hint := VIEWS[self._session.scene.problem].stage.DOMAINS_HINT:
            with part("domains"):
                domains = gui.add_checkbox(tr("Show domains"), self.domains, hint=tr(hint))
            domains.on_update(on_domains)
        with part("trace"):
            self._looking.build_plot_widgets(gui)
        with part("estimators"):
            compare = gui.add_dropdown(
                tr("Compare"), (tr(SIDE_BY_SIDE), tr(DIFFERENCE)),
                initial_value=tr(DIFFERENCE if self.difference else SIDE_BY_SIDE),
                hint=tr("the colours show the size of the vector estimate − truth; its norm divided by the norm of the "
                        "truth is the distance"))
        compare.on_update(on_difference)
