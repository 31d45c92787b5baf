"""Estimated duration of lessons, by one rule for all. A step takes the sum of

* **reading**: its title, text and options at 180 words a minute. Plain prose is read at some 240; this is denser, and
  often in a foreign language. A word is what stands between spaces, in a table too; a piece of code is one word, a
  formula within a line three, as it is spoken.
* **looking**: 20 s for a formula on lines of its own, 30 s for a figure.
* **answering**, beyond reading the question. A prediction takes a minute for a choice or a control, two for a number,
  which is computed on paper, and a minute and a half for an interval. An observation is only reported: half a minute
  for a choice or a control, a minute for a number or an interval, which is looked up, perhaps divided, typed and
  corrected. Free text takes two minutes.
* **comparing**: 10 s for each answer that an explanation shows beside the result.
* **doing**: 10 s for each instruction in the text, to find and use the widget.
* **watching**: what the stage plays: its periods over its speed if it stops, and 10 s to look at the end; once for each
  time that it is put there, and once more for each instruction that changes its scene. A run without end is watched for
  half a minute. A text may ask for more: ``Take **5 minutes**``.
* **turning the page**: 5 s.

Compilation, discussion and optional actions are not counted. The rule is an estimate, not measured on students."""

import re
from collections.abc import Sequence
from dataclasses import replace

from app import shareable_state
from app.language.translation import tr
from app.lessons.lesson import CHOICE, DRAG, EXPLAIN, INTERVAL, NUMBER, PREDICT, RUN, TEXT, Lesson, Step, fill_numbers
from app.lessons.prediction_rounds_and_core import split_rounds

WORDS_A_MINUTE = 180
SPOKEN = 3  # words of a formula within a line
FORMULA_SECONDS, FIGURE_SECONDS = 20, 30
PREDICTING = {CHOICE: 60, DRAG: 60, NUMBER: 120, INTERVAL: 90, TEXT: 120}
TELLING = {CHOICE: 30, DRAG: 30, NUMBER: 60, INTERVAL: 60, TEXT: 120}
COMPARING_SECONDS, ACT_SECONDS, TURN_SECONDS = 10, 10, 5
STOPPED_SECONDS = 10  # to look at where a run has stopped
ENDLESS_SECONDS = 30  # to watch a run without end
SPEED = 0.5  # default periods per second

FIGURE = re.compile(r"!\[[^\]]*\]\([^)]*\)")
FORMULA = re.compile(r"\$\$.+?\$\$", re.DOTALL)
INLINE, CODE = re.compile(r"\$[^$]+\$"), re.compile(r"`[^`]+`")
WORD = re.compile(r"\S*\w\S*")
ACT = re.compile(r"^\s*[-*] (Press|Set|Choose|Tick|Untick|Open) \*\*(.+?)\*\*", re.MULTILINE)
TAKE = re.compile(r"\bTake \*\*(\d+) minutes?\*\*")
#: Controls that change the scene, so that a run that stops plays again.
CHANGES = ("Cells", "Particles / cell", "Amplitude A", "Modulus E", "CFL number", "Method", "Body force", "Reset")
STAGE = "On the stage"


def with_minutes(lesson: Lesson) -> Lesson:
    """Returns a copy of the lesson with ``minutes``, of all steps, and ``core_minutes`` set."""
    opening = _reading_seconds(" ".join((lesson.intro, *lesson.goals))) + TURN_SECONDS
    return replace(lesson, minutes=whole_minutes(opening + seconds_of_rounds(lesson.steps, lesson)),
                   core_minutes=whole_minutes(opening + seconds_of_rounds(lesson.steps_to_take(core=True), lesson)))


def minutes_text(lesson: Lesson) -> str:
    """Returns a lesson's minutes in the current language: "25 min", or "15 min core, 25 min in all"."""
    if not lesson.optional_steps:
        return tr("{minutes} min", minutes=lesson.minutes)
    return tr("{core} min core, {minutes} min in all", core=lesson.core_minutes, minutes=lesson.minutes)


def seconds_of_rounds(steps: Sequence[Step], lesson: Lesson) -> float:
    """Returns the seconds that some steps of a lesson take: complete rounds, with the first variant's numbers."""
    compared = sum(step.question is not None for one in split_rounds(steps) if one[-1].kind == EXPLAIN for step in one)
    seconds = 0.0
    for step in steps:
        asked = step.question
        answering = 0 if asked is None else (PREDICTING if step.kind == PREDICT else TELLING)[asked.kind]
        seconds += _reading_seconds(" ".join((step.title, step.text, *(asked.options if asked else ())))) + answering \
            + _running_seconds(step, lesson) + TURN_SECONDS
    return compared * COMPARING_SECONDS + seconds


def whole_minutes(seconds: float) -> int:
    """Rounds seconds to minutes, at least 1."""
    return max(1, round(seconds / 60))


def _reading_seconds(text: str) -> float:
    """Returns the seconds to read a Markdown text and look at its formulas and figures."""
    figures, formulas = len(FIGURE.findall(text)), len(FORMULA.findall(text))
    plain = CODE.sub(" x ", INLINE.sub(" x" * SPOKEN + " ", FORMULA.sub(" ", FIGURE.sub(" ", text))))
    return len(WORD.findall(plain)) * 60 / WORDS_A_MINUTE + figures * FIGURE_SECONDS + formulas * FORMULA_SECONDS


def _running_seconds(step: Step, lesson: Lesson) -> float:
    """Returns the seconds to carry out the instructions in a step's text, and to watch the runs on the stage."""
    acts = ACT.findall(step.text)[:1 if step.shown_phase else None]  # one button does them all
    taken = 60 * sum(map(int, TAKE.findall(step.text)))
    put = any(name == STAGE for verb, name in acts if verb == "Press") or step.kind == RUN
    seconds = len(acts) * ACT_SECONDS + taken
    if not step.stage or not put:
        return seconds
    shown = shareable_state.parse_state(fill_numbers(step.stage, lesson.variants[0]))
    if not shown.stops:
        return seconds + ENDLESS_SECONDS
    runs, scene = 1 + sum(name in CHANGES for _, name in acts), shown.scene
    return seconds + runs * (scene.end_time / scene.period / (shown.speed or SPEED) + STOPPED_SECONDS)
