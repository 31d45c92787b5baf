"""Ways on from a run that is lost: to the moment it broke, with what cures it, or by another method."""

from collections.abc import Callable
from dataclasses import dataclass, replace

from app.language.heard import heard
from app.language.spoken import later, tr
from app.problems.spark import NotNow, asked
from app.state import State
from app.words import METHODS, number
from solvers.engine.messages import FrameReport
from solvers.scene.remedies import COUPLED, FILTER, FROZEN, REMEDIES
from solvers.scene.scene import AUTO, Scene

BEFORE = 0.03  # periods before a run broke, to which one goes back: more than half of what lies between frames
#: Methods that bear more than hat functions do, the first choice first, and what they are.
OTHERS = {"ugimp": later("the same {problem}, small intervals"), "cpdi": later("the same {problem}, boxes that deform"),
          "bspline": later("the same {problem}, smooth functions")}
SHORT = {COUPLED: later("coupled F")}  # where a label is too long for a button
TWO, ONE = (FILTER, COUPLED), (FROZEN,)  # remedies that go together, and what there is where they do not


@dataclass(frozen=True)
class Card:
    """A button: its ``key`` comes back when it is pressed. It has been pressed before where it is ``done``, and cannot
    be pressed now where it is ``off``."""

    key: str
    icon: str
    title: str
    hint: str
    done: bool = False
    off: bool = False


def what_now(state: State, report: FrameReport, seek: Callable[[float], bool], show: Callable[[State], None],
             ) -> list[tuple[Card, Callable[[], None]]]:
    """Buttons, and what each does. ``seek`` looks back to a time in s and says whether it is kept."""
    scene = report.scene
    back = max(scene.time_step, (report.since or report.time) - BEFORE * scene.period)

    def look() -> None:
        if not seek(back):  # it is not kept: run again until then
            show(replace(state, scene=replace(scene, periods=None, t_end=back), speed=None, stops=True))

    other = next(name for name in OTHERS if name in scene.choices("method") and name != scene.method)
    hint = tr("back to t = {time} s, paused", time=number(back))
    return [(Card("back", "back", tr("See the moment it broke"), hint), look),
            _changed("cure", "filter", state, show, *_cure(scene)),
            _changed("other", "halve", state, show, tr("Take {method} instead", method=METHODS[other].name),
                     tr(OTHERS[other], problem=scene.problem), {"method": other})]


def _changed(key: str, icon: str, state: State, show: Callable[[State], None], title: str, hint: str,
             changes: dict[str, object]) -> tuple[Card, Callable[[], None]]:
    """A button that starts the scene again with changes, where it can be that."""
    try:
        wanted = asked(state, changes, pinned=False)
    except NotNow as reason:
        return Card(key, icon, title, heard(str(reason)), off=True), lambda: None
    return Card(key, icon, title, hint, off=not changes), lambda: show(wanted)


def _cure(scene: Scene) -> tuple[str, str, dict[str, object]]:
    """A step that the motion bears, or the remedies that are not on yet."""
    if scene.time_step > scene.step_bound:
        return tr("Take a step that holds"), tr("Auto step: what the motion bears"), {"dt": AUTO, "cfl": None}
    names = TWO if all(name in scene.REMEDIES for name in TWO) else ONE
    missing = tuple(name for name in names if name not in scene.remedies)
    hint = ", ".join(tr(SHORT.get(name, REMEDIES[name].label)) for name in names)
    title = tr("Switch on two remedies") if len(names) > 1 else tr("Switch on a remedy")
    return title, hint if missing else tr("it is on already"), {"remedies": names} if missing else {}
