"""The board's slides as html: the beginning, a step, the end. All counts are taken when a slide is rendered."""

from dataclasses import dataclass
from html import escape

import segno

from app.classroom.class_board_state import COUNTED, REVEALED, ClassBoardState, ShownBoardStep, has_chart
from app.classroom.class_context import JoinInfo
from app.language.translation import lazy, tr, trn
from app.lessons import catalogue
from app.lessons.answer_marking import RightAnswer
from app.lessons.lesson import CHOICE, INTERVAL, PREDICT, TITLES, Step, fill_numbers
from app.lessons.markdown_html import to_html
from app.page.features.board import chart

IN_ONE = 8  # scores in one column
NOBODY, WORKING = lazy("Nobody is here yet."), lazy("The result is being computed …")
HOW, HELD, RIGHT = lazy("How the class did"), lazy("{right} of {of} held"), lazy("{right} of {of} right")
PREDICTIONS = lazy("{right} of {of} predictions were right: {share} %")
OBSERVATIONS = lazy("{right} of {of} observations were right: {share} %")
INTERVALS = lazy("{right} of {of} intervals contain the result: {share} % ({level} % expected)")


@dataclass(frozen=True)
class QuestionScore:
    """Score of a revealed question: the number of ``answers``, and how many are ``right``, or contain the result."""

    step: Step
    right: int
    answers: int


def slide_html(board: ClassBoardState, place: ShownBoardStep, join_info: JoinInfo) -> str:
    """Returns the slide at a board's position as html, without its buttons; ``join_info`` is for the first slide."""
    step = board.step(place.at)
    where = tr("step {at} of {total}", at=board.step_number(place.at), total=board.step_count) if step else \
        tr("the beginning") if place.at == 0 else tr("the end")
    now = tr("you look back; the class is at step {at}", at=board.step_number(place.last_open_step))
    past = "" if place.shows_last_open_step else f"<b class='lab-looks-back'>{now}</b>"
    here = board.tally.present_count
    here_said = trn("{count} is here", "{count} are here", here) if here else tr("nobody is here")
    count = f"<span>{here_said}</span>" if place.at else ""  # the first slide has it below
    top = f"<header><span>{where}</span>{past}{count}</header>"
    body = _step_html(board, place, step) if step else \
        _beginning_html(board, join_info) if place.at == 0 else _end_html(board)
    return f"{top}{body}"


def next_button_label(board: ClassBoardState, place: ShownBoardStep) -> str:
    """Returns the label of the button that goes on from a board's position; "" at the end."""
    step, following = board.step(place.at), board.next_position(place.at)
    if not place.shows_last_open_step:
        return tr("Show how the class did") if following == board.end_position else \
            tr("Go forward to step {at}", at=board.step_number(following))
    if step and has_chart(step) and place.question_phase < REVEALED:
        return tr("Show the answers") if place.question_phase == COUNTED else tr("Reveal what came out")
    if following < board.end_position:
        return tr("Open step {at} for all", at=board.step_number(following))
    return tr("Show how the class did") if place.at < board.end_position else ""


def question_scores(board: ClassBoardState) -> list[QuestionScore]:
    """Returns the scores of a class in all questions revealed so far, in the lesson's order."""
    found = []
    for at, step in enumerate(board.lesson.steps, 1):
        came = board.computed_right_answer(step)
        if board.question_phase(at) == REVEALED and isinstance(came, RightAnswer):
            answers = board.tally.answers(step.key)
            found.append(QuestionScore(step, chart.count_right_answers(step.asked_question, answers, came),
                                       len(answers)))
    return found


def _beginning_html(board: ClassBoardState, join_info: JoinInfo) -> str:
    picture = segno.make(join_info.full_link, error="l", micro=False).svg_inline(border=2, omitsize=True)
    warning = f"<p class='lab-warns'>{escape(join_info.warning)}</p>" if join_info.warning else ""
    here = board.tally.present_count
    count = trn("{count} is here.", "{count} are here.", here) if here else tr(NOBODY)
    first, then = tr("Open"), tr("and type the class code")
    return f"<h2>{escape(board.lesson.title)}</h2><div class='lab-door'><div><p>{first}</p>" \
           f"<p class='lab-address'>{escape(join_info.link)}</p><p>{then}</p>" \
           f"<p class='lab-class-code'>{escape(join_info.code)}</p><p class='lab-said'>{count}</p>{warning}</div>" \
           f"<figure role='img' aria-label='{tr('the link with the code, for phones')}'>{picture}</figure></div>"


def _step_html(board: ClassBoardState, place: ShownBoardStep, step: Step) -> str:
    title = escape(fill_numbers(step.title, board.numbers))
    head = f"<h2><span class='lab-kind lab-kind-{step.kind}'>{tr(TITLES[step.kind])}</span> {title}</h2>"
    if step.question is None:
        here, come = board.tally.present_count, board.tally.count_reached(place.at)
        following = board.step(board.next_position(place.at))
        onward = tr("Next: {kind}: {title}", kind=tr(TITLES[following.kind]),
                    title=fill_numbers(following.title, board.numbers)) if following else \
            tr("Next: the end, and how the class did")
        said = tr("{come} of {here} have come to this step", come=come, here=here) if here else tr(NOBODY)
        return f"{head}<div class='lab-waits'>{_meter_html(said, come, here)}<p>{escape(onward)}</p></div>"
    if place.question_phase == COUNTED:
        text, name = to_html(fill_numbers(step.text, board.numbers), catalogue.FOLDER), tr("the question")
        return f"{head}<div class='lab-asked' tabindex='0' role='region' aria-label='{name}'>{text}</div>" \
               f"{chart.answer_options(step.asked_question, board.numbers)}{_count_html(board, step, place.at)}"
    answers = board.tally.answers(step.key)
    came = board.computed_right_answer(step) if place.question_phase == REVEALED else None
    drawn = chart.answer_chart(step.asked_question, answers, board.numbers,
                               came if isinstance(came, RightAnswer) else None)
    after = board.tally.count_late(step.key)
    late = trn("{count} came later and is not counted.", "{count} came later and are not counted.",
               after) if after else ""
    return f"{head}<div class='lab-chart'>{drawn}</div><p class='lab-said' role='status'>" \
           f"{_count_text(step, len(answers))} {late} {_outcome_sentence(place, step, answers, came)}</p>"


def _count_html(board: ClassBoardState, step: Step, at: int) -> str:
    """Returns how many of a class have answered the step at ``at``, and how many have not come to it, as html."""
    tally = board.tally
    said, asked = len(tally.answers(step.key)), tally.count_present_or_answered(step.key)
    behind = tally.present_count - tally.count_reached(at)
    if not asked:
        told = tr(NOBODY)
    elif step.kind == PREDICT:
        told = trn("{count} of {asked} has predicted", "{count} of {asked} have predicted", said, asked=asked)
    else:
        told = trn("{count} of {asked} has answered", "{count} of {asked} have answered", said, asked=asked)
    late = trn("{count} of those who are here has not come to this step yet.",
               "{count} of those who are here have not come to this step yet.", behind)
    more = f"<p>{late}</p>" if behind else ""
    return f"<div class='lab-count'>{_meter_html(told, said, asked)}{more}</div>"


def _meter_html(sentence: str, part: int, whole: int) -> str:
    return f"<p class='lab-many' role='status'>{sentence}</p>" \
           f"<div class='lab-meter' aria-hidden='true'><i style='--part: {part / max(1, whole):.4f}'></i></div>"


def _count_text(step: Step, count: int) -> str:
    if step.asked_question.kind == INTERVAL:
        return trn("{count} interval.", "{count} intervals.", count) if count else tr("No interval was given.")
    return trn("{count} answer.", "{count} answers.", count) if count else tr("Nobody has answered.")


def _outcome_sentence(place: ShownBoardStep, step: Step, answers: list, result: RightAnswer | str | None) -> str:
    """Returns a sentence on a revealed result as html, or why there is none; "" before it is revealed."""
    if place.question_phase != REVEALED:
        return ""
    if result is None or isinstance(result, str):
        return tr(result or WORKING)
    count = chart.count_right_answers(step.asked_question, answers, result)
    if step.asked_question.kind == INTERVAL:
        told = tr("{right} of {of} contain the result ({level} % expected): {told}.", right=count,
                  of=len(answers), level=f"{100 * step.asked_question.level:g}", told=escape(result.text))
    elif step.asked_question.kind != CHOICE:
        told = trn("{count} of {of} was right: {told}.", "{count} of {of} were right: {told}.", count, of=len(answers),
                   told=escape(result.text))
    elif result.options:  # the bars show which
        told = trn("{count} of {of} was right.", "{count} of {of} were right.", count, of=len(answers))
    else:
        told = tr("There is no result for this step.")
    return f"<b>{told}</b>"


def _end_html(board: ClassBoardState) -> str:
    found = question_scores(board)
    intervals = [one for one in found if one.step.asked_question.kind == INTERVAL]
    rows = "".join(f"<li><span>{escape(fill_numbers(one.step.title, board.numbers))}</span>"
                   f"<i style='--part: {one.right / max(1, one.answers):.4f}'></i>"
                   f"<b>{tr(HELD if one in intervals else RIGHT, right=one.right, of=one.answers)}</b></li>"
                   for one in found)
    sums = "".join(f"<p class='lab-many'>{told}</p>" for told in score_sentences(found))
    none, name = tr("No question has been revealed."), tr("question by question")
    nothing = "" if found else f"<p class='lab-said'>{none}</p>"
    return f"<h2>{tr(HOW)}</h2><div class='lab-sums'>{sums}</div>{nothing}" \
           f"<ol class='lab-scores{' lab-in-two' * (len(found) > IN_ONE)}' tabindex='0' " \
           f"aria-label='{name}'>{rows}</ol>"


def score_sentences(scores: list[QuestionScore]) -> list[str]:
    """Returns a sentence each on a class's predictions, observations and intervals, with the share that is right."""
    said = []
    intervals = [one for one in scores if one.step.asked_question.kind == INTERVAL]
    for sentence, some in (
            (PREDICTIONS, [one for one in scores if one not in intervals and one.step.kind == PREDICT]),
            (OBSERVATIONS, [one for one in scores if one not in intervals and one.step.kind != PREDICT]),
            (INTERVALS, intervals)):
        right, of = sum(one.right for one in some), sum(one.answers for one in some)
        if of:
            level = sum(one.step.asked_question.level * one.answers for one in some) / of  # not shown for predictions
            said.append(tr(sentence, right=right, of=of, share=f"{100 * right / of:.0f}", level=f"{100 * level:.0f}"))
    return said
