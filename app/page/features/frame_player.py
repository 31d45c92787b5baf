"""Player of frames that are all there, or still coming: those of a file or of a body, instead of the run's."""

import threading
from collections.abc import Callable

from app.language.translation import with_language
from app.page.visit.run_session import RunSession


class FramePlayer:
    """Shows one frame after the other, from 0, to the last; ``seconds`` returns for how long to show the present one,
    ``on_view`` draws it. While frames are still ``coming`` it waits for them."""

    def __init__(self, session: RunSession, seconds: Callable[[], float], on_view: Callable[[], None]):
        self._session, self._seconds, self._on_view = session, seconds, on_view
        self._lock = threading.RLock()
        self._turn = threading.Event()  # ends the wait of the thread that plays
        self._frame, self.count, self.coming, self.playing = 0, 0, False, False

    @property
    def frame(self) -> int:
        return max(0, min(self._frame, self.count - 1))

    def begin(self, count: int, coming: bool = False) -> None:
        """Plays so many frames from the first one on, and those that are ``coming``."""
        with self._lock:
            self._frame, self.count, self.coming = 0, count, coming
            self.play(True)

    def play(self, playing: bool) -> None:
        """Goes on, from the first frame again after the last one, or pauses."""
        with self._lock:
            self._turn.set()  # whatever plays now
            self.playing = playing and (self.count > 1 or self.coming)
            if self.playing:
                self._frame = self._frame if self._frame < self.count - 1 or self.coming else 0
                self._turn = threading.Event()
                threading.Thread(target=with_language(self._play_loop), args=(self._turn,), name="frames",
                                 daemon=True).start()

    def go_to(self, frame: int) -> None:
        """Shows a frame, from 0, paused."""
        with self._lock:
            self.play(False)
            self._frame = frame
        self._on_view()

    def _play_loop(self, over: threading.Event) -> None:
        while not over.wait(self._seconds()):
            with self._lock:
                if over.is_set():
                    return
                if not self._session.watched:
                    continue
                moves = self._frame < self.count - 1
                self._frame += moves
                self.playing = self.coming or self._frame < self.count - 1
            if moves or not self.playing:
                self._on_view()
            if not self.playing:
                return
