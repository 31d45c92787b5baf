"""What is drawn: how estimate and truth are compared and coloured, the particles' domains, and the traced particle."""

from collections.abc import Callable

import viser

from app.frame.captions import DIFFERENCE, SIDE_BY_SIDE
from app.frame.scale import ColourScale
from app.language.spoken import later, tr
from app.page.panels.looking import Looking
from app.page.visit.session import Session
from app.problems.views import VIEWS

LINEAR, LOGARITHMIC = later("linear"), later("logarithmic")


class Drawn:
    """Widgets of one visitor. ``part`` gives room for a control that a lesson may do without; ``on_view`` is called
    when the drawing changes."""

    def __init__(self, session: Session, scale: ColourScale, looking: Looking, on_view: Callable[[], None]):
        self._session, self._scale, self._looking, self._on_view = session, scale, looking, on_view
        self.difference = self.domains = False

    @property
    def words(self) -> str:
        """What is drawn otherwise than usual, or what could be."""
        traced = self._looking.traced
        said = [tr("difference")] * self.difference + [tr(LOGARITHMIC)] * self._scale.logarithmic \
            + [tr("colours held")] * self._scale.held + [tr("domains")] * self.domains \
            + [tr("particle {particle}", particle=traced)] * (traced is not None)
        return ", ".join(said) or tr("colours, trace, comparison")

    def build(self, gui: viser.GuiApi, part: Callable[[str], viser.GuiFolderHandle]) -> None:
        """Make the widgets, for the session's present scene."""
        scale = self._scale
        with part("estimators"):
            compare = gui.add_dropdown(
                tr("Compare"), (tr(SIDE_BY_SIDE), tr(DIFFERENCE)),
                initial_value=tr(DIFFERENCE if self.difference else SIDE_BY_SIDE),
                hint=tr("estimate − truth is drawn as the size of what the estimate misses, direction and all; its "
                        "norm over that of the truth is the distance"))
        with part("colours"):
            kind = gui.add_dropdown(tr("Colours"), (tr(LINEAR), tr(LOGARITHMIC)),
                                    hint=tr("of estimate and truth alike"),
                                    initial_value=tr(LOGARITHMIC if scale.logarithmic else LINEAR))
            hold = gui.add_checkbox(tr("Hold colours"), scale.held,
                                    hint=tr("keep the colour scale while settings change"))
        with part("trace"):
            self._looking.build_trace(gui)
        if hint := VIEWS[self._session.scene.problem].stage.DOMAINS_HINT:
            with part("domains"):
                domains = gui.add_checkbox(tr("Show domains"), self.domains, hint=tr(hint))
            domains.on_update(lambda _: self._show_domains(domains.value))

        def coloured(_: viser.GuiEvent) -> None:
            scale.logarithmic, scale.held = kind.value == tr(LOGARITHMIC), hold.value
            scale.forget()
            self._on_view()

        for widget in (kind, hold):
            widget.on_update(coloured)
        compare.on_update(lambda _: self._compare(compare.value == tr(DIFFERENCE)))

    def _compare(self, difference: bool) -> None:
        self.difference = difference
        self._session.show(differences=difference)
        self._on_view()

    def _show_domains(self, shown: bool) -> None:
        self.domains = shown
        self._on_view()
