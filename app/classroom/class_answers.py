"""Answers of the visitors of a class, by anonymous keys.

* A visitor is a browser that has been given the class code, identified by its cookie. It is one visitor, with its
  answers, however often it reloads or opens a second tab.
* A visitor's first answer to a question counts if it came before the answers were shown. Later ones change nothing of
  what is shown; only their number is.
* Answers stay when a visitor leaves. Visitors who are here, or have answered, count as asked.
* Free texts are counted, not stored."""

import threading
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from app.lessons.student_progress import RecordedAnswer

MOST = 1000  # visitors that are counted; others can take the lesson: cookies are easily made


@dataclass
class VisitorAnswers:
    """A visitor's number of open ``pages``, last ``step`` reached (0: none), ``valid`` answers that count, ``late``
    questions, first answered after the answers were shown, and own ``answers``, each by the question's key."""

    pages: int = 0
    step: int = 0
    valid: dict[str, Any] = field(default_factory=dict)
    late: set[str] = field(default_factory=set)
    answers: dict[str, RecordedAnswer] = field(default_factory=dict)


class ClassAnswers:
    """Thread-safe answers of a class; a call that changes a count calls ``on_change``. Visitors have their cookie's
    ``key``, questions that of their step; ``step`` is a number from 1."""

    def __init__(self, on_change: Callable[[], None] = lambda: None):
        self._on_change, self._lock = on_change, threading.Lock()
        self._entries: dict[str, VisitorAnswers] = {}
        self._closed: set[str] = set()  # questions whose answers are shown

    def register_page(self, key: str) -> VisitorAnswers:
        """Registers an opened page of a visitor; returns the visitor's entry, new or as it was left."""
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
        """Records that a visitor has reached the step with this number; going back does not count."""
        with self._lock:
            if entry := self._entries.get(key):
                entry.step = max(entry.step, step)
        self._on_change()

    def record_answer(self, key: str, question: str, answer: Any) -> None:
        """Records a visitor's first answer, or that it came after the question was closed."""
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
        """Returns how many visitors with an open page have reached the step with this number."""
        with self._lock:
            return sum(entry.pages > 0 and entry.step >= step for entry in self._entries.values())

    def count_present_or_answered(self, question: str) -> int:
        """Returns how many visitors have an open page, or an answer to the question that counts."""
        with self._lock:
            return sum(entry.pages > 0 or question in entry.valid for entry in self._entries.values())

    def count_late(self, question: str) -> int:
        """Returns how many visitors first answered the question after its answers were shown."""
        with self._lock:
            return sum(question in entry.late for entry in self._entries.values())

    def answers(self, question: str) -> list[Any]:
        """Returns the answers to a question that count, sorted, so that their order reveals nothing."""
        with self._lock:
            return sorted(entry.valid[question] for entry in self._entries.values() if question in entry.valid)
