"""A board without a page: what a press does, what seats are told, what is shown when, what is saved, and its tally."""

import json
import re
import threading
from dataclasses import replace

import pytest

from app.classroom import class_answers as tally_module
from app.classroom.class_answers import ClassAnswers
from app.classroom.class_board_state import BACK, COUNTED, NEXT, REVEALED, SHOWN, ClassBoardState
from app.language.translation import use_language
from app.lessons import catalogue
from app.lessons.lesson import CHOICE, INTERVAL, TEXT
from app.lessons.lesson_runs import RunCache, RunFailed
from app.lessons.student_progress import RecordedAnswer
from app.page.features.board.lecturer_panel import LecturerContext, answers_json
from app.page.features.board.slides import JoinInfo, next_button_label, question_scores, score_sentences, slide_html
from tests.support.processes import wait_until

DOOR = JoinInfo("http://lab/", "wave-4711")


class Waiting(RunCache):
    """Runs nothing: who asks for a result waits until it fails."""

    def __init__(self):
        self.go = threading.Event()

    def result(self, text):
        self.go.wait(30)
        raise RunFailed("it is broken")


@pytest.fixture
def lesson():
    """Two predictions that need no run, a step without a question, a free text and an interval."""
    four = catalogue.load_lesson("04-grid-crossing")
    number = next(step for step in four.steps if step.key == "where-does-the-trouble-begin")
    choice = replace(four.steps[0], question=replace(four.steps[0].asked_question, holds=("1 < 0", "1 < 2", "2 < 1")))
    text = replace(number, key="why", title="Why?", question=replace(number.asked_question, kind=TEXT, expected=""))
    wide = replace(number, key="how-much", title="How much?", question=replace(number.asked_question, kind=INTERVAL))
    return replace(four, steps=(choice, four.steps[1], number, text, wide))


@pytest.fixture
def board(lesson):
    board = ClassBoardState(lesson, RunCache())
    yield board
    board.stop_computations()


def press(board, *whats):
    for what in whats:
        board.press_button(what, board.shown_step.turn)


def shown(board):
    return slide_html(board, board.shown_step, DOOR)


def revealed(board):
    """Press for what came out, and wait until it is there."""
    press(board, NEXT)
    wait_until(lambda: "being computed" not in shown(board), "what came out")
    return shown(board)


def test_the_one_next_thing_is_what_the_button_says(board):
    """From the beginning to the end, and no further."""
    said = []
    while following := next_button_label(board, board.shown_step):
        said.append((following, board.shown_step.at, board.shown_step.question_phase))
        press(board, NEXT)
    assert said == [
        ("Open step 1 for all", 0, COUNTED), ("Show the answers", 1, COUNTED), ("Reveal what came out", 1, SHOWN),
        ("Open step 2 for all", 1, REVEALED), ("Open step 3 for all", 2, COUNTED), ("Show the answers", 3, COUNTED),
        ("Reveal what came out", 3, SHOWN), ("Open step 4 for all", 3, REVEALED), ("Open step 5 for all", 4, COUNTED),
        ("Show the answers", 5, COUNTED), ("Reveal what came out", 5, SHOWN), ("Show how the class did", 5, REVEALED)]
    end = board.shown_step
    press(board, NEXT)
    assert board.shown_step == end and end.at == board.end_position == board.last_open_step


def test_the_core_alone_is_opened_where_that_is_asked_for(lesson):
    """Steps are counted as the class takes them, there and back, and seats know it."""
    deep = replace(lesson, steps=tuple(replace(step, core=step.key not in ("why", lesson.steps[1].key))
                                       for step in lesson.steps))
    board = ClassBoardState(deep, RunCache(), core=True)
    press(board, *[NEXT] * 4)
    assert (board.shown_step.at, board.last_open_step, board.step_count) == (3, 3, 3) and "step 2 of 3" in shown(board)
    assert board.add_seat("a").progress().core
    press(board, BACK)
    assert board.shown_step.at == 1 and next_button_label(board, board.shown_step) == "Go forward to step 2"
    board.stop_computations()


def test_looking_back_closes_nothing_and_opens_nothing(board):
    press(board, *[NEXT] * 4, BACK)
    assert (board.shown_step.at, board.last_open_step, board.shown_step.shows_last_open_step) == (1, 2, False)
    assert "the class is at step 2" in shown(board)
    assert next_button_label(board, board.shown_step) == "Go forward to step 2"
    press(board, *[BACK] * 5)
    assert board.shown_step.at == 0 and board.last_open_step == 2
    press(board, NEXT, NEXT)
    assert board.shown_step.shows_last_open_step and board.last_open_step == 2


def test_a_press_counts_only_for_the_board_that_it_was_meant_for(board):
    """Two lecturers who press at once, or one press that comes twice."""
    turn = board.shown_step.turn
    for _ in range(3):
        board.press_button(NEXT, turn)
    assert board.last_open_step == 1
    for what in ("", "reveal", "stage"):
        press(board, what)
    assert board.shown_step.turn == 1


def test_seats_are_told_when_a_step_is_open_and_of_nothing_else(board):
    told, seat = [], board.add_seat("a")
    gone = board.add_seat("b")
    seat.watch_open_steps(lambda: told.append(seat.last_open_step))
    gone.watch_open_steps(lambda: told.append("gone"))
    gone.leave()
    board.add_seat("c").watch_open_steps(lambda: 1 / 0)
    last = board.add_seat("d")
    last.watch_open_steps(lambda: told.append("and the last"))
    press(board, NEXT, NEXT, NEXT, NEXT, BACK, NEXT)
    assert told == [1, "and the last", 2, "and the last"]


def test_how_many_first_then_what_and_then_what_came_out(board):
    seats = [board.add_seat(key) for key in "abc"]
    first = board.step(1)
    assert "3 are here" in shown(board) and "wave-4711" in shown(board) and "http://lab/" in shown(board)
    press(board, NEXT)
    for seat in seats:
        seat.report_step(1)
    seats[0].report_answer(first, 3)
    assert "1 of 3 has predicted" in shown(board)
    seats[1].report_answer(first, 2)
    assert "2 of 3 have predicted" in shown(board) and "--part: 0.3333" not in shown(board)
    assert not re.search(r"<b>\d</b></li>", shown(board)) and "came out" not in shown(board)
    press(board, NEXT)
    assert re.findall(r"<b>(\d)</b></li>", shown(board)) == ["0", "1", "1"] and "came out" not in shown(board)
    assert json.loads(answers_json(board))["questions"][0]["came_out"] is None
    for late in (seats[2], board.add_seat("d")):  # also one who comes only then
        for _ in range(2):
            late.report_answer(first, 2)
    seats[0].report_answer(first, 2)
    assert re.findall(r"<b>(\d)</b></li>", shown(board)) == ["0", "1", "1"]
    assert "2 came later and are not counted" in shown(board)
    assert "1 of 2 was right" in revealed(board) and "✓ this came out" in shown(board)


def test_a_step_without_a_question_says_who_has_come_and_what_comes_next(board):
    seats = [board.add_seat(key) for key in "ab"]
    press(board, *[NEXT] * 4)
    seats[0].report_step(2)
    assert "1 of 2 have come to this step" in shown(board)
    assert "Next: Predict: Where does the trouble begin?" in shown(board)


def test_free_texts_are_counted_and_never_shown_or_saved(board):
    seat = board.add_seat("a")
    press(board, *[NEXT] * 8)
    seat.report_answer(board.step(4), "my name is Ada")
    assert "1 of 1 has predicted" in shown(board)
    press(board, NEXT)
    assert "Ada" not in answers_json(board) + shown(board) and board.shown_step.at == 5
    assert board.tally.answers("why") == [""]


def test_the_end_says_how_well_the_class_has_known(board):
    seats = [board.add_seat(key) for key in "abc"]
    given = {CHOICE: (2, 2, 1), "number": (3.125, 3.0, 10.0), INTERVAL: ([3, 4], [1, 2], [0, 9])}
    while board.shown_step.at < board.end_position:
        step = board.step(board.shown_step.at)
        if step and step.question and step.asked_question.kind != TEXT and board.shown_step.question_phase == COUNTED:
            for seat, answer in zip(seats, given[step.asked_question.kind], strict=True):
                seat.report_answer(step, answer)
        press(board, NEXT)
    wait_until(lambda: len(question_scores(board)) == 3, "what came out")
    assert score_sentences(question_scores(board)) == ["4 of 6 predictions were right: 67 %",
                                                       "2 of 3 intervals contain the result: 67 % (80 % expected)"]
    assert "2 of 3 held" in shown(board) and shown(board).count("2 of 3 right") == 2
    kept = json.loads(answers_json(board))
    assert kept.keys() == {"schema", "lesson", "fingerprint", "numbers", "questions"}
    assert {key for question in kept["questions"] for key in question} == {
        "key", "step", "title", "kind", "unit", "options", "count", "late", "answers", "came_out", "right"}
    assert [(question["count"], question["answers"], question["right"]) for question in kept["questions"]] == [
        (3, [1, 2, 2], 2), (3, [3.0, 3.125, 10.0], 2), (0, None, None), (3, [[0, 9], [1, 2], [3, 4]], 2)]


@pytest.mark.parametrize("here, link", [
    ("", "http://10.0.0.5:8080/"), ("http://localhost:8080/", "http://10.0.0.5:8080/"),
    ("https://lab.school.example/", "https://lab.school.example/")])
def test_the_board_shows_the_address_by_which_a_class_comes_in(board, here, link):
    """That of the lecturer's browser, unless only this machine can mean it."""
    door = LecturerContext(board, JoinInfo("http://10.0.0.5:8080/", "wave 4711")).join_info_for(here)
    assert (door.link, door.warning, door.full_link) == (link, "", f"{link}#code=wave%204711")
    door = LecturerContext(board,
                           JoinInfo("http://127.0.0.1:8080/", "wave-4711")).join_info_for("http://localhost:8080/")
    assert "Only this computer" in slide_html(board, board.shown_step, door)  # which nobody else can open


def test_what_cannot_be_worked_out_is_said_and_ends_nothing():
    outcomes = Waiting()
    board = ClassBoardState(catalogue.load_lesson("04-grid-crossing"), outcomes)
    press(board, NEXT, NEXT, NEXT)
    assert "being computed" in shown(board)
    outcomes.go.set()
    wait_until(lambda: "could not be computed" in shown(board), "the sentence")
    press(board, NEXT)
    assert board.last_open_step == 2
    board.stop_computations()


def test_a_visitor_who_comes_back_finds_his_answers_and_his_place(board):
    """By his key; another finds nothing of them."""
    seat = board.add_seat("a")
    press(board, NEXT)
    seat.report_step(1)
    seat.progress().record("a-gentle-test", 2, 1.0)
    seat.leave()
    again = board.add_seat("a").progress()
    assert again.step == 1 and again.answers["a-gentle-test"].first == 2
    assert board.add_seat("b").progress().answers == {} and board.add_seat("b").progress().step == 0


def test_a_visitor_is_one_however_many_pages_he_has():
    tally = ClassAnswers()
    first, again = tally.register_page("a"), tally.register_page("a")
    assert first is again and tally.present_count == 1
    tally.unregister_page("a")
    assert tally.present_count == 1
    tally.unregister_page("a")
    assert tally.present_count == 0


def test_who_leaves_leaves_his_answers():
    """He is still one of those who were asked; one who has left without an answer is not."""
    tally = ClassAnswers()
    for key in "abc":
        tally.register_page(key)
    tally.record_answer("a", "how-much", 1)
    for key in "ac":
        tally.record_step(key, 2)
    tally.unregister_page("a")
    tally.unregister_page("b")
    assert (tally.count_reached(2), tally.count_reached(3)) == (1, 0)
    assert (tally.present_count, tally.count_present_or_answered("how-much"), tally.answers("how-much")) == (1, 2, [1])
    entry = tally.register_page("a")
    assert tally.count_present_or_answered("how-much") == 2 and entry.valid == {"how-much": 1}


def test_memory_ends_somewhere(monkeypatch):
    """Cookies are easily had: who has left without an answer is forgotten first, and one too many is not counted,
    though he has his lesson."""
    monkeypatch.setattr(tally_module, "MOST", 3)
    tally = ClassAnswers()
    entries = {key: tally.register_page(key) for key in "abc"}
    entries["b"].answers["how-much"] = RecordedAnswer(1, 1, 1, 1.0)
    for key in "ab":
        tally.unregister_page(key)
    assert tally.register_page("d").pages == 1 and tally.present_count == 2  # in the place of a
    assert tally.register_page("b").answers and tally.present_count == 3
    late = tally.register_page("e")
    tally.record_answer("e", "how-much", 1)
    assert late.pages == 1 and tally.present_count == 3 and tally.answers("how-much") == []


def test_thirty_at_once_are_thirty():
    """Each from a thread of its own; whoever listens hears of it, and may ask the tally then."""
    heard = []
    tally = ClassAnswers(lambda: heard.append(tally.count_present_or_answered("how-much")))

    def visit(k):
        tally.register_page(str(k))
        for answer in (k, k + 1):
            tally.record_answer(str(k), "how-much", answer)

    threads = [threading.Thread(target=visit, args=(k,)) for k in range(30)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert tally.answers("how-much") == list(range(30)) and max(heard) == 30


def test_a_step_that_was_reached_stays_reached():
    """Who looks back at an earlier one has been there all the same."""
    tally = ClassAnswers()
    entry = tally.register_page("a")
    for step in (2, 5, 3):
        tally.record_step("a", step)
    assert entry.step == 5


def test_a_board_speaks_the_language_of_who_looks_at_it():
    original, *others = catalogue.load_every_language("04-grid-crossing")
    board = ClassBoardState(original, RunCache(), translations=others)
    for code, title in (("en", "Grid crossing: "), ("de", "Zellwechsel: ")):
        with use_language(code):
            assert f"<h2>{title}" in shown(board)
    board.stop_computations()
