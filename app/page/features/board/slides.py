"""What the board shows, as html: the beginning, a step, the end. Every number is counted when it is shown."""

from dataclasses import dataclass
from html import escape
from urllib.parse import quote

import segno

from app.lessons import shelf
from app.lessons.lesson import CHOICE, INTERVAL, PREDICT, Step, filled
from app.lessons.marks import Right
from app.lessons.markup import html
from app.page.features.board import chart
from app.page.features.board.board import COUNTED, REVEALED, Board, Place, has_chart

IN_ONE = 8  # scores, in one column
NOBODY, WORKING = "Nobody is here yet.", "What came out is being worked out …"


@dataclass(frozen=True)
class Door:
    """By which a class comes in: its ``link`` without the code, the ``code``, a ``warning`` where nobody else can."""

    link: str
    code: str
    warning: str = ""

    @property
    def whole(self) -> str:
        """The link that brings the code along."""
        return f"{self.link}#code={quote(self.code)}"


@dataclass(frozen=True)
class Scored:
    """A question that has been revealed: of how many answers how many are right, or hold what came out."""

    step: Step
    right: int
    answers: int


def slide(board: Board, place: Place, door: Door) -> str:
    """All of a place but its buttons."""
    step = board.step(place.at)
    where = f"step {board.number(place.at)} of {board.total}" if step else \
        "the beginning" if place.at == 0 else "the end"
    now = f"you look back; the class is at step {board.number(place.opened)}"
    past = "" if place.now else f"<b class='lab-looks-back'>{now}</b>"
    count = f"<span>{_here(board.tally.here)}</span>" if place.at else ""  # at the beginning it is said below
    top = f"<header><span>{where}</span>{past}{count}</header>"
    body = _step(board, place, step) if step else _beginning(board, door) if place.at == 0 else _end(board)
    return f"{top}{body}"


def says_next(board: Board, place: Place) -> str:
    """What the next press does; "" where there is nothing more."""
    step, following = board.step(place.at), board.after(place.at)
    if not place.now:
        return "Show how the class did" if following == board.end else f"Go forward to step {board.number(following)}"
    if step and has_chart(step) and place.stage < REVEALED:
        return "Show the answers" if place.stage == COUNTED else "Reveal what came out"
    if following < board.end:
        return f"Open step {board.number(following)} for all"
    return "Show how the class did" if place.at < board.end else ""


def scores(board: Board) -> list[Scored]:
    """Of the questions whose outcome has been revealed."""
    found = []
    for at, step in enumerate(board.lesson.steps, 1):
        came = board.came_out(step)
        if board.stage(at) == REVEALED and isinstance(came, Right):
            answers = board.tally.answers(step.key)
            found.append(Scored(step, chart.right_among(step.asked, answers, came), len(answers)))
    return found


def _here(count: int) -> str:
    return "nobody is here" if count == 0 else "1 is here" if count == 1 else f"{count} are here"


def _beginning(board: Board, door: Door) -> str:
    picture = segno.make(door.whole, error="l", micro=False).svg_inline(border=2, omitsize=True)
    warning = f"<p class='lab-warns'>{escape(door.warning)}</p>" if door.warning else ""
    here = board.tally.here
    count = NOBODY if here == 0 else "1 is here." if here == 1 else f"{here} are here."
    return f"<h2>{escape(board.lesson.title)}</h2><div class='lab-door'><div><p>Open</p>" \
           f"<p class='lab-address'>{escape(door.link)}</p><p>and type the class code</p>" \
           f"<p class='lab-class-code'>{escape(door.code)}</p><p class='lab-said'>{count}</p>{warning}</div>" \
           f"<figure role='img' aria-label='the link with the code, for phones'>{picture}</figure></div>"


def _step(board: Board, place: Place, step: Step) -> str:
    title = escape(filled(step.title, board.numbers))
    head = f"<h2><span class='lab-kind lab-kind-{step.kind}'>{step.kind.capitalize()}</span> {title}</h2>"
    if step.question is None:
        return head + _without_question(board, place)
    if place.stage == COUNTED:
        text = html(filled(step.text, board.numbers), shelf.FOLDER)
        return f"{head}<div class='lab-asked' tabindex='0' role='region' aria-label='the question'>{text}</div>" \
               f"{chart.options(step.asked, board.numbers)}{_counted(board, step, place.at)}"
    answers = board.tally.answers(step.key)
    came = board.came_out(step) if place.stage == REVEALED else None
    drawn = chart.chart(step.asked, answers, board.numbers, came if isinstance(came, Right) else None)
    return f"{head}<div class='lab-chart'>{drawn}</div><p class='lab-said' role='status'>" \
           f"{_said(step, len(answers))} {_late(board, step)} {_outcome(place, step, answers, came)}</p>"


def _without_question(board: Board, place: Place) -> str:
    here, come = board.tally.here, board.tally.reached(place.at)
    following = board.step(board.after(place.at))
    onward = f"Next: {following.kind.capitalize()}: {filled(following.title, board.numbers)}" if following else \
        "Next: the end, and how the class did"
    said = NOBODY if here == 0 else f"{come} of {here} have come to this step"
    return f"<div class='lab-waits'>{_meter(said, come, here)}<p>{escape(onward)}</p></div>"


def _counted(board: Board, step: Step, at: int) -> str:
    tally = board.tally
    said, asked = len(tally.answers(step.key)), tally.asked(step.key)
    behind = tally.here - tally.reached(at)
    if not asked:
        told = NOBODY
    elif step.kind == PREDICT:
        told = f"{said} of {asked} {'has' if said == 1 else 'have'} predicted"
    else:
        told = f"{said} of {asked} {'has' if said == 1 else 'have'} answered"
    more = f"<p>{behind} of those who are here {'has' if behind == 1 else 'have'} not come to this step yet.</p>"
    return f"<div class='lab-count'>{_meter(told, said, asked)}{more if behind else ''}</div>"


def _meter(told: str, part: int, whole: int) -> str:
    return f"<p class='lab-many' role='status'>{told}</p>" \
           f"<div class='lab-meter' aria-hidden='true'><i style='--part: {part / max(1, whole):.4f}'></i></div>"


def _said(step: Step, count: int) -> str:
    if step.asked.kind == INTERVAL:
        return "No interval was given." if count == 0 else "1 interval." if count == 1 else f"{count} intervals."
    return "Nobody has answered." if count == 0 else "1 answer." if count == 1 else f"{count} answers."


def _late(board: Board, step: Step) -> str:
    late = board.tally.late(step.key)
    return "" if late == 0 else "1 came later and is not counted." if late == 1 else \
        f"{late} came later and are not counted."


def _outcome(place: Place, step: Step, answers: list, came: Right | str | None) -> str:
    """What is said of what came out, when that is asked for."""
    if place.stage != REVEALED:
        return ""
    if came is None or isinstance(came, str):
        return came or WORKING
    count = chart.right_among(step.asked, answers, came)
    if step.asked.kind == INTERVAL:
        return f"<b>{count} of {len(answers)} hold what came out: {escape(came.told)}.</b>"
    told = f"{count} of {len(answers)} {'was' if count == 1 else 'were'} right"
    if step.asked.kind == CHOICE:  # the bars say which
        return f"<b>{told}.</b>" if came.options else "<b>Nothing of this came out.</b>"
    return f"<b>{told}: {escape(came.told)}.</b>"


def _end(board: Board) -> str:
    found = scores(board)
    rows = "".join(f"<li><span>{escape(filled(one.step.title, board.numbers))}</span>"
                   f"<i style='--part: {one.right / max(1, one.answers):.4f}'></i>"
                   f"<b>{one.right} of {one.answers} {'held' if one.step.asked.kind == INTERVAL else 'right'}</b></li>"
                   for one in found)
    sums = "".join(f"<p class='lab-many'>{told}</p>" for told in calibration(found))
    nothing = "" if found else "<p class='lab-said'>No question has been revealed.</p>"
    return f"<h2>How the class did</h2><div class='lab-sums'>{sums}</div>{nothing}" \
           f"<ol class='lab-scores{' lab-in-two' * (len(found) > IN_ONE)}' tabindex='0' " \
           f"aria-label='question by question'>{rows}</ol>"


def calibration(found: list[Scored]) -> list[str]:
    """How well a class has known what it knows: predictions, observations and intervals, a sentence each."""
    def share(some: list[Scored]) -> tuple[int, int]:
        return sum(one.right for one in some), sum(one.answers for one in some)

    said = []
    intervals = [one for one in found if one.step.asked.kind == INTERVAL]
    for name, kind in (("predictions", True), ("observations", False)):
        right, of = share([one for one in found if one not in intervals and (one.step.kind == PREDICT) == kind])
        if of:
            said.append(f"{right} of {of} {name} were right: {100 * right / of:.0f} %")
    held, of = share(intervals)
    if of:
        said.append(f"{held} of {of} intervals hold what came out: {100 * held / of:.0f} %")
    return said
