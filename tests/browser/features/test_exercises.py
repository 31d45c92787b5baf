"""Each exercise done literally as its lesson's text says, by a machine that reads nothing else: what it reads on the
page is what the lesson expects."""

from __future__ import annotations

import pytest

from app.lessons import shelf
from tests.browser.conftest import visit
from tests.browser.driving import until
from tests.browser.following import follow


@pytest.mark.slow
@pytest.mark.parametrize("name", shelf.names())
def test_a_lesson_done_as_it_is_written(name, server, chromium):
    with visit(chromium, server[0], query=f"#lesson={name}") as page:
        until(page.locator(".lab-lesson-head").is_visible, "the lesson")
        assert follow(page, shelf.lesson(name)) == []
        assert "the end" in page.locator(".lab-lesson-head").inner_text()
