"""Exported files in a real browser, from disk and without a network: sliders, a lesson to its hand-in, and names."""

from contextlib import ExitStack, closing, contextmanager

import numpy as np
import pytest

from app import names_and_units, shareable_state
from app.colour_palette import TRUTH
from app.export.body_page import body_page
from app.export.html_file import recorded_quantities, scene_page
from app.export.lesson_export import lesson_page
from app.export.recording import record_scene
from app.frame.budget_chart_data import CAPTION, format_percent
from app.frame.error_view_captions import (
    field_plot_caption,
    make_captions,
    not_estimated_text,
    why_no_estimate,
    why_no_truth,
)
from app.lessons import student_progress
from app.lessons.answer_marking import mark_answer
from app.lessons.lesson import draw_numbers
from app.lessons.lesson_parser import parse_lesson
from app.lessons.lesson_runs import RunCache
from app.problems.views import VIEWS
from solvers.bodies.body_file import library_text
from solvers.scene.error_causes import CAUSES
from tests.app.lessons.test_lesson_format import TEXT
from tests.browser import driving
from tests.browser.conftest import SIZE, no_errors
from tests.browser.courses import walked

ATTACK = "<img src=x onerror=alert(1)>"
NAMES = ["Ada", "  ada  ", "Straße", "STRASSE", "ΟΔΥΣΣΕΥΣ", "İpek", "ﬁne", "李小龍", "e\u0301mile", "a\u00a0b"]
MORE = r"""
## Observe: In words

```question
kind = "text"
```

## Explain: The end of it

$\text{<img/src/onerror=document.title='stolen'>}$ and $\text{<script>document.title='stolen'</script>}$
"""


def silent(part, what):
    """Nobody looks at the progress."""


#: Keeps what the player draws: texts, and lines with their colour, width and points.
WATCH = """
const pens = CanvasRenderingContext2D.prototype, {fillText, beginPath, moveTo, lineTo, stroke} = pens;
let path = [];
window.drawn = {texts: [], lines: []};
pens.fillText = function(text, ...at) { drawn.texts.push(text); fillText.call(this, text, ...at); };
pens.beginPath = function() { path = []; beginPath.call(this); };
pens.moveTo = function(...at) { path.push(at); moveTo.apply(this, at); };
pens.lineTo = function(...at) { path.push(at); lineTo.apply(this, at); };
pens.stroke = function() { drawn.lines.push([this.strokeStyle, this.lineWidth, path]); stroke.call(this); };
"""
#: Of the shares of the causes.
BOTTOM = "document.getElementById('causes').getBoundingClientRect().bottom"


@contextmanager
def opened(chromium, path):
    """A file from disk, in a browser that is offline; any error fails the test."""
    context = chromium.new_context(viewport=SIZE, offline=True, accept_downloads=True, reduced_motion="reduce")
    context.add_init_script(WATCH)
    page, asked = context.new_page(), []
    page.on("request", lambda request: asked.append(request.url))
    with no_errors(page), closing(context):
        page.goto(path.as_uri())
        yield page
    assert [url for url in asked if not url.startswith(("file:", "data:", "blob:"))] == []


@pytest.fixture
def play(chromium, tmp_path):
    """Plays a scene's file, with sliders, perhaps, to the end of its run; returns the page."""
    with ExitStack() as stack:
        def played(text, **sliders):
            path = tmp_path / "scene.html"
            path.write_text(scene_page(text, 1, silent, sliders), encoding="utf-8")
            page = stack.enter_context(opened(chromium, path))
            page.get_by_label("Time", exact=True).press("End")
            page.locator("#play", has_text="Again").wait_for()
            return page

        yield played


@pytest.fixture(scope="module")
def lesson():
    return parse_lesson(TEXT.replace("## Predict", "## Predict (core)") + MORE, "99-test")


@pytest.fixture(scope="module", autouse=True)
def recorded_here():
    """Recordings are made by this process, which a process of their own would take seconds to start for."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("app.export.html_file.record_scenes",
                      lambda wanted, *others: [record_scene(one) for one in wanted])
        yield


@pytest.fixture(scope="module")
def lesson_file(lesson, tmp_path_factory):
    """The lesson's file, and what came of its runs."""
    path = tmp_path_factory.mktemp("export") / "lesson.html"
    with closing(RunCache()) as outcomes, pytest.MonkeyPatch.context() as patch:
        patch.setattr("app.export.lesson_export.RunCache", lambda processes: outcomes)
        patch.setattr(outcomes, "close", lambda: None)
        path.write_text(lesson_page(lesson, 1, silent, {}), encoding="utf-8")
        patch.undo()
        yield path, outcomes


def norm(page):
    return page.locator("#norms tr", has_text="true").locator("td").first.inner_text()


def test_a_body_shows_its_estimate_and_its_goal(chromium, tmp_path):
    """Particles in colours of the scale, tables, the verdict, and the curve of the goal in its band."""
    file, path = tmp_path / "sector.toml", tmp_path / "sector.html"
    file.write_text(library_text("swinging_sector").replace("cells_per_metre = 16", "cells_per_metre = 8"))
    path.write_text(body_page(str(file), lambda part: None), encoding="utf-8")
    with opened(chromium, path) as page:
        before = page.locator("#stage").screenshot()
        page.get_by_label("Time", exact=True).press("End")
        page.locator("#play", has_text="Again").wait_for()
        assert page.locator("#summary").inner_text().startswith("End: (0, −0.75) sinks to y = ")
        assert page.locator("#stage").screenshot() != before
        texts = page.evaluate("drawn.texts")
        assert {"Estimate", "sector.toml: CPDI 8 cells a metre, 2 × 2 a cell", "end: y and its bar"} <= set(texts)
        assert page.locator("#facts tr").nth(1).inner_text().startswith("end")
        page.get_by_label("Error of").select_option(label="stress σ")
        page.wait_for_function("drawn.texts.some((text) => text.endsWith('kPa'))")


@pytest.mark.short
def test_a_slider_shows_another_run(play):
    page = play("bar cells=10 periods=0.25", cells=2)
    cells, before, drawn_before = page.get_by_label("Cells"), norm(page), page.locator("#stage").screenshot()
    first = page.locator("#title").inner_text()
    cells.press("ArrowRight" if cells.input_value() == "0" else "ArrowLeft")
    driving.until(lambda: page.locator("#title").inner_text() != first, "another run's title")
    assert norm(page) != before and page.locator("#stage").screenshot() != drawn_before
    page.get_by_role("combobox", name="Error of").select_option(label="stress σ")
    assert norm(page).endswith("Pa")
    page.get_by_role("button", name="Again").click()
    page.locator("#play", has_text="Pause").wait_for()


def look(page, choices):
    """Look at something else by some of the choices; returns the texts that are drawn, and the lines."""
    page.evaluate("window.drawn = {texts: [], lines: []}")
    for name, label in choices.items():
        page.get_by_role("combobox", name=name).select_option(label=label)
    found = page.evaluate("window.drawn")
    return " ".join(found["texts"]), found["lines"]


FILES = {"bar": "bar cells=10 periods=0.25;difference", "ring": "ring cells=12 periods=0.1 cfl=0.3",
         "an effect off": "bar cells=10 periods=0.25 effects=truth,estimate;error-of=a"}


@pytest.mark.parametrize("name", FILES)
def test_whatever_is_looked_at_is_said_as_on_the_page(play, name):
    """Titles, captions, notes and reasons for silence, of every quantity by every estimator."""
    text = f"{FILES[name]};estimators=companion,transport"
    scene, apart = shareable_state.parse_state(text).scene, shareable_state.parse_state(text).difference
    stage, page = VIEWS[scene.problem].stage, play(text)
    assert page.locator("h1").inner_text() == scene.title.capitalize()
    for key in recorded_quantities(shareable_state.parse_state(text)):
        no_truth = why_no_truth(scene, key)
        for estimator, magnified in zip(scene.estimators, names_and_units.MAGNIFICATIONS[1:], strict=False):
            drawn, _ = look(page, {"Error of": str(names_and_units.QUANTITIES[key]), "On the stage": estimator,
                                   **({"Magnify error": f"× {magnified}"} if scene.DIMENSIONS == 1 else {})})
            no_estimate = why_no_estimate(scene, scene.not_valid, estimator, key)
            row = page.locator("#norms tr").filter(has=page.get_by_role("rowheader", name=estimator)).inner_text()
            if not no_estimate and row.endswith(not_estimated_text(key)):
                no_estimate = f"{estimator} {not_estimated_text(key)}"
            said = make_captions(key, estimator, apart, no_estimate, no_truth)
            plot: tuple[str, ...] = (*said.by, *stage.PLOT.ends) if scene.DIMENSIONS > 1 else (
                field_plot_caption(scene, key).name, field_plot_caption(scene, key).remark)
            for part in (*said.titles, *said.silences, stage.scale_note(scene), stage.MARKED, *plot,
                         str(names_and_units.QUANTITIES[key])):
                assert part in drawn, (key, estimator)
            seen = page.locator("#summary").inner_text()
            capital = no_truth[:1].upper() + no_truth[1:]  # it may begin a sentence
            assert scene.swings is False or (names_and_units.short_reason(no_estimate) in seen and capital in seen)


def test_a_vortex_has_its_exact_lines(play):
    text = "vortex cells=12 periods=0.05 estimators=none"
    scene, stage = shareable_state.parse_state(text).scene, VIEWS["vortex"].stage
    drawn, lines = look(play(text), {"Colours": "logarithmic"})
    spokes = np.array([points for colour, width, points in lines if (colour, width) == (TRUTH.lower(), 1.5)])
    exact = stage.exact_material_lines(scene, scene.steps * scene.time_step, stage.LINES)[:, ::2] * (1, -1)
    assert spokes.shape == exact.shape and "blue: exact lines" in drawn
    middle = spokes[:, 0].mean(axis=0)
    metre = np.linalg.norm(spokes[0, 0] - middle) / np.linalg.norm(exact[0, 0])
    assert np.abs((spokes - middle) / metre - exact).max() < 1e-3
    assert np.abs(exact - stage.exact_material_lines(scene, 0.0, stage.LINES)[:, ::2] * (1, -1)).max() > 0.05


def test_a_patch_test_that_is_passed_says_so(play):
    page = play("bar motion=patch cells=10 modulus=1000 periods=0.5 estimators=companion,transport")
    assert "nothing happens, as expected" in page.locator("#summary").inner_text()
    assert page.locator("#title").inner_text().startswith("Patch test of the bar: ")
    assert "not valid here: " in page.locator("#norms .silent", has_text="transport").inner_text()


def test_a_run_gone_bad_says_so(play):
    page = play("vortex cells=12 cfl=5 periods=1")
    assert page.locator("#summary").inner_text().endswith(" This is its last picture.")
    assert page.locator("#status").inner_text().startswith("The run went unstable")


def test_a_lesson_is_played_to_its_hand_in(chromium, lesson, lesson_file, tmp_path):
    path, outcomes = lesson_file
    numbers = draw_numbers(lesson, "Ada")
    right = mark_answer(lesson, lesson.steps[2], 0.0, numbers, outcomes).expected.partition(" (")[0]
    with opened(chromium, path) as page:
        onward, check = (page.get_by_role("button", name=name) for name in ("Next", "Check my answer"))
        page.get_by_label("Your name").fill("Ada")
        onward.click()
        assert onward.is_disabled() and not page.locator("button.stage").count()
        page.get_by_label("something").check()
        page.get_by_role("button", name="Record my prediction").click()
        assert page.get_by_label("nothing").is_disabled()  # what one has predicted stays
        page.reload()
        assert "Step 1 of 6" in page.locator("#where").inner_text()
        onward.click()
        page.get_by_role("button", name="On the stage").click()
        page.locator("#title", has_text="8 cells").wait_for()
        onward.click()
        for answer, told in (("1,5", "not so"), ("2 km", "not so"), (right, "right")):
            page.get_by_label("Answer, m").fill(answer)
            check.click()
            assert told in page.locator(".recorded").inner_text()
        onward.click()
        rows = page.locator(".compared tr").all_inner_texts()
        assert "something\tsomething\t✓ right" in rows[1] and "1.5 m" in rows[2] and "not so" in rows[2]
        onward.click()
        page.get_by_label("Answer").fill(ATTACK)
        check.click()
        onward.click()
        assert page.locator("#lesson mtext").first.text_content() == "<img/src/onerror=document.title='stolen'>"
        assert page.title() == lesson.title and not page.locator("#lesson img, #lesson script").count()
        onward.click()
        assert page.locator(".compared").get_by_text(ATTACK).count() == 1
        with page.expect_download() as download:
            page.get_by_role("button", name="Hand in").click()
        download.value.save_as(tmp_path / "answers.json")
    assert download.value.suggested_filename == "99-test-Ada.json"
    found = student_progress.parse_progress((tmp_path / "answers.json").read_text(encoding="utf-8"),
                                            {lesson.name: lesson}.get)
    assert (found.name, found.fingerprint, found.answers["in-words"].last) == ("Ada", lesson.fingerprint, ATTACK)
    assert found.answers["and"].attempts == 3 and found.answers["and"].first == 1.5
    for key, is_right in (("what-happens", True), ("and", True), ("in-words", None)):
        assert mark_answer(lesson, lesson.questions[key], found.answers[key].last, numbers, outcomes).right is is_right


def test_the_core_of_a_lesson_is_taken_alone(chromium, lesson, lesson_file, tmp_path):
    """What is deeper is marked, skipped and offered at the end; the file says what was taken."""
    with opened(chromium, lesson_file[0]) as page:
        where, text = page.locator("#where"), page.locator("#lesson")
        assert f"{lesson.core_minutes} minutes for the core, {lesson.minutes} in all" in text.inner_text()
        page.get_by_label("Core only").check()
        walked(page, 4)
        assert where.inner_text() == "Step 4 of 4 of the core" and not page.locator(".deeper").count()
        page.reload()  # it is kept
        walked(page)
        assert where.inner_text() == "The end" and "still open" not in text.inner_text()
        assert "This was the core. The lesson has 2 deeper steps" in text.inner_text()
        with page.expect_download() as download:
            page.get_by_role("button", name="Hand in").click()
        download.value.save_as(tmp_path / "answers.json")
        page.get_by_role("button", name="Go deeper").click()
        assert where.inner_text() == "Step 5 of 6" and page.locator(".deeper").inner_text() == "deeper"
    found = student_progress.parse_progress((tmp_path / "answers.json").read_text(encoding="utf-8"),
                                            {lesson.name: lesson}.get)
    assert found.core is True and found.answers.keys() == {"what-happens", "and"}


def test_a_name_draws_the_same_numbers_as_on_the_page(chromium, lesson, lesson_file):
    with opened(chromium, lesson_file[0]) as page:
        for name in NAMES:
            page.get_by_label("Your name").fill(name)
            assert f"Begin with A = {draw_numbers(lesson, name)['A']}." in page.locator("#lesson").inner_text()


def test_who_made_the_error_is_in_the_file_where_the_run_has_it(play, simulate):
    """Areas in the colours of the causes and the shares of the run; another quantity has its own."""
    text = "bar;method=mpm;cells=10;periods=0.5;estimators=none;effects=truth,budget;error-of=x"
    result, page = simulate(shareable_state.parse_state(text).scene), play(text)
    for key, field in (("x", "x"), ("v", "v"), ("sigma", "F")):
        page.get_by_role("combobox", name="Error of").select_option(label=str(names_and_units.QUANTITIES[key]))
        rows = page.locator("#causes tr:not(.head)").all_inner_texts()
        shares = result.budget[field]
        assert [row.split("\t")[1] for row in rows] == [format_percent(shares[cause]) for cause in CAUSES]
        assert CAUSES["crossings"] in rows[0] and page.locator("#divided").inner_text() == CAPTION
    assert not play(text.replace(",budget", "")).locator("#budget").is_visible()


def test_a_lesson_goes_to_who_made_the_error(chromium, tmp_path):
    """What it tells to press is there, and the chart that it speaks of is before the reader then."""
    said = '- Press **On the stage**.\n- Press **Who made this error?**\n\n```run\nstage = '
    run = '"bar method=mpm cells=8 periods=0.25 estimators=none effects=truth,budget stops"\n```\n'
    lesson = parse_lesson(TEXT[:TEXT.index("## Predict")] + f"## Run: Ask\n\n{said}{run}", "99-who")
    file = tmp_path / "who.html"
    file.write_text(lesson_page(lesson, 1, silent, {}), encoding="utf-8")
    with opened(chromium, file) as page:
        page.get_by_role("button", name="Next").click()
        page.get_by_role("button", name="On the stage").click()
        shares = page.locator("#causes")
        shares.wait_for()
        assert page.evaluate(BOTTOM) > SIZE["height"]
        page.get_by_role("button", name="Who made this error?").click()
        assert page.evaluate(BOTTOM) <= SIZE["height"]
