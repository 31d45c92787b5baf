"""A class on the board: pupils who predict, reload, come late and cheat, and a lecturer whose page, in a real
browser, is driven by keyboard. The counts are right, and nobody is told what another has said."""

import json
import re
from contextlib import ExitStack, closing, contextmanager

from app.lessons import catalogue
from tests.app.serving.test_class_code import enter
from tests.browser.conftest import FEW_FRAMES, SIZE, axe_finds, no_errors, serving
from tests.browser.driving import downloaded, until
from tests.browser.page.test_present import SIZES
from tests.support.pupils import Pupil, cookie_of

LESSON = catalogue.load_lesson("04-grid-crossing")
STEPS, LETTERS, HEADING = LESSON.steps, 28, 40  # pixels for the last row, in a window of 1280 by 720
ON_THE_BOARD = SIZES.replace("(document.body,", "(document.getElementById('lab-board'),")  # what is below is covered
#: Of what is on the board, what is wider than its box.
CUT = """[...document.querySelectorAll("#lab-board *")].filter(e => getComputedStyle(e).overflowX !== "visible"
    && e.scrollWidth > e.clientWidth + 1).map(e => e.className)"""
#: In one look, for the heading is made anew with each number on it.
HEADING_SIZE = "parseFloat(getComputedStyle(document.querySelector('#lab-board h2')).fontSize)"
PUPILS = 5
OUT = 120.0  # seconds until it is known what came out: three runs, on a machine that does other things


class Lecturer:
    """Who has the board's page, and nothing but keys."""

    def __init__(self, page):
        self.page = page

    @property
    def board(self):
        return self.page.locator("#lab-board")

    @property
    def turn(self):
        return self.page.locator("template.lab-board").get_attribute("data-turn")

    def reads(self, text):
        until(lambda: text in self.board.inner_text(), f"on the board: {text}")

    def press(self, key):
        """And wait until the board has heard it."""
        before = self.turn
        self.page.keyboard.press(key)
        until(lambda: self.turn != before, f"what {key} does")

    def counts(self):
        return [int(count) for count in self.board.locator(".lab-counted li > b:last-child").all_inner_texts()]


@contextmanager
def lecturer_of(chromium, address, code):
    """Opens a page that has never been anywhere."""
    context = chromium.new_context(viewport=SIZE, accept_downloads=True)
    page = context.new_page()
    page.add_init_script(FEW_FRAMES)
    with no_errors(page), closing(context):
        page.goto(f"{address}/?fixedDpr=0.5#code={code}")
        until(page.locator("#lab-board").is_visible, "the board", 60)
        yield Lecturer(page)


def readable(lecturer):
    """Letters for the last row, nothing cut off, nothing beyond the window, and no fault that axe finds."""
    words = lecturer.page.evaluate(ON_THE_BOARD)
    assert words and min(size for _, size, *_ in words) >= LETTERS, sorted(words, key=lambda word: word[1])[:3]
    assert all(left >= 0 and right <= SIZE["width"] for *_, left, right in words)
    assert lecturer.page.evaluate(HEADING_SIZE) >= HEADING
    assert lecturer.page.evaluate(CUT) == [] and axe_finds(lecturer.page) == []


def test_a_class_on_the_board(chromium, tmp_path):
    with serving(arguments=("--lesson", "4", "--board"), coded=2) as (address, _, lines), ExitStack() as stack:
        code, own = (re.search(rf"{whose} code.* is (\S+);", lines)[1] for whose in ("class", "board's"))
        assert code != own and enter(address, "surf-9999")[0] == 403  # made up, on this machine alone, too
        lecturer = stack.enter_context(lecturer_of(chromium, address, own))
        lecturer.reads("Nobody is here yet.")
        lecturer.reads(code)
        readable(lecturer)

        def come(cookie):
            pupil = stack.enter_context(Pupil(address, cookie))
            pupil.find("Next")
            return pupil

        cookies = [cookie_of(address, code) for _ in range(PUPILS)]
        class_ = [come(cookie) for cookie in cookies[:-1]]  # and one who comes late
        lecturer.reads(f"{PUPILS - 1} are here.")
        expected = predictions(lecturer, class_, cookies, come)
        the_answers(lecturer, expected)
        what_came_out(lecturer, expected, come(cookies[-1]))
        the_board_after_a_reload(lecturer)
        keys_that_do_nothing(lecturer)
        the_stage_and_back(lecturer)
        saved(lecturer, expected, tmp_path)
        for pupil in class_:
            assert not any("have predicted" in told or "lab-bars" in told or own in told for told in pupil.told)


def predictions(lecturer, class_, cookies, come):
    """The first step: all but one predict, and one reloads. The counts of the options."""
    for pupil in class_:
        assert pupil.off("Next")
        pupil.tell(board=["next", 0])
    lecturer.press("ArrowRight")
    assert lecturer.turn == "1"
    counts, said = [0, 0, 0], len(class_) - 1
    for k, pupil in enumerate(class_):
        pupil.go_on()
        if k < said:
            pupil.answer(STEPS[0], 1 + k % 3)
            counts[k % 3] += 1
            assert pupil.off("Next")
    lecturer.reads(f"{said} of {len(class_)} have predicted")
    assert lecturer.counts() == []
    readable(lecturer)
    class_[0].close()
    again = come(cookies[0])
    assert again.at == 1 and again.off("Record my prediction")
    lecturer.reads(f"{said} of {len(class_)} have predicted")
    return counts


def the_answers(lecturer, expected):
    lecturer.press("PageDown")
    lecturer.reads(f"{sum(expected)} answers.")
    assert lecturer.counts() == expected and "this came out" not in lecturer.board.inner_text()
    readable(lecturer)


def what_came_out(lecturer, expected, late):
    """A latecomer predicts what is shown already, and is not counted."""
    late.go_on()
    late.answer(STEPS[0], 1)
    lecturer.reads("1 came later and is not counted.")
    lecturer.press("Space")
    until(lambda: "this came out" in lecturer.board.inner_text(), "what came out", OUT)
    lecturer.reads(f"{expected[0]} of {sum(expected)} {'was' if expected[0] == 1 else 'were'} right.")
    assert lecturer.counts() == expected
    readable(lecturer)
    assert late.off("Next")
    lecturer.press("ArrowRight")
    lecturer.reads("Next: Observe: How many particles crossed a cell boundary?")
    late.go_on()
    readable(lecturer)


def the_board_after_a_reload(lecturer):
    turn = lecturer.turn
    lecturer.page.reload()
    until(lambda: lecturer.board.is_visible() and lecturer.turn == turn, "the board as it was", 60)
    lecturer.reads("step 2 of 17")


def keys_that_do_nothing(lecturer):
    """None that means something on the page below; a held key opens one step; looking back closes nothing."""
    turn = lecturer.turn
    for key in ("Escape", "r", "p", "m", "1", "l", ".", "Home", "End", "Enter"):
        lecturer.page.keyboard.press(key)
    lecturer.page.evaluate("for (let k = 0; k < 9; k++) document.body.dispatchEvent(new KeyboardEvent('keydown', "
                           "{key: 'PageDown', repeat: true, bubbles: true, cancelable: true}))")
    assert lecturer.turn == turn and lecturer.page.locator("body.lab-board-view").count() == 1
    lecturer.press("ArrowLeft")
    lecturer.reads("you look back; the class is at step 2")
    lecturer.press("ArrowRight")
    lecturer.reads("have come to this step")


def the_stage_and_back(lecturer):
    page = lecturer.page
    page.keyboard.press("v")
    until(lambda: page.locator("body.lab-board-view").count() == 0, "the stage")
    until(page.locator(".lab-lesson-head", has_text="step 2 of 17").is_visible, "the step beside it")
    page.get_by_role("button", name="Back to the board").click()
    until(page.locator("body.lab-board-view").count, "the board")


def saved(lecturer, expected, folder):
    """A file without names, and nothing else is kept."""
    file = downloaded(lecturer.page, lecturer.board.get_by_role("button", name="Save").click)
    assert file.suggested_filename == f"{LESSON.name}-class.json"
    file.save_as(folder / "class.json")
    first = json.loads((folder / "class.json").read_text(encoding="utf-8"))["questions"][0]
    assert first["answers"] == [option for option, count in enumerate(expected, 1) for _ in range(count)]
    assert (first["count"], first["late"], first["right"]) == (sum(expected), 1, expected[0])
