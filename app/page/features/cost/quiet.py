"""A visitor's own stage stands still while a sweep or search of theirs takes times, so as not to disturb them."""

import threading

from app.page.visit.session import Session


class QuietStage:
    """Pauses a session's stage while its visitor's job runs, and lets it go on afterwards.

    Play stays the visitor's: who presses it meanwhile has the stage move, and it is left alone from then on.
    """

    def __init__(self, session: Session):
        self._session, self._running, self._lock = session, False, threading.Lock()
        self.paused = False  # by this, and not by the visitor

    def follow(self, running: bool) -> None:
        """A job of the visitor is to run or runs, or none does. Any thread may call, again and again."""
        with self._lock:
            self._follow(running)

    def _follow(self, running: bool) -> None:
        session, begins, ends = self._session, running and not self._running, self._running and not running
        self._running = running
        playing = session.playing  # read once: the visitor may press Pause between two looks, and must not be undone
        if begins and playing:
            self.paused = True
            session.play(False)
        elif self.paused and playing:
            self.paused = False
        elif self.paused and ends:
            self.paused = False
            session.play(True)
