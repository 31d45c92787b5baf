"""The file that a lecturer may save of a class: what was answered, without names; nothing else is stored."""

import json

from app.lessons.lesson import filled
from app.lessons.marks import Right
from app.page.features.board.board import REVEALED, Board, has_chart
from app.page.features.board.chart import right_among

SCHEMA = "mpm-lab/board/1"


def text(board: Board) -> str:
    """As JSON: each question with its answers, sorted, and what came out, where that has been revealed."""
    questions = []
    for at, step in enumerate(board.lesson.steps, 1):
        if step.question is None:
            continue
        answers, came = board.tally.answers(step.key), board.came_out(step)
        revealed = came if board.stage(at) == REVEALED and isinstance(came, Right) else None
        questions.append({
            "key": step.key, "step": step.kind, "title": filled(step.title, board.numbers),
            "kind": step.asked.kind, "unit": step.asked.unit,
            "options": [filled(option, board.numbers) for option in step.asked.options],
            "count": len(answers), "late": board.tally.late(step.key),
            "answers": answers if has_chart(step) else None,
            "came_out": revealed and revealed.told,
            "right": None if revealed is None else right_among(step.asked, answers, revealed)})
    return json.dumps({"schema": SCHEMA, "lesson": board.lesson.name, "fingerprint": board.lesson.fingerprint,
                       "numbers": dict(board.numbers), "questions": questions}, ensure_ascii=False, indent=1) + "\n"
