"""The board's doors: only its own code opens it, nobody else opens steps or is counted twice, and no visitor is ever
told what another has said."""

from __future__ import annotations

import json
from contextlib import ExitStack

import pytest

from app.doors.code import ONE
from app.lessons import shelf
from app.lessons.outcomes import Outcomes, RunFailed
from app.lessons.progress import SCHEMA
from app.page.features.board.board import NEXT, SHOWN, Board
from app.page.features.lesson.marking import Classroom
from tests.app.serving.test_class_code import enter
from tests.doors import lab
from tests.processes import until
from tests.pupils import Pupil, cookie_of

CODE, NOTES, OWN = "wave-4711", "tide-0815", "surf-2323"
LESSON = shelf.lesson("04-grid-crossing")
STEPS = LESSON.steps
NUMBER = next(at for at, step in enumerate(STEPS, 1) if step.key == "where-does-the-trouble-begin")


class Broken(Outcomes):
    """No run comes to anything: what is right is not asked here."""

    def result(self, text):
        raise RunFailed("it is broken")


@pytest.fixture
def room():
    """A board, the address of its lab, which has four places, and a way to let pupils in who leave in the end."""
    board, outcomes = Board(LESSON, Broken()), Broken()
    with lab(code=CODE, notes=NOTES, classroom=Classroom(LESSON.name, True, outcomes), board=board, board_code=OWN) \
            as (_, address), ExitStack() as stack:
        def come(cookie, ready="Next"):
            pupil = stack.enter_context(Pupil(address, cookie))
            pupil.find(ready)
            return pupil

        yield board, address, come
    board.close()
    outcomes.close()


def press(board, times=1):
    for _ in range(times):
        board.press(NEXT, board.place.turn)


def boards(page):
    """What of the board a page has been told."""
    return [told for told in page.told if "lab-board" in told and "data-turn" in told]


def test_the_boards_code_opens_the_board_and_no_other_does(room):
    board, address, come = room
    pupil, teacher, lecturer = (come(cookie_of(address, code)) for code in (CODE, NOTES, OWN))
    until(lambda: boards(lecturer), "the board")
    press(board, 2)
    until(lambda: any("Reveal what came out" in told for told in lecturer.told), "the answers")
    assert boards(pupil) == boards(teacher) == []
    assert board.tally.here == 1  # neither the teacher nor the lecturer


def test_who_guesses_the_boards_code_is_told_to_wait_as_with_any(room):
    _, address, _ = room
    statuses = [enter(address, f"surf-23{k:02}")[0] for k in range(int(ONE[0]) + 1) if k != 23]
    assert statuses[0] == 403 and enter(address, "surf-9999")[0] == 429 and enter(address, OWN)[0] == 200


def test_a_pupil_opens_no_step(room):
    """By no word that a browser can say: not by what the lecturer's browser says, nor the button that is off, nor an
    address, nor kept answers that know better, nor by closing the lesson and coming back."""
    board, address, come = room
    pupil = come(cookie_of(address, CODE))
    assert pupil.off("Next") and any("opens it for all" in text for text in pupil.html.values())
    for said in (["next", 0], ["stage", 1], ["save", 0], "next", [["next"], 0], ["next", True]):
        pupil.tell(board=said)
    pupil.set(pupil.find("Next"), True)
    forged = {"schema": SCHEMA, "lesson": LESSON.name, "fingerprint": LESSON.fingerprint, "name": "", "step": 9,
              "answers": {STEPS[0].key: {"first": 1, "last": 1, "attempts": 1, "seconds": 1}}}
    pupil.tell(lesson=LESSON.name, answers=json.dumps(forged))
    pupil.tell(link=f"lesson={LESSON.name};bar;cells=24")
    pupil.set(pupil.find("Close the lesson"), True)
    until(lambda: pupil.at is None, "the shelf")
    pupil.tell(open=LESSON.name)
    pupil.find("Next")
    assert board.place.turn == board.opened == pupil.at == 0 and pupil.kinds["FileTransferStartDownload"] == 0
    press(board)
    pupil.go_on()
    assert pupil.at == 1 and board.tally.answers(STEPS[0].key) == [] and pupil.off("Next")


def test_a_step_is_opened_while_somebody_types(room):
    """The field stays, with what is in it, and Next is free when the answer is recorded."""
    board, address, come = room
    pupil = come(cookie_of(address, CODE))
    press(board)
    pupil.go_on()
    press(board, 3)
    pupil.answer(STEPS[0], 1)
    until(lambda: not pupil.off("Next"), "Next free")
    while board.opened < NUMBER:
        press(board)
    for at in range(2, NUMBER + 1):
        pupil.go_on()
        if at < NUMBER and STEPS[at - 1].question:
            pupil.answer(STEPS[at - 1], 1)
    field = pupil.find("Answer, mm")
    pupil.set(field, "3.1")
    while board.opened == NUMBER:
        press(board)
    until(lambda: board.opened == NUMBER + 1, "the next step")
    assert pupil.find("Answer, mm") == field and pupil.off("Next")
    pupil.set(pupil.find("Record my prediction"), True)
    until(lambda: not pupil.off("Next"), "Next free")
    assert board.tally.late(STEPS[NUMBER - 1].key) == 1


def test_a_reload_a_second_tab_and_another_answer_count_nothing(room):
    """One who comes back finds his prediction as he made it, and cannot make another."""
    board, address, come = room
    cookie, first = cookie_of(address, CODE), STEPS[0]
    pupil, tab = come(cookie), come(cookie)
    press(board)
    pupil.go_on()
    tab.go_on()
    pupil.answer(first, 2)
    tab.answer(first, 3)
    assert "It falls to about a half" in next(text for text in tab.html.values() if "lab-recorded" in text)
    tab.close()
    until(lambda: board.tally.here == 1, "one tab gone")
    pupil.close()
    until(lambda: board.tally.here == 0, "nobody here")
    again = come(cookie)
    assert again.at == 1 and again.off("Record my prediction")
    assert enter(address, CODE)[0] == 200 and board.tally.here == 1  # another browser's cookie, which opens no page
    assert (board.tally.answers(first.key), board.tally.asked(first.key)) == ([2], 1)


def test_nothing_that_is_said_after_the_answers_are_shown_counts(room):
    """Nor does a second answer to what was observed; and a latecomer goes through what is open."""
    board, address, come = room
    pupil = come(cookie_of(address, CODE))
    press(board, 5)
    late = come(cookie_of(address, CODE))
    for one in (pupil, late):
        one.go_on()
        one.answer(STEPS[0], 1)
        one.go_on()
        one.go_on()
    seen = STEPS[2]
    assert board.opened == 3 and board.tally.late(STEPS[0].key) == 2 and board.tally.answers(STEPS[0].key) == []
    pupil.answer(seen, 1)
    until(lambda: board.tally.answers(seen.key) == [1], "the first answer")
    press(board)
    assert board.stage(3) == SHOWN
    pupil.answer(seen, 2)
    late.answer(seen, 3)
    until(lambda: board.tally.late(seen.key) == 1, "a late answer")
    assert board.tally.answers(seen.key) == [1]


def test_no_pupil_is_told_what_another_has_said(room):
    """Not by any message, whatever he sends, from the beginning until all is shown."""
    board, address, come = room
    while board.opened < NUMBER:
        press(board)
    given = {"31.4159": None, "27.1828": None}
    for number in given:
        given[number] = pupil = come(cookie_of(address, CODE))
        for at in range(1, NUMBER + 1):
            pupil.go_on()
            if STEPS[at - 1].question:
                pupil.answer(STEPS[at - 1], float(number) if at == NUMBER else 1)
    lecturer = come(cookie_of(address, OWN))
    until(lambda: any("2 of 2 have predicted" in told for told in lecturer.told), "the count")
    assert not any("31.42" in told for told in boards(lecturer))  # nor the projector, before they are shown
    press(board, 2)
    until(lambda: any("31.42 mm" in told and "27.18 mm" in told for told in boards(lecturer)), "all of it")
    for pupil in given.values():
        pupil.tell(board=["save", 0])
        pupil.tell(board=["stage", 0])
    listener = come(cookie_of(address, CODE))
    for number, pupil in given.items():
        mine, others = number[:5], next(other for other in given if other != number)[:5]
        assert any(mine in told for told in pupil.told)
        assert not any(others in told or "have predicted" in told for told in pupil.told)
    assert not any(number[:5] in told for told in listener.told for number in given)


def test_the_lecturer_has_a_place_when_all_are_taken(room):
    """And finds the board as it was: its state is the server's."""
    board, address, come = room
    for _ in range(4):
        come(cookie_of(address, CODE))
    press(board)
    lecturer = come(cookie_of(address, OWN))
    until(lambda: any("step 1 of" in told and "4 are here" in told for told in boards(lecturer)), "the board")
    another = come(cookie_of(address, OWN))
    another.tell(board=["next", board.place.turn])
    until(lambda: any("Reveal what came out" in told for told in boards(lecturer)), "the same on both")


def test_whoever_has_the_teachers_code_goes_on_as_he_likes(room):
    _, address, come = room
    teacher = come(cookie_of(address, NOTES))
    assert not teacher.off("Next") and teacher.find("Your name")
