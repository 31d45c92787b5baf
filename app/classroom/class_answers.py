"""Answers of the visitors of a class, by anonymous keys.

* A visitor is a browser that has been given the class code, identified by its cookie. It is one visitor, with its
  answers, however often it reloads or opens a second tab.
* A visitor's first answer to a question counts if it came before the answers were shown. Later ones change nothing of
  what is shown; only their number is.
* Answers stay when a visitor leaves. Visitors who are here, or have answered, count as asked.
* Free texts are counted, not stored.
"""

import threading
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from app.lessons.student_progress import RecordedAnswer

MOST = 1000  # visitors that are counted; others can take the lesson: cookies are easily made


@dataclass
class VisitorAnswers:
    """A visitor's open ``pages``, ``step``, ``valid`` answers that count, ``late`` questions, and own ``answers``."""

    pages: int = 0
    step: int = 0
    valid: dict[str, Any] = field(default_factory=dict)
    late: set[str] = field(default_factory=set)
    answers: dict[str, RecordedAnswer] = field(default_factory=dict)


class ClassAnswers:
    """Thread-safe answers of a class; ``on_change`` is called, on the same thread, when a number changes."""

    def __init__(self, on_change: Callable[[], None] = lambda: None):
        self._on_change, self._lock = on_change, threading.Lock()
        self._entries: dict[str, VisitorAnswers] = {}
        self._closed: set[str] = set()  # questions whose answers are shown

    def register_page(self, key: str) -> VisitorAnswers:
        """Registers an opened page of a visitor; returns the visitor's answers so far."""
        with self._lock:
            entry = self._entries.get(key) or VisitorAnswers()
            if len(self._entries) >= MOST:  # drop those who left without an answer
                self._entries = {key: one for key, one in self._entries.items() if one.pages or one.answers}
            if len(self._entries) < MOST:
                self._entries[key] = entry
            entry.pages += 1
        self._on_change()
        return entry

    def unregister_page(self, key: str) -> None:
        """Unregisters a closed page of a visitor."""
        with self._lock:
            if entry := self._entries.get(key):
                entry.pages -= 1
        self._on_change()

    def record_step(self, key: str, step: int) -> None:
        """Records that a visitor has reached a step; going back does not count."""
        with self._lock:
            if entry := self._entries.get(key):
                entry.step = max(entry.step, step)
        self._on_change()

    def record_answer(self, key: str, question: str, answer: Any) -> None:
        """Records an answer if it counts."""
        with self._lock:
            entry = self._entries.get(key)
            if entry is None or question in entry.valid:
                return
            if question in self._closed:
                entry.late.add(question)
            else:
                entry.valid[question] = answer
        self._on_change()

    def close_question(self, question: str) -> None:
        """Closes a question whose answers are about to be shown: later ones do not count."""
        with self._lock:
            self._closed.add(question)

    @property
    def present_count(self) -> int:
        """Number of visitors with an open page."""
        with self._lock:
            return sum(entry.pages > 0 for entry in self._entries.values())

    def count_reached(self, step: int) -> int:
        """Returns how many of the visitors who are here have reached a step."""
        with self._lock:
            return sum(entry.pages > 0 and entry.step >= step for entry in self._entries.values())

    def count_present_or_answered(self, question: str) -> int:
        """Returns how many visitors are here, or have given an answer that counts."""
        with self._lock:
            return sum(entry.pages > 0 or question in entry.valid for entry in self._entries.values())

    def count_late(self, question: str) -> int:
        """Returns how many visitors first answered after the answers were shown."""
        with self._lock:
            return sum(question in entry.late for entry in self._entries.values())

    def answers(self, question: str) -> list[Any]:
        """Returns the answers that count, sorted, so that their order reveals nothing."""
        with self._lock:
            return sorted(entry.valid[question] for entry in self._entries.values() if question in entry.valid)
