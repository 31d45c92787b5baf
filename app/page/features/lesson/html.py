"""Html of a lesson's steps. What a visitor has written is escaped here, and nowhere is it put in otherwise."""

import re
from collections.abc import Mapping, Sequence
from html import escape
from string import ascii_lowercase

from app.lessons import shelf
from app.lessons.bet_lines import scored
from app.lessons.length import told
from app.lessons.lesson import PREDICT, TEXT, Lesson, Numbers, Step, filled
from app.lessons.marks import TOLD_AFTER, AnswerMark, shown
from app.lessons.markup import html
from app.lessons.progress import Answer, Progress
from app.page.features.lesson import acts, core

FIGURE = re.compile(r"(<img [^>]*>)")
SIGNS = {True: ("right", "✓", "right"), False: ("wrong", "✗", "not so"), None: ("unmarked", "", "")}


def shelf_html(lessons: Mapping[str, Lesson]) -> str:
    """What there is to choose from. How far one has come in each only the browser knows (``js/lessons.js``)."""
    rows = "".join(
        f"<li><button type='button' class='lab-open' data-lesson='{escape(name)}' data-steps='{len(lesson.steps)}' "
        f"data-core='{core.numbers(lesson)}' data-fingerprint='{lesson.fingerprint}'>"
        f"<span class='lab-number'>{k}</span><b>{escape(lesson.title)}</b>"
        f"<small>{told(lesson)}</small><small class='lab-come'></small></button></li>"
        for k, (name, lesson) in enumerate(lessons.items(), 1))
    return "<div class='lab-lesson lab-shelf'><p>You predict, run, observe, and then read why.</p>" \
           f"<div class='lab-go-on'></div><ol>{rows}</ol></div>"


def head_html(lesson: Lesson, progress: Progress) -> str:
    """Title, and how far one has come."""
    return f"<div class='lab-lesson lab-lesson-head'><i class='lab-studying'></i><b>{escape(lesson.title)}</b>" \
           f"{core.where(lesson, progress)}</div>"


def intro_html(lesson: Lesson, numbers: Numbers, teacher: bool) -> str:
    """The lesson's beginning: what it is for, and its first words."""
    goals = "".join(f"<li>{escape(goal)}</li>" for goal in lesson.goals)
    known = shelf.lessons()
    before = [known[name].title if name in known else name for name in lesson.prerequisites]
    needs = f"<p>Do before: {escape('; '.join(before))}.</p>" if before else ""
    return f"<div class='lab-lesson'><p>{core.takes(lesson)}</p><ul>{goals}</ul>{needs}" \
           f"{text_html(lesson.intro, numbers)}{_notes(lesson.notes, teacher)}</div>"


def step_html(step: Step, number: int, numbers: Numbers, before: str, teacher: bool) -> str:
    """A step's text, below what is said ``before`` it, which is html. What it asks for is a button that does it."""
    text = acts.with_buttons(text_html(step.text, numbers))
    if step.stage and acts.PUT not in text:
        text += f"<p>The run that this is about:</p>{acts.PUT}"
    kind = f"<span class='lab-kind lab-kind-{step.kind}'>{step.kind.capitalize()}</span>"
    deeper = "" if step.core else core.DEEPER
    title = f"<h2>{escape(filled(step.title, numbers))}</h2>"
    return f"<div class='lab-lesson' data-step='{number}'>{kind}{deeper}{title}" \
           f"{before}{text}{_notes(step.notes, teacher)}</div>"


def choices_html(options: Sequence[str], chosen: int | None, fixed: bool, key: str) -> str:
    """A question's options, of which one is ``chosen``, counted from 1; ``key`` tells them from those of another."""
    rows = "".join(
        f"<label class='lab-choice'><input type='radio' name='lab-answer' value='{k}' data-question='{escape(key)}'"
        f"{' checked' * (k == chosen)}{' disabled' * fixed}><span><b>{letter})</b> {escape(option)}</span></label>"
        for k, (letter, option) in enumerate(zip(ascii_lowercase, options, strict=False), 1))
    return f"<div class='lab-lesson lab-choices' role='radiogroup' aria-label='Answer'>{rows}</div>"


def compared_html(steps: Sequence[Step], answers: Mapping[str, Answer], marks: Mapping[str, AnswerMark | str],
                  numbers: Numbers) -> str:
    """Each answer beside what came out; ``marks`` has a sentence where there is no mark yet."""
    rows = []
    for step in steps:
        asked, answer = step.question, answers.get(step.key)
        if asked is None or answer is None:
            continue
        mark = marks.get(step.key, "being worked out …")
        if isinstance(mark, str):
            out = f"<td colspan='2'>{escape(mark)}</td>"
        else:
            kind, sign, word = SIGNS[mark.right]
            came = "for your teacher" if asked.kind == TEXT else escape(scored(mark))
            out = f"<td>{came}</td><td class='lab-{kind}' title='{word}' aria-label='{word}'>{sign}</td>"
        said = escape(filled(shown(asked, answer.first), numbers))
        rows.append(f"<tr><th scope='row'>{escape(filled(step.title, numbers))}</th><td>{said}</td>{out}</tr>")
    if not rows:
        return ""
    heads = "".join(f"<th scope='col'>{name}</th>" for name in ("question", "you said", "came out", "mark"))
    return f"<table class='lab-compared'><tr>{heads}</tr>{''.join(rows)}</table>"


def taken_html(step: Step, answer: Answer, numbers: Numbers, found: AnswerMark | str | None) -> str:
    """That an answer has been taken, and what was ``found`` of it, a mark or a sentence, if that may be told yet."""
    said = filled(shown(step.asked, answer.last), numbers)
    if step.kind == PREDICT:
        return recorded_html(said, "It is recorded; now see what happens.", None)
    if found is None or isinstance(found, str):
        return recorded_html(said, found or "", None)
    if found.right is not False:
        return recorded_html(said, "", found.right)
    told = answer.attempts >= TOLD_AFTER
    return recorded_html(said, f"It is {found.expected}." if told else "Look again, and try once more.", False)


def recorded_html(said: str, comment: str, right: bool | None) -> str:
    """That an answer has been taken: what it was, and what is to be said of it (read out by ``js/lesson_aloud.js``)."""
    kind, sign, word = SIGNS[right]
    mark = f" <span class='lab-{kind}'>{sign} {word}</span>" if sign else ""
    return f"<div class='lab-lesson lab-recorded'>Your answer: <b>{escape(said)}</b>{mark} " \
           f"{escape(comment)}</div>"


def end_html(lesson: Lesson, progress: Progress, marks: Mapping[str, AnswerMark | str], numbers: Numbers,
             paced: bool) -> str:
    """The end: all answers, what to do with them, in a class that is ``paced`` by a board or without, and what there is
    more."""
    table = compared_html(list(lesson.questions.values()), progress.answers, marks, numbers)
    missing = sum(step.question is not None and step.key not in progress.answers for step in lesson.walk(progress.core))
    more = core.left(lesson) if progress.core and not paced else ""
    left = f"<p>{missing} question{'s are' if missing > 1 else ' is'} still open; go back to answer." \
           "</p>" if missing else ""
    kept = "<b>Hand in</b> saves a file with your answers and times, without a name; they are not kept otherwise." if \
        paced else "<b>Hand in</b> saves a file with your answers and times, and your name if you have given one. " \
        "Nothing is sent to anybody."
    return f"<div class='lab-lesson'><h2>The end</h2>{left}{table}<p>{kept}</p>{more}</div>"


def text_html(markdown: str, numbers: Numbers) -> str:
    """Of a lesson, its figures as buttons that show them large."""
    return FIGURE.sub(r"<button type='button' class='lab-enlarge' aria-label='enlarge the figure'>\1"
                      "<span aria-hidden='true'>enlarge</span></button>",
                      html(filled(markdown, numbers), shelf.FOLDER))


def _notes(notes: str, teacher: bool) -> str:
    return f"<aside class='lab-teacher'><b>Teacher</b>{html(notes, shelf.FOLDER)}</aside>" if notes and teacher else ""
