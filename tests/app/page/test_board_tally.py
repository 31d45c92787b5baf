"""The tally of a class: one entry a visitor, his first answer, and nothing after the answers are shown."""

from __future__ import annotations

import threading

from app.lessons.progress import Answer
from app.page.features.board import tally as module
from app.page.features.board.tally import Tally

ASKED = "how-much"


def test_a_visitor_is_one_however_many_pages_he_has():
    tally = Tally()
    first, again = tally.come("a"), tally.come("a")
    assert first is again and tally.here == 1
    tally.leave("a")
    assert tally.here == 1
    tally.leave("a")
    assert tally.here == 0


def test_what_is_said_when_the_answers_are_shown_is_late():
    """Also by one who comes only then; and who was in time is not late when he says something else."""
    tally = Tally()
    tally.come("a")
    tally.come("b")
    tally.say("a", ASKED, 1)
    tally.close(ASKED)
    tally.say("a", ASKED, 2)
    tally.come("c")
    for _ in range(2):
        tally.say("b", ASKED, 3)
        tally.say("c", ASKED, 3)
    assert tally.answers(ASKED) == [1] and tally.late(ASKED) == 2
    assert tally.answers("another") == [] and tally.late("another") == 0


def test_who_leaves_leaves_his_answers():
    """He is still one of those who were asked; one who has left without an answer is not."""
    tally = Tally()
    for key in "abc":
        tally.come(key)
    tally.say("a", ASKED, 1)
    tally.leave("a")
    tally.leave("b")
    assert (tally.here, tally.asked(ASKED), tally.answers(ASKED)) == (1, 2, [1])
    entry = tally.come("a")
    assert tally.asked(ASKED) == 2 and entry.said == {ASKED: 1}


def test_memory_ends_somewhere(monkeypatch):
    """Cookies are easily had: who has left without an answer is forgotten first, and one too many is not counted,
    though he has his lesson."""
    monkeypatch.setattr(module, "MOST", 3)
    tally = Tally()
    for key in "abc":
        tally.come(key)
    tally.leave("a")
    tally.come("b").answers[ASKED] = Answer(1, 1, 1, 1.0)
    assert tally.come("d").pages == 1 and tally.here == 3  # in the place of a
    late = tally.come("e")
    tally.say("e", ASKED, 1)
    assert late.pages == 1 and tally.here == 3 and tally.answers(ASKED) == []


def test_thirty_at_once_are_thirty():
    """Each from a thread of its own; whoever listens hears of it, and may ask the tally then."""
    heard = []
    tally = Tally(lambda: heard.append(tally.asked(ASKED)))

    def visit(k):
        tally.come(str(k))
        for answer in (k, k + 1):
            tally.say(str(k), ASKED, answer)

    threads = [threading.Thread(target=visit, args=(k,)) for k in range(30)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert tally.answers(ASKED) == list(range(30)) and max(heard) == 30
