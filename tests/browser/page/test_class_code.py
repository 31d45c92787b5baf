"""The class code in a real browser: typed, wrong, and brought by a link."""

import pytest

from tests.browser.conftest import FEW_FRAMES, axe_finds, serving
from tests.browser.driving import until

CODE = "wave-4711"


@pytest.fixture(scope="module")
def address():
    with serving(arguments=("--code", CODE), coded=1) as (address, _, line):
        assert f"#code={CODE}" in line
        yield address


@pytest.fixture
def stranger(chromium):
    """A browser that has never been here."""
    context = chromium.new_context(viewport={"width": 1280, "height": 720})
    page = context.new_page()
    page.add_init_script(FEW_FRAMES)
    yield page
    context.close()


def there(page):
    until(page.locator(".lab-readout", has_text="periods").count, "the first numbers")


@pytest.mark.short
def test_code_that_is_typed_lets_in_and_a_wrong_one_says_so(stranger, address):
    """By keyboard alone, with the field found by its label; and whoever is in stays in after a reload."""
    sockets = []
    stranger.on("websocket", lambda socket: sockets.append(socket.url))
    stranger.goto(f"{address}/?fixedDpr=0.5")
    field = stranger.get_by_label("Class code", exact=True)
    stranger.keyboard.type("wave-1234")  # the field has the focus
    stranger.keyboard.press("Enter")
    stranger.get_by_role("alert").filter(has_text="This is not the code.").wait_for()
    assert stranger.locator(".lab-readout").count() == 0 and sockets == []
    field.fill("Wave 4711")
    stranger.get_by_role("button", name="Enter").click()
    there(stranger)
    assert "4711" not in stranger.url and sockets
    stranger.reload()
    there(stranger)


def test_wrong_code_in_the_link_is_told_and_removed(stranger, address):
    stranger.goto(f"{address}/#code=nonsense")
    stranger.get_by_role("alert").filter(has_text="This is not the code.").wait_for()
    assert stranger.url == f"{address}/" and stranger.get_by_label("Class code").input_value() == "nonsense"


def test_page_of_the_code_fits_a_phone_and_has_no_faults(stranger, address):
    for width, height in ((1280, 720), (390, 844)):
        stranger.set_viewport_size({"width": width, "height": height})
        stranger.goto(address)
        assert stranger.evaluate("document.documentElement.scrollWidth") <= width
        assert axe_finds(stranger) == []
