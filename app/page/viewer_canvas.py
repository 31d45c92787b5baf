"""The canvas of one visitor: draws frames of whatever is on the stage."""

from collections.abc import Hashable

import numpy as np
import viser

from app.colour_palette import GROUNDS, rgb
from app.frame.colour_scale import ColourScale
from app.frame.layout import ColourBarDrawing, Rectangle
from app.frame.stage import Stage
from app.names_and_units import QUANTITIES
from app.page.stage.pointer_and_camera import FixedRectangleCamera, RectangleErrorProbe, TracedParticleRing
from app.page.stage_source import NO_TITLE, OwnPicture, Sizes, StageContent, StageFrame, ViewChoice
from app.page.visit.traced_particle_series import ParticleTracer
from app.problems.views import VIEWS
from app.renderers.viewer_renderer import LabelLayer, ViewerSurface
from solvers.solver.soundness import UNSTABLE


class ViewerCanvas:
    """One browser's drawing area: a stage for each problem, one of them visible, colour bar, trace rings and probe."""

    def __init__(self, client: viser.ClientHandle, scale: ColourScale, trace: ParticleTracer, problem: str):
        self._client, self._scale, self.lettering = client, scale, LabelLayer(client.gui)
        self.picture: StageFrame | None = None  # the frame drawn last
        self._coloured: Hashable = None  # what the colour scale belongs to
        self._set_background(False)
        self._colour_bar = ColourBarDrawing(self.add_surface("/colours"), scale)
        self._stages = {problem: view.stage(self.add_surface(f"/{problem}"), scale) for problem, view in VIEWS.items()}
        self._show_stage(problem)
        self.camera = FixedRectangleCamera(client, self._stages[problem].rectangle)
        self.probe = RectangleErrorProbe(client, self.add_surface("/probe"), self.camera)
        self._rings = TracedParticleRing(client, self.add_surface("/trace"), trace)

    def draw(self, content: StageContent, choice: ViewChoice) -> None:
        """Draws a source's content with the visitor's view options: a frame, and perhaps a second run beside it."""
        picture, beside, unit = content.picture, content.beside, QUANTITIES[choice.quantity].unit
        view, arrays, problem = picture.view, picture.arrays, picture.report.scene.problem
        self._update_colour_scale(content, choice.quantity)
        stage = self._stages[problem]
        second = stage.pinned_run_stage(beside is not None)
        with self._client.atomic():
            self._show_stage(None if content.hidden else problem)
            _draw(stage, picture, choice)
            if isinstance(beside, StageFrame):
                assert second is not None
                _draw(second, beside, choice)
                if stage.shared_axis_changed:
                    _draw(stage, picture, choice)
            elif second:
                second.show_title(*beside or NO_TITLE)
            stage.annotate(content.annotations, arrays)
            if picture.foreign:  # its particles cannot be traced
                self._rings.hide()
            else:
                self._rings.update(stage, arrays)
            self._colour_bar.draw(choice.quantity, stage.rectangle[3])
            rectangle = content.hidden or stage.rectangle
            self.lettering.set_visible_rectangle(rectangle)
            self.lettering.send()
            self._client.flush()  # otherwise viser buffers for a frame's time, and the next frame replaces this one
        self.camera.show_rectangle(rectangle)
        self.probe.measure(stage, arrays, view.estimated, view.true, unit)
        self.picture = picture

    def draw_instead(self, picture: OwnPicture) -> None:
        """Draws a picture in place of the stage."""
        with self._client.atomic():
            self._rings.hide()
            self.probe.hide()
            self.cover(picture.draw())
            self._client.flush()

    def cover(self, rectangle: Rectangle) -> None:
        """Hides the stage, until the next frame is drawn, and shows the rectangle of something else."""
        self._show_stage(None)
        self.lettering.set_visible_rectangle(rectangle)
        self.lettering.send()
        self.camera.show_rectangle(rectangle)

    def set_dark(self, dark: bool) -> None:
        self.lettering.dark = dark
        self._set_background(dark)

    def _set_background(self, dark: bool) -> None:
        ground = np.array(rgb(GROUNDS["ground"][dark]), np.uint8)
        self._client.scene.set_background_image(np.broadcast_to(ground, (2, 2, 3)).copy(), format="png")

    def add_surface(self, path: str) -> ViewerSurface:
        """Returns a new drawing surface below a ``path`` of the browser's scene tree, such as "/probe"."""
        return ViewerSurface(self._client, self.lettering, path)

    @property
    def is_outdated(self) -> bool:
        """Whether something drawn has to change by now, although no frame has come."""
        return self._scale.is_outdated or any(stage.is_outdated for stage in self._stages.values())

    def toggle_scale_unit(self) -> None:
        """Lets the colour scale tell sizes of errors in per cent or in the quantity's unit."""
        self._scale.absolute = not self._scale.absolute

    def _update_colour_scale(self, content: StageContent, quantity: str) -> None:
        """Fits the colour scale to the content's errors; an earlier frame leaves it, so that frames can be compared."""
        report = content.picture.report
        size = self._scale.whole = report.scene.size_of(quantity)
        if changed := (key := (report.scene.problem, content.scale_key)) != self._coloured:
            self._scale.reset()
            self._coloured = key
        if changed or not content.is_past:
            beside = _error_shares(content.beside, quantity) if isinstance(content.beside, StageFrame) else (None, None)
            left, right = _shares(content.sizes, size)
            self._scale.update(left, right, (report.scene, content.scale_key), beside, content.least / size,
                               settled=not report.playing or report.status == UNSTABLE)

    def _show_stage(self, problem: str | None) -> None:
        """Shows the stage of a problem (by its key) and hides the others; hides all for None."""
        self._colour_bar.sheet.visible = problem is not None
        for name, stage in self._stages.items():
            stage.sheet.visible = name == problem


def _draw(stage: Stage, picture: StageFrame, choice: ViewChoice) -> None:
    """Draws a frame with its titles on a problem's stage, by the visitor's view options."""
    report, view = picture.report, picture.view
    stage.domains = choice.domains and not picture.foreign
    stage.plotted, stage.magnified = report.holds.plotted, choice.magnified
    stage.show_captions(view.left, view.right)  # first: a run that nobody judges has another layout
    stage.draw(report.scene, picture.arrays, *_error_shares(picture, choice.quantity), report.time,
               foreign=picture.foreign)
    stage.show_title(*picture.title)


def _error_shares(picture: StageFrame, quantity: str) -> Sizes:
    """Returns the errors (P,) of a picture's left and right half as shares of the quantity's largest exact value."""
    view = picture.view
    return _shares((view.left.sizes, view.right.sizes), picture.report.scene.size_of(quantity))


def _shares(sizes: Sizes, size: float) -> Sizes:
    left, right = (None if part is None else part / size for part in sizes)
    return left, right
