"""Exported files in a real browser, from disk and without a network: sliders, a lesson to its hand-in, and names."""

from __future__ import annotations

from contextlib import closing, contextmanager
from pathlib import Path

import pytest

import app.export
from app.export.lesson import lesson_page
from app.export.page import scene_page
from app.export.record import recording
from app.lessons import progress
from app.lessons.marks import mark
from app.lessons.outcomes import Outcomes
from app.lessons.reading import parse
from app.lessons.variants import drawn
from app.page.features.lesson.answer import _number
from tests.app.lessons.test_lesson_format import TEXT
from tests.browser.conftest import SIZE

ATTACK = "<img src=x onerror=alert(1)>"
NAMES = ["Ada", "  ada  ", "Grace Hopper", "Straße", "STRASSE", "ΟΔΥΣΣΕΥΣ", "İpek", "ﬁne", "李小龍",
         "e\u0301mile", "a\u00a0b"]
MORE = """
## Observe: In words

```question
kind = "text"
```

## Explain: The end of it
"""


def silent(part, what):
    """Nobody looks at the progress."""


@contextmanager
def opened(chromium, path):
    """A file from disk, in a browser that is offline; any error fails the test."""
    context = chromium.new_context(viewport=SIZE, offline=True, accept_downloads=True, reduced_motion="reduce")
    page, errors, asked = context.new_page(), [], []
    page.on("console", lambda message: errors.append(message.text) if message.type == "error" else None)
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.on("request", lambda request: asked.append(request.url))
    page.goto(path.as_uri())
    yield page
    page.close()
    context.close()
    assert errors == [] and [url for url in asked if not url.startswith(("file:", "data:", "blob:"))] == []


@pytest.fixture(scope="module")
def lesson():
    return parse(TEXT + MORE, "99-test")


@pytest.fixture(scope="module", autouse=True)
def recorded_here():
    """Recordings are made by this process, which a process of their own would take seconds to start for."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("app.export.page.recordings", lambda wanted, *others: [recording(one) for one in wanted])
        yield


@pytest.fixture(scope="module")
def lesson_file(lesson, tmp_path_factory):
    """The lesson's file, and what came of its runs."""
    path = tmp_path_factory.mktemp("export") / "lesson.html"
    with closing(Outcomes()) as outcomes, pytest.MonkeyPatch.context() as patch:
        patch.setattr("app.export.answers.Outcomes", lambda processes: outcomes)
        patch.setattr(outcomes, "close", lambda: None)
        path.write_text(lesson_page(lesson, 1, silent, {}), encoding="utf-8")
        patch.undo()
        yield path, outcomes


def norm(page):
    return page.locator("#norms tr", has_text="true").locator("td").first.inner_text()


@pytest.mark.parametrize("text", ["bar cells=10 periods=0.25", "ring cells=12 periods=0.1 cfl=0.3"])
def test_a_slider_shows_another_run(chromium, tmp_path, text):
    path = tmp_path / "scene.html"
    path.write_text(scene_page(text, 1, silent, {"cells": 2}), encoding="utf-8")
    with opened(chromium, path) as page:
        page.get_by_label("Time", exact=True).press("End")
        page.wait_for_function("document.querySelector('#play').textContent === 'Again'")
        cells, before, drawn_before = page.get_by_label("Cells"), norm(page), page.locator("#stage").screenshot()
        first = page.locator("#title").inner_text()
        cells.press("ArrowRight" if cells.input_value() == "0" else "ArrowLeft")
        page.wait_for_function("(before) => document.querySelector('#title').textContent !== before", arg=first)
        assert norm(page) != before and page.locator("#stage").screenshot() != drawn_before
        page.get_by_role("combobox", name="Error of").select_option(label="stress σ")
        assert norm(page).endswith("Pa")
        page.get_by_role("button", name="Again").click()
        page.wait_for_function("document.querySelector('#play').textContent === 'Pause'")


def test_a_lesson_is_played_to_its_hand_in(chromium, lesson, lesson_file, tmp_path):
    path, outcomes = lesson_file
    numbers = drawn(lesson, "Ada")
    right = mark(lesson, lesson.steps[2], 0.0, numbers, outcomes).expected.split()[0]
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
        page.wait_for_function("document.querySelector('#title').textContent.includes('8 cells')")
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
        onward.click()
        assert page.locator(".compared").get_by_text(ATTACK).count() == 1
        with page.expect_download() as download:
            page.get_by_role("button", name="Hand in").click()
        download.value.save_as(tmp_path / "answers.json")
    assert download.value.suggested_filename == "99-test-Ada.json"
    found = progress.read((tmp_path / "answers.json").read_text(encoding="utf-8"), {lesson.name: lesson}.get)
    assert (found.name, found.fingerprint, found.answers["in-words"].last) == ("Ada", lesson.fingerprint, ATTACK)
    assert found.answers["and"].attempts == 3 and found.answers["and"].first == 1.5
    for key, is_right in (("what-happens", True), ("and", True), ("in-words", None)):
        assert mark(lesson, lesson.questions[key], found.answers[key].last, numbers, outcomes).right is is_right


def test_an_answer_is_read_as_on_the_page(chromium):
    """With the unit asked for, another prefix of it, or none: the file's own script, in the browser."""
    player = Path(app.export.__file__).parent / "player"
    script = "".join((player / name).read_text(encoding="utf-8") for name in ("words.js", "answers.js"))
    page = chromium.new_page()
    for unit in ("", "µm", "mm/s", "m", "m/s", "Pa", "kPa", "s", "%", "m/s²"):
        for text in ("330 nm", "2,5", "-1e-3", "0.33 µm", "2.75 mm/s", "3 m/s", "4 kPa", "4 Pa", "12 %", "5 m", "5 mm",
                     "1 ms", "7 µm/s²", "nothing", "", "-3 mm", "1 mmm"):
            found = page.evaluate(f"([text, unit]) => {{ {script}; return numberIn(text, unit); }}", [text, unit])
            meant = _number(text, unit)
            assert found == (meant if meant is None else pytest.approx(meant, rel=1e-11)), (text, unit)
    page.close()


def test_a_name_draws_the_same_numbers_as_on_the_page(chromium, lesson, lesson_file):
    with opened(chromium, lesson_file[0]) as page:
        for name in NAMES:
            page.get_by_label("Your name").fill(name)
            assert f"Begin with A = {drawn(lesson, name)['A']}." in page.locator("#lesson").inner_text()
