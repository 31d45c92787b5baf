"""The page in several languages: chosen, kept by every link, each visitor his own; no text is outside the catalogue."""

from contextlib import closing, contextmanager

import pytest

from app.export.lesson_export import lesson_page
from app.export.recording import record_scene
from app.language.translation import use_language
from app.lessons import catalogue
from app.lessons.answer_marking import TOLD_AFTER
from app.lessons.lesson_parser import parse_lesson
from tests.app.lessons.test_lesson_format import TEXT
from tests.browser.conftest import FEW_FRAMES, SIZE, no_errors, serving
from tests.browser.driving import again_until, until
from tests.browser.features.test_export import WATCH
from tests.browser.languages import outside, words_of
from tests.support import pseudo_translation

SCENE = "bar;cells=20;cfl=0.2"
LESSON = "04-grid-crossing"
CODE = "wave-4711"


@pytest.fixture(scope="module")
def address():
    """Of a lab for a class, in which there is one language more."""
    arguments = ("--code", CODE, "--lesson", LESSON)
    with serving({"MPM_LAB_EXTENSIONS": "tests.support.pseudo_translation"}, arguments, coded=True) as (found, *_):
        yield found


@contextmanager
def visiting(chromium, address, query=""):
    """A visitor of a class that knows its code; any error in the console fails the test."""
    context = chromium.new_context(viewport=SIZE, locale="en-GB")
    page = context.new_page()
    page.add_init_script(FEW_FRAMES)
    with no_errors(page), closing(context):
        page.goto(f"{address}/?fixedDpr=0.5{query}#code={CODE}&{SCENE}")
        there(page)
        yield page


def there(page):
    until(page.locator(".lab-says").count, "the headline")
    until(lambda: page.evaluate("document.body.dataset.tab"), "the tabs")


def spoken(page):
    return page.evaluate("document.documentElement.lang")


def at(page):
    """The query of the address, and what of the scene it has."""
    return page.evaluate("[location.search.replace(/.fixedDpr=0.5/, '').replace(/^&/, '?'), location.hash]")


def switch(page, to):
    """Press the link to a language."""
    with page.expect_navigation(wait_until="commit"):  # what is asked of a page that goes would fail
        page.locator(f"#lab-head a.lab-language[lang={to}]").click()
    until(lambda: spoken(page) == to, to)
    there(page)


@pytest.mark.short
def test_a_visitor_changes_the_language_and_what_is_seen_stays(chromium, address):
    with visiting(chromium, address) as page:
        until(lambda: "cells=20" in at(page)[1], "the scene in the address")
        assert spoken(page) == "en" and "lang=" not in at(page)[0]
        switch(page, "de")
        until(lambda: "cells=20" in at(page)[1], "the same scene")
        assert "lang=de" in at(page)[0] and page.locator("#lab-head h1").text_content().endswith("Wie falsch ist es?")
        page.reload()
        there(page)
        assert spoken(page) == "de"
        link = page.evaluate("location.href").replace("#", f"#code={CODE}&")
        switch(page, "en")
        until(lambda: "cells=20" in at(page)[1], "the same scene again")
        assert "lang=en" in at(page)[0] and "lang=de" not in at(page)[0]
        page.goto("about:blank")
        page.goto(link)  # whoever gets it reads German too
        there(page)
        assert spoken(page) == "de" and "lang=de" in at(page)[0]


@pytest.mark.slow
def test_nothing_on_the_page_is_said_outside_the_catalogue(chromium, address):
    with visiting(chromium, address, f"&lang={pseudo_translation.CODE}") as page:
        found = {}

        def look(state):
            page.wait_for_timeout(700)  # for what follows a click
            found.update({text: (state, where) for text, where in outside(page).items() if text not in found})

        until(page.locator(".lab-lesson-head").is_visible, "the lesson")
        look("introduction")
        onward = page.locator("[data-lab~=lab-beside][data-lab~=lab-main] + div button, "
                              "[data-lab~=lab-beside] + div + [data-lab~=lab-beside] + div button").last
        lesson = catalogue.load_lesson(LESSON)
        for step in lesson.steps[:4]:
            again_until(onward.click, lambda step=step: step.title in page.locator(".lab-lesson h2").all_inner_texts(),
                        step.title)
            look(step.key)
            if step.question:
                page.locator("[data-lab=lab-main] + div button").last.click()
                until(page.locator(".lab-recorded").count, "what is asked for")
                look("no answer")
                page.locator(".lab-choice input").first.click()
                page.locator("[data-lab=lab-main] + div button").last.click()
                until(lambda: page.locator(".lab-recorded b").count() and onward.is_enabled(), "the answer")
                look("answered")
            if step.stage:
                page.locator(".lab-put").click()
                look("on the stage")
        leave = page.locator("[data-lab=lab-link] + div button").last
        again_until(leave.click, page.locator(".lab-shelf").count, "all lessons")
        look("lessons")
        for tab in ("Cost", "About", "Explore"):
            page.evaluate(f"dispatchEvent(new CustomEvent('lab-tab', {{detail: '{tab}'}}))")
            until(lambda tab=tab: page.evaluate("document.body.dataset.tab") == tab, tab)
            for head in page.locator("[aria-expanded=false][style*='cursor: pointer']").all():
                if head.is_visible():
                    head.click()
            look(tab)
        page.keyboard.press("?")
        look("keys")
        page.keyboard.press("Escape")
        page.locator("[data-lab~=lab-at-slow] + div button").click()
        look("slow motion")
        page.locator("[data-lab~=lab-at-slow] + div button").first.click()
        page.keyboard.press("p")
        look("pinned")
        page.evaluate("location.hash = 'bar;cells=2'")
        until(page.locator(".lab-notice, .lab-refused").count, "why the link cannot be followed")
        look("refused")
        assert found == {}


@pytest.mark.slow
def test_nothing_in_a_file_is_said_outside_the_catalogue(chromium, tmp_path, monkeypatch):
    """A lesson, which is in English: each step, and what is said of answers."""
    monkeypatch.setattr("app.export.html_file.record_scenes", lambda wanted,
                        *others: [record_scene(one) for one in wanted])
    path = tmp_path / "lesson.html"
    with use_language(pseudo_translation.CODE):
        path.write_text(lesson_page(parse_lesson(TEXT, "99-test"), 1, lambda part, what: None, {}), encoding="utf-8")
    page, found = chromium.new_page(viewport=SIZE), {}
    page.add_init_script(WATCH)
    page.goto(path.as_uri())

    def look(state):
        found.update({text: (state, where) for text, where in outside(page).items() if text not in found})
        drawn = page.evaluate("drawn.texts.splice(0)")  # line by line
        found.update({words_of("\n".join(drawn)): (state, "drawn")} if words_of("\n".join(drawn)) else {})

    look("introduction")
    onward, chosen, answer = "button.next", ".options + button", ".answer + button"
    for press in (onward, chosen, ".options input", chosen, onward, "button.stage", onward, *[answer] * TOLD_AFTER,
                  onward, onward):
        if press == answer:
            page.locator(".answer input").fill("1e9")
        page.locator(press).first.click()
        if press == "button.stage":
            until(page.locator("#facts tr").count, "the run")
        look(press)
    page.close()
    assert found == {}
