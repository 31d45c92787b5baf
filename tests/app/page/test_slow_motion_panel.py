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


def test_a_run_that_takes_no_more_steps_says_so():
    session = Session()
    slow = SlowMotion(SimpleNamespace(
        client=None, canvas=None, session=session, gui=Gui(), stage=SimpleNamespace(draw=lambda: None),
        run=SimpleNamespace(numbers=None, notice=None),
        controls=SimpleNamespace(add_extension=lambda name, build, *parts: build())))
    for status, said in ((OK, []), (UNSTABLE, [NO_STEP])):
        slow.go_forward()
        assert slow.on
        slow.on_frame(SimpleNamespace(number=session.numbers, breakdown=None, fresh=False, playing=False,
                                      status=status, scene=session.scene))
        assert not slow.on and session.announced == said
