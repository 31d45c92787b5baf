"""Browsers and networks in which much is missing: the page comes all the same, or says what to do."""

from contextlib import closing

import pytest

from app import shareable_state
from app.export.html_file import scene_page
from app.export.recording import record_scene
from app.page.features.opening_tour import OPENING
from tests.browser.conftest import _browser, no_errors
from tests.browser.driving import until
from tests.support.page_server import start_server
from tests.support.proxy import CODE, NAME, start_proxy

#: Whether something is drawn on the stage of an exported file.
DRAWN = "document.getElementById('stage').getContext('2d').getImageData(0, 0, 300, 300).data.some(part => part > 0)"
FLAT = ["--no-sandbox", "--disable-gpu", "--disable-3d-apis"]


def test_a_lab_below_a_path_of_a_proxy_is_reached(chromium, tmp_path):
    """With its code, by an address without the last slash, and again: its websocket is asked for with the slash."""
    with start_server(names=(NAME,), code=CODE) as (_, address), start_proxy(tmp_path, address) as (_, secure):
        page = chromium.new_page(ignore_https_errors=True)
        sockets = []
        page.on("websocket", lambda socket: sockets.append(socket.url))
        with no_errors(page):
            page.goto(f"https://127.0.0.1:{secure}/lab#code={CODE}")
            for _ in range(2):
                page.get_by_role("tab", name="Lessons").wait_for()
                until(lambda: page.url.partition("#")[0] == f"https://127.0.0.1:{secure}/lab/", "its own address")
                page.reload()
        assert {socket.partition("?")[0] for socket in sockets} == {f"wss://127.0.0.1:{secure}/lab/"}
        paths = {cookie["name"]: cookie["path"] for cookie in page.context.cookies()}
        assert list(paths.values()).count("/lab/") == 1 and set(paths.values()) <= {"/lab/", "/lab"}
        page.close()


def test_tabs_opened_at_once_each_show_what_they_were_asked_for(chromium):
    """Of one browser, which has one set of cookies: each its own scene, in its own language."""
    opening = shareable_state.write_state(OPENING)
    asked = {"/?lang=de#bar;cells=24": ("bar;cells=24", "Lektionen"), "/#ring;cells=30": ("ring;cells=30", "Lessons"),
             "/?lang=de": (opening, "Lektionen")}
    with start_server() as (_, address), closing(chromium.new_context()) as context:
        pages = {context.new_page(): (link, *shown) for link, shown in asked.items()}
        for page, (link, *_) in pages.items():
            page.goto(address + link, wait_until="commit")
        for page, (link, state, lessons) in pages.items():
            page.get_by_role("tab", name=lessons).wait_for()
            kept = page.locator(".lab-kept")
            until(lambda kept=kept, state=state: kept.get_attribute("data-link") == state, f"{state} of {link}")


@pytest.fixture
def flat(chromium):
    """A browser without WebGL, as on remote desktops and virtual machines."""
    browser = chromium.browser_type.launch(executable_path=_browser(), args=FLAT)
    yield browser
    browser.close()


def test_without_webgl_the_page_says_what_to_do(flat):
    with start_server() as (_, address):
        page = flat.new_page()
        page.goto(address)
        said = page.locator("#lab-ground span")
        until(lambda: "Switch on graphics acceleration" in said.inner_text(), "what to do")
        assert page.locator(".mantine-Notification-root").filter(visible=True).count() == 0
        page.close()


def test_an_exported_file_plays_without_webgl(flat, tmp_path, monkeypatch):
    monkeypatch.setattr("app.export.html_file.record_scenes",
                        lambda wanted, *others: [record_scene(one) for one in wanted])
    file = tmp_path / "scene.html"
    file.write_text(scene_page("bar cells=8 periods=0.25", 1, lambda part, what: None, {}), encoding="utf-8")
    page = flat.new_page()
    with no_errors(page):
        page.goto(file.as_uri())
        until(lambda: page.evaluate(DRAWN), "a picture")
    page.close()
