"""Slow motion of a step: what its panel says of a run that takes no more steps."""

from types import SimpleNamespace

from app.page.features.slow_motion import NO_STEP, SlowMotion
from solvers.problems.bar.scene import BarScene
from solvers.solver.soundness import OK, UNSTABLE
from tests.app.page.panel import Gui


class Session:
    """Remembers what it is asked for."""

    def __init__(self):
        self.scene, self.announced, self.numbers = BarScene(), [], 0
        self.announce = self.announced.append

    def break_down(self, particle, step=True):
        self.numbers += 1
        return self.numbers


def make_page():
    """A page on which slow motion has been built."""
    return SimpleNamespace(
        client=None, canvas=None, session=Session(), gui=Gui(), stage=SimpleNamespace(draw=lambda: None),
        run=SimpleNamespace(numbers=None, notice=None), lesson_name="",
        controls=SimpleNamespace(add_extension=lambda name, build, *parts: build()))


def test_a_phase_is_shown_around_its_particle():
    page = make_page()
    slow = SlowMotion(page)
    page.session.break_down = lambda particle, step=True: asked.append((particle, step)) or len(asked)
    asked, drawn = [], SimpleNamespace(sheet=SimpleNamespace(visible=True))
    slow._stages["bar"] = drawn
    page.show_phase(10, 2)
    assert slow.on and asked == [(10, True)]
    slow.on_frame(SimpleNamespace(number=1, breakdown=object(), step=1, scene=page.session.scene))
    assert slow._phase == 1
    slow.close()


def test_a_run_that_takes_no_more_steps_says_so():
    page = make_page()
    session, slow = page.session, SlowMotion(page)
    for status, said in ((OK, []), (UNSTABLE, [NO_STEP])):
        slow.go_forward()
        assert slow.on
        slow.on_frame(SimpleNamespace(number=session.numbers, breakdown=None, fresh=False, playing=False,
                                      status=status, scene=session.scene))
        assert not slow.on and session.announced == said
