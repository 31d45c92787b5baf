"""Html of a lesson's steps. Visitors' input is escaped here and inserted nowhere else."""

import re
from collections.abc import Mapping, Sequence
from html import escape
from string import ascii_lowercase

from app.language.translation import current_language, lazy, tr, trn, use_language
from app.lessons import catalogue
from app.lessons.answer_marking import AnswerMark, format_answer
from app.lessons.duration import minutes_text
from app.lessons.interval_bet_chart import BettorIntervalLines, expected_answer_text, make_bet_chart
from app.lessons.interval_bets import Bettor
from app.lessons.lesson import CHOICE, TEXT, TITLES, Lesson, Numbers, Step, fill_numbers
from app.lessons.markdown_html import to_html
from app.lessons.student_progress import RecordedAnswer, StudentProgress
from app.page.features.lesson import instruction_buttons, progress_and_navigation

FIGURE = re.compile(r"(<img [^>]*>)")
#: CSS class, sign and word of each mark.
SIGNS = {True: ("right", "✓", lazy("right")), False: ("wrong", "✗", lazy("not so")), None: ("unmarked", "", "")}


def lesson_list_html(lessons: Mapping[str, Lesson]) -> str:
    """Returns the list of lessons as html. The progress in each is known only to the browser (``js/lessons.js``)."""
    in_core = {name: " ".join(str(number) for number, step in enumerate(lesson.steps, 1) if step.core)
               for name, lesson in lessons.items()}
    rows = "".join(
        f"<li><button type='button' class='lab-open' data-lesson='{escape(name)}' data-steps='{len(lesson.steps)}' "
        f"data-core='{in_core[name]}' data-fingerprint='{lesson.fingerprint}'>"
        f"<span class='lab-number'>{k}</span><b{lang_attribute(lesson)}>{escape(lesson.title)}</b>"
        f"<small>{minutes_text(lesson)}{_language_note(lesson)}</small><small class='lab-come'></small></button></li>"
        for k, (name, lesson) in enumerate(lessons.items(), 1))
    return f"<div class='lab-lesson lab-shelf'><p>{tr('You predict, run, observe, and then read why.')}</p>" \
           f"<div class='lab-go-on'></div><ol>{rows}</ol></div>"


def _language_note(lesson: Lesson) -> str:
    return ", " + tr("in English") if lang_attribute(lesson) else ""


def lang_attribute(lesson: Lesson) -> str:
    """Returns the lang attribute for html of a lesson's text; "" if that is in the page's language."""
    return "" if lesson.language == current_language() else f" lang='{lesson.language}'"


def head_html(lesson: Lesson, progress: StudentProgress) -> str:
    """Returns a lesson's title and the student's progress as html."""
    return f"<div class='lab-lesson lab-lesson-head'><i class='lab-studying'></i>" \
           f"<b{lang_attribute(lesson)}>{escape(lesson.title)}</b>" \
           f"{progress_and_navigation.progress_html(lesson, progress)}</div>"


def intro_html(lesson: Lesson, numbers: Numbers, teacher: bool) -> str:
    """Returns a lesson's introduction as html: goals and first text, and notes for a teacher if ``teacher``."""
    goals = "".join(f"<li>{escape(goal)}</li>" for goal in lesson.goals)
    known = catalogue.load_lessons()
    before = [f"<span{lang_attribute(known[name])}>{escape(known[name].title)}</span>"
              if name in known and lang_attribute(known[name])
              else escape(known[name].title if name in known else name) for name in lesson.prerequisites]
    first = tr("Do before: {lessons}.", lessons="; ".join(before))
    needs = f"<p>{first}</p>" if before else ""
    only = f"<p>{tr('This lesson is in English.')}</p>" if lang_attribute(lesson) else ""
    return f"<div class='lab-lesson'>{only}<p>{progress_and_navigation.duration_text(lesson)}</p>" \
           f"<ul{lang_attribute(lesson)}>{goals}</ul>{needs}{_in_lang(lesson, text_html(lesson.intro, numbers))}" \
           f"{_teacher_notes_html(lesson, lesson.notes, teacher)}</div>"


def step_html(lesson: Lesson, step: Step, numbers: Numbers, before: str, teacher: bool, done: bool = False) -> str:
    """Returns a step's text as html below the html ``before``, with buttons, ticks if the step's phase was shown
    (``done``), and notes for a teacher if ``teacher``."""
    kind = f"<span class='lab-kind lab-kind-{step.kind}'>{tr(TITLES[step.kind])}</span>"
    deeper = "" if step.core else progress_and_navigation.optional_step_mark()
    title = f"<h2{lang_attribute(lesson)}>{escape(fill_numbers(step.title, numbers))}</h2>"
    with use_language(lesson.language):
        text = instruction_buttons.with_buttons(text_html(step.text, numbers))
        if step.shown_phase:
            text = instruction_buttons.list_below_phase_button(text, step.shown_phase, done)
        elif step.stage and instruction_buttons.run_on_stage_button_html() not in text:
            text += f"<p>{tr('The run that this is about:')}</p>{instruction_buttons.run_on_stage_button_html()}"
    return f"<div class='lab-lesson' data-step='{lesson.steps.index(step) + 1}'>{kind}{deeper}{title}" \
           f"{before}{_in_lang(lesson, text)}{_teacher_notes_html(lesson, step.notes, teacher)}</div>"


def curtain_html(step: Step, number: int) -> str:
    """Returns what covers the stage until the run of a step, by its ``number``, is put there, as html."""
    why = tr("The stage is closed until you load it, so that it does not show you another run, or the answer.")
    button = instruction_buttons.phase_button_html(step.shown_phase) if step.shown_phase else \
        instruction_buttons.run_on_stage_button_html()
    return f"<section class='lab-curtain' data-step='{number}' aria-label='{tr('the stage')}'>" \
           f"<b>{tr('This step has a run of its own.')}</b><p>{why}</p>{button}</section>"


def choices_html(options: Sequence[str], chosen: int | None, fixed: bool, key: str, lang: str = "") -> str:
    """Returns a question's options as radio buttons, one ``chosen`` (from 1), none to change if ``fixed``; ``key`` is
    the question's, ``lang`` an html attribute or ""."""
    rows = "".join(
        f"<label class='lab-choice'><input type='radio' name='lab-answer' value='{k}' data-question='{escape(key)}'"
        f"{' checked' * (k == chosen)}{' disabled' * fixed}><span{lang}><b>{letter})</b> {escape(option)}</span>"
        "</label>"
        for k, (letter, option) in enumerate(zip(ascii_lowercase, options, strict=False), 1))
    return f"<div class='lab-lesson lab-choices' role='radiogroup' aria-label='{tr('Answer')}'>{rows}</div>"


def answers_table_html(lesson: Lesson, steps: Sequence[Step], answers: Mapping[str, RecordedAnswer],
                       marks: Mapping[str, AnswerMark | str], numbers: Numbers) -> str:
    """Returns a table of answers and results as html; ``marks`` by step's key, a sentence where there is none yet."""
    rows, own = [], lang_attribute(lesson)
    for step in steps:
        asked, answer = step.question, answers.get(step.key)
        if asked is None or answer is None:
            continue
        mark = marks.get(step.key, tr("being worked out …"))
        if isinstance(mark, str):
            out = f"<td colspan='2'>{escape(mark)}</td>"
        else:
            kind, sign, word = SIGNS[mark.right]
            came = tr("for your teacher") if asked.kind == TEXT else escape(expected_answer_text(mark))
            word = tr(word) if word else ""
            out = f"<td{own if asked.kind == CHOICE else ''}>{came}</td>" \
                  f"<td class='lab-{kind}' title='{word}' aria-label='{word}'>{sign}</td>"
        said = escape(fill_numbers(format_answer(asked, answer.first), numbers))
        rows.append(f"<tr><th scope='row'{own}>{escape(fill_numbers(step.title, numbers))}</th>"
                    f"<td{own if asked.kind == CHOICE else ''}>{said}</td>{out}</tr>")
    if not rows:
        return ""
    heads = "".join(f"<th scope='col'>{name}</th>" for name in (tr("question"), tr("you said"), tr("came out"),
                                                                tr("mark")))
    return f"<table class='lab-compared'><tr>{heads}</tr>{''.join(rows)}</table>"


def recorded_answer_html(lesson: Lesson, step: Step, answer: RecordedAnswer, numbers: Numbers, comment: str,
                         right: bool | None) -> str:
    """Returns a recorded answer as html, with its mark (None: unknown) and a comment, which scripts read aloud."""
    said = fill_numbers(format_answer(step.asked_question, answer.last), numbers)
    own = lang_attribute(lesson) if step.asked_question.kind == CHOICE else ""
    kind, sign, word = SIGNS[right]
    mark = f" <span class='lab-{kind}'>{sign} {tr(word)}</span>" if sign else ""
    return f"<div class='lab-lesson lab-recorded'>{tr('Your answer:')} <b{own}>{escape(said)}</b>{mark} " \
           f"{escape(comment)}</div>"


def end_html(lesson: Lesson, progress: StudentProgress, marks: Mapping[str, AnswerMark | str], numbers: Numbers,
             paced: bool) -> str:
    """Returns the last page: all answers, what to do with them (``paced`` by a board or not), and links to more."""
    table = answers_table_html(lesson, list(lesson.questions.values()), progress.answers, marks, numbers)
    missing = sum(step.question is not None and step.key not in progress.answers
                  for step in lesson.steps_to_take(progress.core))
    open_ones = trn("{count} question is still open; go back to answer.",
                    "{count} questions are still open; go back to answer.", missing)
    left = f"<p>{open_ones}</p>" if missing else ""
    more = progress_and_navigation.core_end_note(lesson) if progress.core and not paced else ""
    what = tr("<b>Hand in</b> saves a file with your answers and times, and your name if you have given one. Nothing "
              "is sent to anybody.")
    if paced:
        what = tr("<b>Hand in</b> saves a file with your answers and times, without a name; they are not kept "
                  "otherwise.")
    return f"<div class='lab-lesson'><h2>{tr('The end')}</h2>{left}{table}<p>{what}</p>{more}</div>"


def text_html(markdown: str, numbers: Numbers) -> str:
    """Converts a lesson's markdown to html, with ``numbers`` filled in; figures are buttons that enlarge them."""
    name, short = tr("enlarge the figure"), tr("enlarge")
    return FIGURE.sub(rf"<button type='button' class='lab-enlarge' aria-label='{name}'>\1"
                      rf"<span aria-hidden='true'>{short}</span></button>",
                      to_html(fill_numbers(markdown, numbers), catalogue.FOLDER))


def _teacher_notes_html(lesson: Lesson, notes: str, teacher: bool) -> str:
    if not (notes and teacher):
        return ""
    text = _in_lang(lesson, to_html(notes, catalogue.FOLDER))
    return f"<aside class='lab-teacher'><b>{tr('Teacher')}</b>{text}</aside>"


def _in_lang(lesson: Lesson, words: str) -> str:
    """Returns the html ``words`` of a lesson, marked by the lesson's language if the page has another."""
    return f"<div{lang_attribute(lesson)}>{words}</div>" if lang_attribute(lesson) else words


WAITED_FOR = lazy("Bets are being compared with the results …")
ROW, OWN_ROW = 7, 12  # pixels between lines: of a judge, of the visitor


def bets_html(bettors: Sequence[Bettor] | str) -> str:
    """Returns a picture of bets as html, or a sentence given in their place; "" without bettors."""
    if isinstance(bettors, str):
        return f"<p class='lab-bets-later'>{escape(tr(bettors))}</p>"
    if not bettors:
        return ""
    picture = make_bet_chart(bettors)
    rows = "".join(map(_bettor_row_html, picture.bettors))
    axis = "".join(f"<span>{text}</span>" for _, text in picture.ticks)
    return f"<figure class='lab-bets'><figcaption>{picture.description}</figcaption>{rows}" \
           f"<div class='lab-bets-axis' aria-hidden='true'>{axis}</div></figure>"


def _bettor_row_html(bettor: BettorIntervalLines) -> str:
    """Returns the html of one bettor's row: name, result, and a line for each bet."""
    high = OWN_ROW if bettor.own else ROW
    lines = "".join(
        f"<line class='{'lab-held' if line[2] else 'lab-missed'}' x1='{line[0]:.2f}%' x2='{line[1]:.2f}%' "
        f"y1='{(k + 0.5) * high:g}' y2='{(k + 0.5) * high:g}'/>" for k, line in enumerate(bettor.lines) if line)
    label = escape(f"{bettor.name}: {bettor.result}", quote=True)
    return f"<div class='lab-bettor'><b>{escape(bettor.name)}</b> <span>{escape(bettor.result)}</span>" \
           f"<svg role='img' aria-label='{label}' height='{high * len(bettor.lines)}'>" \
           f"<line class='lab-bets-truth' x1='50%' x2='50%' y1='0' y2='100%'/>{lines}</svg></div>"
