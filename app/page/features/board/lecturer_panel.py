"""The lecturer's view of the board: it covers the page (``js/board.js``) or reveals the stage."""

import json
import threading
from html import escape
from typing import Any

from app import shareable_state
from app.access.rate_limited_log import log_failure
from app.classroom.class_board_state import BACK, NEXT, REVEALED, ClassBoardState, has_chart
from app.classroom.class_context import LecturerContext
from app.language.translation import with_language
from app.lessons.answer_marking import RightAnswer
from app.lessons.lesson import fill_numbers
from app.page.feature import Feature
from app.page.features.board.chart import count_right_answers
from app.page.features.board.slides import next_button_label, slide_html
from app.page.page_context import PageContext

AGAIN = 0.25  # least seconds between two redraws: thirty may answer at once
STAGE, SAVE = "stage", "save"
SCHEMA = "mpm-lab/board/1"  # of the file that a lecturer may save


class LecturerBoardPanel(Feature):
    """Board of a class on its lecturer's page: shows the board's slide, and controls what the class sees."""

    def __init__(self, page: PageContext, lecturer: LecturerContext):
        self._page, self._lecturer = page, lecturer
        self._board = board = lecturer.board
        self._covers, self._at, self._closed = True, "", threading.Event()
        page.set_frame_conditions(uncovered=False)
        self.messages = {"board": self._on_message}
        self._drawing, self._news = threading.Lock(), threading.Event()
        self._says = page.gui.add_html("")
        board.watch(self._news.set)
        self.draw()
        threading.Thread(target=with_language(self._draw_loop), name="board", daemon=True).start()

    @classmethod
    def build(cls, page: PageContext) -> "LecturerBoardPanel | None":
        return cls(page, page.lecturer) if page.lecturer else None

    def close(self) -> None:
        """Stops following the board when the lecturer leaves; the board stays as it is."""
        self._board.unwatch(self._news.set)
        self._closed.set()
        self._news.set()

    def draw(self) -> None:
        """Sends the board's present slide to the browser."""
        with self._drawing:
            place = self._board.shown_step
            self._says.content = (
                f"<template class='lab-board' data-turn='{place.turn}' data-covers='{'yes' * self._covers}' "
                f"data-next='{escape(next_button_label(self._board, place))}' data-back='{'yes' * (place.at > 0)}'>"
                f"{slide_html(self._board, place, self._lecturer.join_info_for(self._page.store.here))}</template>")

    def _update_stage_cover(self, step: int) -> None:
        """Covers the stage, which pauses it, or uncovers it and shows the run of a ``step`` (from 1)."""
        page = self._page
        page.set_frame_conditions(uncovered=not self._covers)
        if not self._covers:
            page.presenter.begin()
            if page.lesson:
                page.lesson.go_to_step(self._board.core, step)
            if (stage := stage_state_text(self._board, step)) != self._at:
                self._at = stage
                page.controls.show(shareable_state.parse_state(stage))

    def _draw_loop(self) -> None:
        while not self._closed.is_set():
            self._news.wait()
            self._news.clear()
            if not self._closed.is_set():
                try:
                    self.draw()
                except Exception as error:  # one bad picture must not end the board
                    log_failure("the board could not be drawn", error)
            self._closed.wait(AGAIN)

    def _on_message(self, message: Any) -> None:
        """Handles [button, the board's turn when clicked] or ["stage", 0 to cover it]; ignores invalid messages."""
        if not (isinstance(message, list) and len(message) == 2 and type(message[1]) is int):
            return
        what, turn = message
        if what in (NEXT, BACK):
            self._board.press_button(what, turn)
        elif what == STAGE:
            self._covers = turn == 0
            self._update_stage_cover(self._board.shown_step.at)
        elif what == SAVE:
            self._page.client.send_file_download(
                f"{self._board.lesson.name}-class.json", answers_json(self._board).encode(), save_immediately=True)
        self.draw()


def stage_state_text(board: ClassBoardState, at: int) -> str:
    """Returns the stage's state as text at step ``at``: of the last step up to there that has one, or ""."""
    stages = [step.stage for step in board.lesson.steps[:at] if step.stage]
    return fill_numbers(stages[-1], board.numbers) if stages else ""


def answers_json(board: ClassBoardState) -> str:
    """Returns all answers of a class as JSON, without names: by question and sorted, with the result if revealed."""
    questions = []
    for at, step in enumerate(board.lesson.steps, 1):
        if step.question is None:
            continue
        answers, came = board.tally.answers(step.key), board.computed_right_answer(step)
        revealed = came if board.question_phase(at) == REVEALED and isinstance(came, RightAnswer) else None
        questions.append({
            "key": step.key, "step": step.kind, "title": fill_numbers(step.title, board.numbers),
            "kind": step.asked_question.kind, "unit": step.asked_question.unit,
            "options": [fill_numbers(option, board.numbers) for option in step.asked_question.options],
            "count": len(answers), "late": board.tally.count_late(step.key),
            "answers": answers if has_chart(step) else None, "came_out": revealed and revealed.text,
            "right": None if revealed is None else count_right_answers(step.asked_question, answers, revealed)})
    return json.dumps({"schema": SCHEMA, "lesson": board.lesson.name, "fingerprint": board.lesson.fingerprint,
                       "numbers": dict(board.numbers), "questions": questions}, ensure_ascii=False, indent=1) + "\n"
