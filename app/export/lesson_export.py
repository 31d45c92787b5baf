"""Lessons as data for the player, and as a SCORM 1.2 package: an archive with a page for each."""

import hashlib
import io
import math
import re
import sys
import zipfile
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from typing import Any
from urllib.parse import quote
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from app import shareable_state
from app.export import html_file, slider_grid
from app.export.html_file import SCRIPTS, ProgressCallback, assemble_page, record_plans, recorded_quantities
from app.export.stage_export_plan import StageExportPlan, make_export_plan
from app.frame.budget_chart_data import QUESTION
from app.language.translation import lazy, tr, use_language
from app.lessons import answer_marking, catalogue, interval_bet_chart, student_progress
from app.lessons.answer_marking import BARE, DIGITS, LONGEST, MOST, TOLD_AFTER, judge_ends, right_answer
from app.lessons.claims import ClaimError, runs_needed
from app.lessons.interval_bets import BY_ROUND, OWN, YOURS, earlier_bet_steps
from app.lessons.lesson import CHOICE, DRAG, NAMES, POWERS, REACH, TEXT, Lesson, Numbers, Question, Step, fill_numbers
from app.lessons.lesson_runs import RunCache, RunFailed
from app.lessons.markdown_html import to_html
from app.names_and_units import QUANTITIES, SYMBOLS

#: Number of values of each field beside those named in a lesson's text.
COUNTS = {"cells": 3, "amplitude": 3, "method": 3}
DENSE = (0.5, 0.7, 0.9, 1.2, 1.4, 1.5, 1.55, 1.6, 1.8, 2.0, 2.5, 3.0)  # times the scene's value, for a search
MOST_RUNS = 12  # of a stage's lattice
#: Controls that recordings lack, with their names in the file.
ELSEWHERE = {"slow-motion": lazy("slow motion"), "look-back": lazy("look back"), "trace": lazy("trace"),
             "effects": lazy("effects"), "details": lazy("details"), "pin": lazy("pin")}


def lesson_page(lesson: Lesson, processes: int, on_progress: ProgressCallback, counts: Mapping[str, int] = COUNTS,
                core: bool = False, scripts: Sequence[str] = SCRIPTS) -> str:
    """Returns the html of an offline page with a lesson; runs and records the scenes of its steps and answers.
    ``counts`` is the most values of each field on its slider; with ``core`` the page first offers the core alone."""
    plans = {  # by the key of a step with a stage and the number of the variant
        (step.key, number): _step_plan(lesson, step, fill_numbers(step.stage, numbers),
                                       fill_numbers(step.text, numbers), counts)
        for step in lesson.steps if step.stage for number, numbers in enumerate(lesson.variants)}
    right = marking_rules(lesson, processes, lambda part, what: on_progress(0.5 * part, what))
    once = list(dict.fromkeys(plans.values()))
    bets = bets_by_step(lesson, processes)
    recorded = record_plans(once, processes, lambda part, what: on_progress(0.5 + 0.5 * part, what))
    stages = {key: once.index(plan) for key, plan in plans.items()}
    return assemble_page(lesson.title, once, recorded, _lesson_to_json(lesson, right, stages, bets, core), scripts)


def _step_plan(lesson: Lesson, step: Step, stage: str, text: str, counts: Mapping[str, int]) -> StageExportPlan:
    """Returns the plan of a lesson's step. Its axes have the values in the step's instructions, those around a value to
    find by dragging and, up to ``MOST_RUNS`` runs, those of other controls.

    ``stage`` is the text of the step's state, ``text`` its Markdown, both with numbers filled in."""
    shown = shareable_state.parse_state(stage)
    kept = recorded_quantities(shown)
    with use_language(lesson.language):
        kept += tuple(key for key, quantity in QUANTITIES.items() if key not in kept and f"`{quantity}`" in text)
        scene = make_export_plan(shown, (), kept).scene
        axes = slider_grid.axes_for_instructions(scene, text)
    asks = [other.question for other in lesson.steps[lesson.steps.index(step) + 1:][:1]]
    sought = asks[0].control if asks and asks[0] and asks[0].kind == DRAG else ""  # the value to find on the stage
    if sought and sought not in {axis.field for axis in axes}:
        own = getattr(scene, sought) if sought != "cfl" else scene.courant_number
        values = [type(own)(float(f"{factor * own:.3g}")) for factor in DENSE]
        axes.append(slider_grid.axis_through(scene, sought, values, len(DENSE) + 1))
    for axis in slider_grid.axes_around(scene, counts):
        offered = not lesson.controls or axis.field in lesson.controls
        room = math.prod(len(other.values) for other in (*axes, axis)) <= MOST_RUNS
        if offered and room and axis.field not in {other.field for other in axes}:
            axes.append(axis)
    return make_export_plan(shown, axes, kept)


def marking_rules(lesson: Lesson, processes: int,
                  on_progress: Callable[[float, str], None]) -> dict[str, list[dict[str, Any] | None]]:
    """Returns how the player marks answers: by key of each step with a question a list with an entry per variant of the
    lesson's numbers (see :func:`_marking_rule`). Runs the scenes that the right answers need."""
    found = []  # the scenes of all runs in questions
    for step in lesson.questions.values():
        for numbers in lesson.variants:
            for expression in answer_marking.answer_expressions(step.asked_question, numbers):
                names = runs_needed(expression, lesson.runs, lesson.main_run(step)) - {""}
                found += [fill_numbers(text, numbers) for name in names for text in lesson.runs[name].texts]
    with closing(RunCache(processes)) as outcomes:
        outcomes.prepare(found, lambda done, total: on_progress(done / total, f"answer {done} of {total}"))
        return {step.key: [_marking_rule(lesson, step, numbers, outcomes) for numbers in lesson.variants]
                for step in lesson.questions.values()}


def _marking_rule(lesson: Lesson, step: Step, numbers: Numbers, outcomes: RunCache) -> dict[str, Any] | None:
    """Returns how the player marks an answer, for one variant's ``numbers``: the right ``options``, counted from 1, or
    the ``value`` and relative ``tolerance``, and the right answer in words (``told``); None if its runs fail."""
    asked = step.question
    assert asked is not None
    if asked.kind == TEXT:
        return {"told": ""}
    try:
        found = right_answer(lesson, step, numbers, outcomes)
    except (ClaimError, RunFailed):
        return None
    if asked.kind == CHOICE:
        return {"options": list(found.options), "told": found.text}
    return {"value": found.value, "tolerance": asked.tolerance, "told": found.text}


def _lesson_to_json(lesson: Lesson, right: Mapping[str, list[Any]], stages: Mapping[tuple[str, int], int],
                    bets: Mapping[str, list[Any]], core: bool) -> dict[str, Any]:
    """Returns a lesson as a JSON object for the player. Texts are lists with an entry per variant, or one if all agree.

    ``right`` is from :func:`marking_rules`, ``bets`` from :func:`bets_by_step`; ``stages`` maps (step's key, index of
    the variant) to the index of the stage in the file; with ``core`` the page first offers the core alone."""
    def each(text: str) -> list[str]:
        return _collapse_if_equal([to_html(fill_numbers(text, numbers), catalogue.FOLDER)
                                   for numbers in lesson.variants])

    known = catalogue.load_lessons()
    # A name's variant is drawn as in ``app.lessons.lesson``: with Unicode case folding and white space.
    letters = [chr(code) for code in range(sys.maxunicode + 1) if not 0xD800 <= code < 0xE000]
    steps = [{"kind": step.kind, "key": step.key, "core": step.core, "html": each(step.text),
              "title": _collapse_if_equal([fill_numbers(step.title, numbers) for numbers in lesson.variants]),
              "stage": [stages[step.key, k] for k in range(len(lesson.variants))] if step.stage else None,
              "bets": step.bets, "judged": _collapse_if_equal(bets.get(step.key, [{}])),
              "question": _question_to_json(lesson, step.question, right.get(step.key, []))} for step in lesson.steps]
    with use_language(lesson.language):
        asks = tr(QUESTION)
    return {"name": lesson.name, "title": lesson.title, "minutes": lesson.minutes, "core_minutes": lesson.core_minutes,
            "begins_core": core and bool(lesson.optional_steps), "goals": lesson.goals,
            "needs": [known[name].title if name in known else name for name in lesson.prerequisites],
            "fingerprint": lesson.fingerprint, "variants": len(lesson.variants), "intro": each(lesson.intro),
            "elsewhere": [tr(name) for control, name in ELSEWHERE.items() if control in lesson.controls],
            "language": lesson.language, "asks": asks, "steps": steps,
            "schema": student_progress.SCHEMA, "longest_name": student_progress.LONGEST_NAME, "longest": LONGEST,
            "most": MOST, "bare": BARE, "digits": DIGITS, "told_after": TOLD_AFTER, "bets": bet_chart_texts(),
            "fold": {letter: letter.casefold() for letter in letters if letter.casefold() != letter.lower()},
            "spaces": "".join(letter for letter in letters if letter.isspace())}


def _collapse_if_equal(each: Sequence[Any]) -> list[Any]:
    """Returns the values as a list, with only the first if all are equal."""
    return list(each[:1] if all(one == each[0] for one in each) else each)


def _question_to_json(lesson: Lesson, asked: Question | None, right: list[Any]) -> dict[str, Any] | None:
    if asked is None:
        return None
    options = _collapse_if_equal([[fill_numbers(option, numbers) for option in asked.options]
                                  for numbers in lesson.variants])
    made: dict[str, Any] = {"kind": asked.kind, "options": options, "unit": asked.unit, "rules": right,
                            "level": asked.level}
    if asked.kind == DRAG:
        low, high, step = REACH[asked.control]
        made["drag"] = {"name": f"{tr(NAMES[asked.control])} {SYMBOLS.get(asked.control, '')}".strip(), "low": low,
                        "high": high, "step": step, "powers": asked.control in POWERS}
    return made


def bet_chart_texts() -> dict[str, Any]:
    """Returns texts, names of bettors and the limit in powers of ten of the chart of bets, as a JSON object."""
    return {"yours": YOURS, "by_round": BY_ROUND, "your_bets": tr(interval_bet_chart.YOUR_BETS),
            "round": tr(interval_bet_chart.ROUND), "told": tr(interval_bet_chart.TOLD),
            "some": tr(interval_bet_chart.SOME), "none": tr(interval_bet_chart.NONE),
            "scored": tr(interval_bet_chart.SCORED), "said": tr(interval_bet_chart.SAID),
            "truth": tr(interval_bet_chart.TRUTH), "less": interval_bet_chart.LESS, "more": interval_bet_chart.MORE,
            "most": interval_bet_chart.MOST}


def bets_by_step(lesson: Lesson, processes: int) -> dict[str, list[dict[str, dict[str, Any]]]]:
    """Returns the judges' bets that a lesson shows: by key of the step that shows them a list with an entry per
    variant, which maps judge and key of the step that asked to (low, high), or None for no bet. Runs their scenes."""
    steps = [step for step in lesson.steps if set(step.bets) - {*OWN}]
    with closing(RunCache(processes)) as outcomes:
        return {step.key: [{judge: {other.key: judge_ends(lesson, other, judge, numbers, outcomes)
                                    for other in earlier_bet_steps(lesson, step)}
                            for judge in step.bets if judge not in OWN} for numbers in lesson.variants]
                for step in steps}


SPACES = {"xmlns": "http://www.imsproject.org/xsd/imscp_rootv1p1p2",
          "xmlns:adlcp": "http://www.adlnet.org/xsd/adlcp_rootv1p2"}
LONGEST_TITLE = 200  # letters of a title that every system accepts
WRITTEN = (1980, 1, 1, 0, 0, 0)  # fixed time in the archive, so that equal lessons have equal bytes


def make_scorm_package(lessons: Sequence[Lesson], processes: int, on_progress: ProgressCallback,
                       counts: Mapping[str, int] = COUNTS, core: bool = False) -> bytes:
    """Returns a SCORM 1.2 package (zip) of lessons that are scored separately; arguments as :func:`lesson_page`."""
    pages = {}
    for number, lesson in enumerate(lessons):
        def so_far(part: float, what: str, number: int = number) -> None:
            on_progress((number + part) / len(lessons), what)

        pages[_page_file_name(lesson)] = lesson_page(lesson, processes, so_far, counts, core, html_file.IN_A_COURSE)
    return _zip_archive({"imsmanifest.xml": scorm_manifest(lessons), **pages})


def scorm_manifest(lessons: Sequence[Lesson]) -> str:
    """Returns the XML of a SCORM package's manifest. Identifiers contain fingerprints: a changed lesson is another."""
    keys = [_scorm_identifier(lesson) for lesson in lessons]
    whole = keys[0] if len(keys) == 1 else hashlib.sha256(" ".join(keys).encode()).hexdigest()[:24]
    root = Element("manifest", {"identifier": f"mpm-lab-{whole}", "version": "1.0", **SPACES})
    metadata = SubElement(root, "metadata")
    SubElement(metadata, "schema").text = "ADL SCORM"
    SubElement(metadata, "schemaversion").text = "1.2"
    organizations = SubElement(root, "organizations", {"default": "lessons"})
    organization = SubElement(organizations, "organization", {"identifier": "lessons"})
    SubElement(organization, "title").text = _xml_safe_title(lessons[0]) if len(lessons) == 1 else "mpm-lab"
    resources = SubElement(root, "resources")
    for lesson in lessons:
        key = _scorm_identifier(lesson)
        item = SubElement(organization, "item", {"identifier": f"item-{key}", "identifierref": f"page-{key}"})
        SubElement(item, "title").text = _xml_safe_title(lesson)
        resource = SubElement(resources, "resource", {"identifier": f"page-{key}", "type": "webcontent",
                                                      "adlcp:scormtype": "sco", "href": quote(_page_file_name(lesson))})
        SubElement(resource, "file", {"href": quote(_page_file_name(lesson))})
    indent(root)
    return tostring(root, encoding="unicode", xml_declaration=True).replace("'", '"', 4) + "\n"


def _scorm_identifier(lesson: Lesson) -> str:
    return re.sub(r"[^\w.-]", "-", f"{lesson.name}-{lesson.fingerprint[:12]}")


def _xml_safe_title(lesson: Lesson) -> str:
    """Returns a lesson's title without unprintable characters, which XML forbids, of at most ``LONGEST_TITLE``."""
    return "".join(letter for letter in lesson.title if letter.isprintable())[:LONGEST_TITLE]


def _page_file_name(lesson: Lesson) -> str:
    return f"{lesson.name}.html"


def _zip_archive(texts: Mapping[str, str]) -> bytes:
    """Returns a zip archive of texts by their file names; equal texts give equal bytes."""
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in texts.items():
            entry = zipfile.ZipInfo(name, WRITTEN)
            entry.compress_type, entry.external_attr = zipfile.ZIP_DEFLATED, 0o644 << 16
            archive.writestr(entry, text.encode())
    return made.getvalue()
