"""A visitor's own stage stands still while a sweep or search of theirs takes times, so as not to disturb them."""

from app.page.session import Session


class QuietStage:
    """Pauses a session's stage while its visitor's job runs, and lets it go on afterwards.

    Play stays the visitor's: who presses it meanwhile has the stage move, and it is left alone from then on.
    """

    def __init__(self, session: Session):
        self._session, self._running = session, False
        self.paused = False  # by this, and not by the visitor

    def follow(self, running: bool) -> None:
        """A job of the visitor runs, or none does. One thread calls this again and again."""
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
