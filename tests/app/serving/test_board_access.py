"""The board's doors: only its own code opens it, nobody else opens steps or is counted twice, and no visitor is ever
told what another has said."""

import json
from contextlib import ExitStack

import pytest

from app.classroom.class_board_state import NEXT, ClassBoardState
from app.classroom.class_context import LessonContext
from app.lessons import catalogue
from app.lessons.lesson_runs import RunCache, RunFailed
from app.lessons.student_progress import SCHEMA
from tests.support.page_server import start_server
from tests.support.processes import wait_until
from tests.support.simulated_students import Student, cookie_of

CODE, NOTES, OWN = "wave-4711", "tide-0815", "surf-2323"
LESSON = catalogue.load_lesson("04-grid-crossing")
STEPS = LESSON.steps
NUMBER = next(at for at, step in enumerate(STEPS, 1) if step.key == "where-does-the-trouble-begin")


class Broken(RunCache):
    """No run comes to anything: what is right is not asked here."""

    def result(self, text):
        raise RunFailed("it is broken")


@pytest.fixture
def room():
    """A board, the address of its lab, which has four places, and a way to let pupils in who leave in the end."""
    board, outcomes = ClassBoardState(LESSON, Broken()), Broken()
    with start_server(code=CODE, notes=NOTES, classroom=LessonContext(LESSON.name, True, outcomes), board=board,
                      board_code=OWN) \
            as (_, address), ExitStack() as stack:
        def come(cookie, ready="Next"):
            pupil = stack.enter_context(Student(address, cookie))
            pupil.find(ready)
            return pupil

        yield board, address, come
    board.stop_computations()
    outcomes.close()


def press(board, times=1):
    for _ in range(times):
        board.press_button(NEXT, board.shown_step.turn)


def boards(page):
    """What of the board a page has been told."""
    return [told for told in page.told if "lab-board" in told and "data-turn" in told]


def test_a_pupil_opens_no_step(room):
    """By no word that a browser can say: not by what the lecturer's browser says, nor the button that is off, nor an
    address, nor kept answers that know better, nor by closing the lesson and coming back."""
    board, address, come = room
    pupil = come(cookie_of(address, CODE))
    assert pupil.off("Next") and any("lecturer opens it" in text for text in pupil.html.values())
    for said in (["next", 0], ["stage", 1], ["save", 0], "next", [["next"], 0], ["next", True]):
        pupil.tell(board=said)
    pupil.set(pupil.find("Next"), True)
    forged = {"schema": SCHEMA, "lesson": LESSON.name, "fingerprint": LESSON.fingerprint, "name": "", "step": 9,
              "answers": {STEPS[0].key: {"first": 1, "last": 1, "attempts": 1, "seconds": 1}}}
    pupil.tell(lesson=LESSON.name, answers=json.dumps(forged))
    pupil.tell(link=f"lesson={LESSON.name};bar;cells=24")
    # A click is lost where the link, or the answers, make the panel anew under it: who clicks does so again.
    wait_until(lambda: pupil.at is None or pupil.set(pupil.find("Close the lesson"), True), "the shelf", pause=1.0)
    pupil.tell(open=LESSON.name)
    pupil.find("Next")
    assert board.shown_step.turn == board.last_open_step == pupil.at == 0
    assert pupil.kinds["FileTransferStartDownload"] == 0
    press(board)
    pupil.go_on()
    assert pupil.at == 1 and board.tally.answers(STEPS[0].key) == [] and pupil.off("Next")


def test_no_pupil_is_told_what_another_has_said(room):
    """Not by any message, whatever he sends, from the beginning until all is shown."""
    board, address, come = room
    while board.last_open_step < NUMBER:
        press(board)
    given = {"31.4159": None, "27.1828": None}
    for number in given:
        given[number] = pupil = come(cookie_of(address, CODE))
        for at in range(1, NUMBER + 1):
            pupil.go_on()
            if STEPS[at - 1].question:
                pupil.answer(STEPS[at - 1], float(number) if at == NUMBER else 1)
    lecturer = come(cookie_of(address, OWN))
    wait_until(lambda: any("2 of 2 have predicted" in told for told in lecturer.told), "the count")
    assert not any("31.42" in told for told in boards(lecturer))  # nor the projector, before they are shown
    press(board, 2)
    wait_until(lambda: any("31.42 mm" in told and "27.18 mm" in told for told in boards(lecturer)), "all of it")
    for pupil in given.values():
        pupil.tell(board=["save", 0])
        pupil.tell(board=["stage", 0])
    listener = come(cookie_of(address, CODE))
    for number, pupil in given.items():
        mine, others = number[:5], next(other for other in given if other != number)[:5]
        assert any(mine in told for told in pupil.told)
        assert not any(others in told or "have predicted" in told for told in pupil.told)
    assert not any(number[:5] in told for told in listener.told for number in given)
    assert not any(map(boards, (*given.values(), listener)))


def test_the_lecturer_has_a_place_when_all_are_taken(room):
    """And finds the board as it was: its state is the server's. The teacher's code does not open it, and neither he nor
    the lecturer counts."""
    board, address, come = room
    *_, teacher = (come(cookie_of(address, code)) for code in (CODE, CODE, CODE, NOTES))
    press(board)
    lecturer = come(cookie_of(address, OWN))
    wait_until(lambda: any("step 1 of" in told and "3 are here" in told for told in boards(lecturer)), "the board")
    another = come(cookie_of(address, OWN))
    another.tell(board=["next", board.shown_step.turn])
    wait_until(lambda: any("Reveal what came out" in told for told in boards(lecturer)), "the same on both")
    assert boards(teacher) == [] and board.tally.present_count == 3
