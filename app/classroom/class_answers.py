"""The tally: what the visitors of a class have answered, by keys that say nothing of who they are.

Its rules:

* A visitor is a browser that has been given the class code, known by its cookie. However often it comes, reloads, or
  opens a second tab, it is one, and finds its answers again.
* Of each question a visitor's first answer counts, and it counts if it came before the answers were shown to all. What
  is said later, or anew, changes nothing of what is shown; it is only said how many came later.
* Who leaves takes nothing with him: his answers stay. Who is here, or has answered, is one of those who are asked.
* A free text is counted, and not kept here.
"""

import threading
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from app.lessons.student_progress import Answer

MOST = 1000  # visitors; further ones have their lesson, and are not counted: a cookie is easily had


@dataclass
class VisitorAnswers:
    """One visitor's open ``pages``, ``step``, ``said`` answers that count, ``late`` questions, and own ``answers``."""

    pages: int = 0
    step: int = 0
    said: dict[str, Any] = field(default_factory=dict)
    late: set[str] = field(default_factory=set)
    answers: dict[str, Answer] = field(default_factory=dict)


class ClassAnswers:
    """Any thread may call; ``on_change`` is called, on that thread, when a number is another one."""

    def __init__(self, on_change: Callable[[], None] = lambda: None):
        self._on_change, self._lock = on_change, threading.Lock()
        self._entries: dict[str, VisitorAnswers] = {}
        self._closed: set[str] = set()  # questions whose answers are shown

    def come(self, key: str) -> VisitorAnswers:
        """A page of a visitor is opened: what is known of him, perhaps from before."""
        with self._lock:
            entry = self._entries.get(key) or VisitorAnswers()
            if len(self._entries) >= MOST:  # forget who has left without a word
                self._entries = {key: one for key, one in self._entries.items() if one.pages or one.answers}
            if len(self._entries) < MOST:
                self._entries[key] = entry
            entry.pages += 1
        self._on_change()
        return entry

    def leave(self, key: str) -> None:
        """One of his pages has gone."""
        with self._lock:
            if entry := self._entries.get(key):
                entry.pages -= 1
        self._on_change()

    def reach(self, key: str, step: int) -> None:
        """He sees a step; who looks back has come as far as he had before."""
        with self._lock:
            if entry := self._entries.get(key):
                entry.step = max(entry.step, step)
        self._on_change()

    def say(self, key: str, question: str, answer: Any) -> None:
        """He has answered; what does not count is not kept."""
        with self._lock:
            entry = self._entries.get(key)
            if entry is None or question in entry.said:
                return
            if question in self._closed:
                entry.late.add(question)
            else:
                entry.said[question] = answer
        self._on_change()

    def close(self, question: str) -> None:
        """The answers are about to be shown: nothing that comes from now on counts."""
        with self._lock:
            self._closed.add(question)

    @property
    def here(self) -> int:
        """Visitors of whom a page is open."""
        with self._lock:
            return sum(entry.pages > 0 for entry in self._entries.values())

    def reached(self, step: int) -> int:
        """How many of those who are here have come to a step."""
        with self._lock:
            return sum(entry.pages > 0 and entry.step >= step for entry in self._entries.values())

    def asked(self, question: str) -> int:
        """Visitors who are here, or have answered a question so that it counts."""
        with self._lock:
            return sum(entry.pages > 0 or question in entry.said for entry in self._entries.values())

    def late(self, question: str) -> int:
        """Visitors whose first answer came when those of the others were shown."""
        with self._lock:
            return sum(question in entry.late for entry in self._entries.values())

    def answers(self, question: str) -> list[Any]:
        """What counts, sorted: in which order it was said, and who said what else, cannot be told from it."""
        with self._lock:
            return sorted(entry.said[question] for entry in self._entries.values() if question in entry.said)
