"""The site builds without a warning, every text is a page of it, its links lead somewhere, and it fetches nothing."""

from __future__ import annotations

import re
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest

from app.lessons import catalogue, class_plans
from tests.groups import require_group
from tests.support.paths import ASSETS, LESSONS, ROOT
from tests.support.processes import HANG

TEXTS = [*(ROOT / name for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md")), *ASSETS.glob("*.md"),
         *(path for path in LESSONS.rglob("*.md") if "." not in path.stem)]  # English, as the site is


class Page(HTMLParser):
    """What of a page can be pointed at, where it points, and what it loads of itself."""

    def __init__(self, path: Path):
        super().__init__()
        self.ids, self.links, self.loads = {""}, [], []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        found = dict(attributes)
        self.ids.add(found.get("id"))
        if tag == "a" and "href" in found:
            self.links.append(found["href"])
        elif tag == "link" and found.get("rel") != "canonical":
            self.loads.append(found["href"])
        elif "src" in found:
            self.loads.append(found["src"])


@pytest.fixture(scope="module")
def site(tmp_path_factory) -> Path:
    """The site, built by the line that ``assets/site/conf.py`` and CONTRIBUTING.md give."""
    require_group("docs")
    out = tmp_path_factory.mktemp("site")
    line = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", "-E", "-c", ASSETS / "site", ROOT, out]
    done = subprocess.run(line, cwd=ROOT, capture_output=True, text=True, timeout=HANG)
    assert done.returncode == 0, done.stdout + done.stderr
    return out


@pytest.fixture(scope="module")
def pages(site) -> dict[Path, Page]:
    return {path: Page(path) for path in site.rglob("*.html")}


def test_every_text_is_a_page(site):
    assert len(TEXTS) > 20
    for text in TEXTS:
        assert (site / text.relative_to(ROOT)).with_suffix(".html").is_file(), text.name


def test_links_lead_to_a_page_and_to_a_place_on_it(site, pages):
    inside = [(path, link) for path, page in pages.items() for link in page.links if not urlsplit(link).scheme]
    assert len(inside) > 500
    for path, link in inside:
        parts = urlsplit(link)
        there = (path.parent / unquote(parts.path)).resolve() if parts.path else path
        assert there.is_file(), f"{path.relative_to(site)} -> {link}"
        if parts.fragment and there in pages:
            assert unquote(parts.fragment) in pages[there].ids, f"{path.relative_to(site)} -> {link}"


def test_nothing_is_fetched_from_elsewhere(site, pages):
    for path, page in pages.items():
        elsewhere = [one for one in page.loads if urlsplit(one).scheme not in ("", "data") or one.startswith("//")]
        assert elsewhere == [], path
    styles = [path.read_text(encoding="utf-8") for path in (site / "_static").rglob("*.css")]
    assert styles and not any(re.search(r"(@import|url\()\s*['\"]?(https?:)?//", text) for text in styles)


def test_the_first_page_plays_the_bar_of_the_opening(site, pages):
    first = site / "assets" / "site" / "index.html"
    frame, = (address for address in pages[first].loads if address.endswith("bar.html"))
    shown = (first.parent / frame).resolve().read_text(encoding="utf-8")
    assert "A = 3.4 mm" in shown and shown.count('id="run-') == 1


def test_formulas_are_mathml_and_no_letters(site):
    text = (site / "lessons" / "04-grid-crossing.html").read_text(encoding="utf-8")
    assert text.count("<math") > 10 and "$" not in re.sub(r"<script.*?</script>", "", text, flags=re.DOTALL)


@pytest.mark.parametrize("name", catalogue.lesson_names())
def test_a_lesson_does_not_tell_before_it_is_asked(name, site):
    """The teacher's notes, claims and right answers are nowhere; what explains is folded, with its title."""
    lesson = catalogue.load_lesson(name)
    text = (site / "lessons" / f"{name}.html").read_text(encoding="utf-8")
    article = text[text.index("<article"):text.index("</article>")]
    open_parts = re.sub(r"<details.*?</details>", "", article, flags=re.DOTALL)
    explained = [step for step in lesson.steps if step.kind == "explain"]
    assert article.count("<details") == len(explained) == article.count("</details>")
    assert all(_plain(step.title) not in _plain(open_parts) and _plain(step.title) in _plain(article)
               for step in explained)
    notes = [line for part in (lesson, *lesson.steps) for line in part.notes.splitlines() if len(line) > 40]
    claims = [claim.text for step in lesson.steps for claim in step.claims]
    assert notes and claims and not any(_plain(secret) in _plain(article) for secret in (*notes, *claims))
    assert all(_plain(option) in _plain(article) for step in lesson.steps if step.question
               for option in step.asked_question.options if "{" not in option)


def test_a_page_for_a_class_has_its_timetable_and_no_claims(site):
    for name in class_plans.class_plan_names():
        text = (site / "lessons" / "classes" / f"{name}.html").read_text(encoding="utf-8")
        article = text[text.index("<article"):text.index("</article>")]
        assert (
            _plain(class_plans.load_class_plan(name).claims.title) in _plain(article) and article.count("<table") >= 1
        )
        assert "+++" not in article and "error.x" not in article


def _plain(text: str) -> str:
    """Letters and digits alone, so that quotes, formulas and tags do not part what is the same."""
    return re.sub(r"\W+", "", re.sub(r"<[^>]*>|&\w+;|&#\d+;", "", text))
