"""What a session hears from its engine, kept for a test to look at."""

import threading

import numpy as np

from solvers.problems.bar.scene import BarScene
from solvers.running.run import build

SCENE = BarScene(cells=20, periods=1)  # what the engines of the tests start with
PATIENCE = 120.0  # seconds; a loaded machine may need to compile


def assert_same(arrays, scene, steps):
    """A frame's numbers are what the solver has after so many steps, to single precision."""
    solver = build(scene)
    solver.advance(steps)
    shot = solver.snapshot()
    np.testing.assert_array_equal(arrays.position, shot.position.astype(np.float32).reshape(-1, 1))
    np.testing.assert_array_equal(arrays.error, shot.error.astype(np.float32))
    for name in scene.active_estimators:
        np.testing.assert_array_equal(arrays.estimate[name], shot.estimate[name].astype(np.float32))


class Listener:
    """Collects what a session hears."""

    def __init__(self):
        self.frames, self.compilings, self.troubles, self.losses = [], [], [], 0
        self._news = threading.Condition()

    def on_frame(self, report, arrays):
        with self._news:
            self.frames.append((report, arrays))
            self._news.notify_all()

    def on_compiling(self, number):
        with self._news:
            self.compilings.append(number)
            self._news.notify_all()

    def on_error(self, sentence):
        with self._news:
            self.troubles.append(sentence)
            self._news.notify_all()

    def on_engine_lost(self):
        with self._news:
            self.losses += 1
            self._news.notify_all()

    def wait(self, condition):
        with self._news:
            assert self._news.wait_for(condition, PATIENCE), "nothing came in time"

    def frame(self, number, test=lambda report: True):
        """The first frame that answers wish ``number`` or a later one and passes ``test``."""
        def found():
            return [f for f in self.frames if f[0].number >= number and test(f[0])]

        self.wait(found)
        return found()[0]
