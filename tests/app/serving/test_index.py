"""The html that a browser loads first, what it may do, and that no path leads to a file."""

import base64
import hashlib
import re
from pathlib import Path
from urllib.parse import unquote

import pytest
import viser
from websockets.datastructures import Headers
from websockets.http11 import Request

from app.colour_palette import ESTIMATE, TRUTH
from app.logo_and_font import ICON, MARK
from app.page.panels.page_header import initial_page_html
from app.viewer.index_page import IndexPage, is_page_path, unpacked_script

BUILD = Path(viser.__file__).parent / "client" / "build"


@pytest.fixture(scope="module")
def index():
    return IndexPage(initial_page_html, ICON)


def ask(index, path="/", code="en", **headers):
    return index.answer_in_language(Request(path, Headers({"Host": "lab.example:8080"} | headers)), code)


def test_it_has_our_title_our_mark_and_our_ground(index):
    body = ask(index).body.decode()
    icon = unquote(body.split('rel="icon"')[1].split('href="')[1].split('"')[0])
    assert icon == f"data:image/svg+xml,{MARK}" and ESTIMATE in MARK and TRUTH in MARK
    assert "<title>mpm-lab</title>" in body and initial_page_html() in body
    assert ask(index, "/other.js").status_code == 404


def test_it_runs_its_own_scripts_and_no_others(index):
    """Each is allowed by what is in it, that which the viewer unpacks too; and its websocket by the name it has."""
    answer = ask(index)
    allowed = dict(part.split(" ", 1) for part in answer.headers["Content-Security-Policy"].split("; "))
    scripts = [*re.findall(r"<script\b[^>]*>(.*?)</script>", answer.body.decode(), re.DOTALL),
               unpacked_script((BUILD / "index.html").read_text(encoding="utf-8"))]
    assert len(scripts) == 4  # one of them is no script, but words
    hashes = {f"'sha256-{base64.b64encode(hashlib.sha256(one.encode()).digest()).decode()}'" for one in scripts}
    assert set(allowed["script-src"].split()) == {*hashes, "'wasm-unsafe-eval'"}
    assert "ws://lab.example:8080" in allowed["connect-src"].split() and allowed["frame-ancestors"] == "'none'"
    by_digits = ask(index, Host="[::1]:8080").headers["Content-Security-Policy"]
    assert "connect-src 'self'" in by_digits and "::1" not in by_digits  # which no browser takes
    assert scripts[-1].strip().endswith(("}", ";", ")")) and "ViewerCameraMessage" in scripts[-1]


def test_script_of_a_viewer_that_packs_otherwise_is_not_known():
    assert unpacked_script("<script>run()</script>") is None


#: Each leads to a file when it is put behind the folder of the page, on this system or on Windows.
ELSEWHERE = ("/C:/Windows/win.ini", "/c:\\Windows\\win.ini", "//server/share/file", "/\\\\server\\share\\file",
             "/..%5c..%5cx", "/../x", "/%2e%2e/x", "/C:index.html", "/index.html::$DATA", "/index.html.",
             "/index.html ", "/INDEX.HTML", "/CON", "/NUL", "/aux.html", "/./index.html", "//index.html",
             "/index.html/", "", "*", "/%00", "\\index.html")


@pytest.mark.parametrize("path", ELSEWHERE)
def test_no_path_leads_to_a_file(index, path):
    """Paths are names of the page or nothing: none is put behind a folder, where drives, devices and streams wait."""
    assert not is_page_path(path) and not is_page_path(unquote(path))
    assert ask(index, path or "/x").status_code == 404


def test_the_viewers_page_is_one_file():
    """If this fails, the viewer has more to be asked for: see ``Index.answer_in_language``."""
    assert [path.name for path in BUILD.rglob("*") if path.is_file()] == ["index.html"]
