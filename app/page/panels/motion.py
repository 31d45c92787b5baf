"""What a problem does, where it can do several things: the choice, and the sliders of a motion that does not swing."""

from collections.abc import Callable

import viser

from app import words
from app.page.panels.bound import BoundWidgets
from app.page.visit.session import Session, first_scene
from app.problems.interface import Motion
from app.problems.views import VIEWS
from solvers.scene.scene import Scene


class MotionControls:
    """Widgets of one visitor, for the problem that is on the stage when they are built."""

    def __init__(self, gui: viser.GuiApi, session: Session, bound: BoundWidgets):
        self._gui, self._session, self._bound = gui, session, bound

    @property
    def _motion(self) -> Motion | None:
        return VIEWS[self._session.scene.problem].motion

    def build_choice(self, move: Callable[[Scene, str | None, float | None], None]) -> None:
        """A dropdown of the motions; ``move`` is called with the scene of another one, and with the quantity and the
        speed that it begins with, None for no change and for the usual."""
        motion, scene = self._motion, self._session.scene
        if motion is None:
            return
        names = words.choices(type(scene), "motion")
        shown = self._gui.add_dropdown("Motion", tuple(names.values()), hint=motion.hint,
                                       initial_value=names[scene.to_dict()["motion"]])

        def chosen(_: viser.GuiEvent) -> None:
            now = self._session.scene
            code = next(code for code, name in names.items() if name == shown.value)
            changed = motion.change(now, code, first_scene(now.problem).estimators)
            move(changed, *((None, None) if changed.swings else (motion.quantity, motion.speed)))

        shown.on_update(chosen)

    def build_sliders(self) -> None:
        """What only a motion that does not swing has."""
        if self._motion:
            self._bound.sliders(self._motion.sliders)
