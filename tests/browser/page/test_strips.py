"""The strips under the sliders in a browser: they say what their points are, keys go from point to point, a digit opens
the number, and the modulus keeps the time step if it is told to."""

import json
import math

import pytest

from app.names_and_units import per_cent
from tests.browser.conftest import visit
from tests.browser.driving import scene, until

SMALL = "#bar;method=mpm;cells=10;ppc=2;amplitude=0.01;estimators=recovered;error-of=sigma"


def data(page, parameter):
    """What the page has said of a row."""
    return json.loads(page.locator("i.lab-landscapes").get_attribute("data-said"))[parameter]


def row(page, parameter):
    return page.locator(f"[data-lab~=lab-row]:has(i[data-parameter={parameter}]) + div")


def place(page, parameter, value, part=".lab-strip"):
    """Where a value of a slider is in the window, on its strip or another ``part`` of its row."""
    slider, box = row(page, parameter).get_by_role("slider"), row(page, parameter).locator(part).bounding_box()
    low, high = (float(slider.get_attribute(f"aria-value{end}")) for end in ("min", "max"))
    return box["x"] + (math.log10(value) - low) / (high - low) * box["width"], box["y"] + box["height"] / 2


def hovered(page, parameter, k):
    """The sentence of a row while the pointer is over a point of its strip."""
    page.mouse.move(*place(page, parameter, data(page, parameter)["v"][k]))
    until(row(page, parameter).locator(".lab-read").is_visible, "the sentence")
    return row(page, parameter).locator(".lab-read").inner_text()


def a_row_reads_where_the_pointer_is(page):
    """And is silent without it; what is heard of the slider is the sentence of its own value."""
    found = data(page, "cells")
    k = next(k for k, state in enumerate(found["state"]) if state == "ok" and found["v"][k] != 10)
    said = hovered(page, "cells", k)
    assert said.startswith(f"{found['v'][k]} cells: up to {per_cent(found['true'][k])} wrong, estimate ")
    page.mouse.move(0, 0)
    until(lambda: not row(page, "cells").locator(".lab-read").is_visible(), "silence")
    until(lambda: (row(page, "cells").get_by_role("slider").get_attribute("aria-valuetext") or "")
          .startswith("10 cells: up to "), "the slider's own sentence")


def keys_go_from_point_to_point(page):
    """Of those that are known: a busy machine finds some too costly."""
    row(page, "amplitude").get_by_role("slider").focus()
    for key, way in (("ArrowRight", 1), ("PageUp", 1), ("ArrowLeft", -1)):
        now = scene(page)["amplitude"]
        page.keyboard.press(key)
        until(lambda now=now, way=way: way * (scene(page)["amplitude"] - now) > 0, key)
        assert scene(page)["amplitude"] in data(page, "amplitude")["v"]
    page.keyboard.press("t")
    table = page.locator("#lab-table")
    until(table.is_visible, "the table")
    assert table.locator("tr").count() == 1 + len(data(page, "amplitude")["v"])
    page.keyboard.press("Escape")


def a_digit_opens_the_number(page):
    """Enter takes it, Escape leaves it, and the slider has the focus again."""
    row(page, "amplitude").get_by_role("slider").focus()
    typed = page.get_by_label("Amplitude A, typed", exact=True)
    page.keyboard.type("2,5 mm")
    page.keyboard.press("Enter")
    until(lambda: scene(page)["amplitude"] == 0.0025 and typed.input_value() == "2.5 mm", "2.5 mm")
    page.keyboard.type("7")
    assert typed.input_value() == "7"
    page.keyboard.press("Escape")
    assert typed.input_value() == "2.5 mm"
    assert row(page, "amplitude").get_by_role("slider").evaluate("slider => slider === document.activeElement")
    assert scene(page)["amplitude"] == 0.0025


def the_modulus_keeps_what_it_is_told_to(page):
    """With a kept step four times the modulus is twice the CFL number, and its strip is no longer flat."""
    until(lambda: data(page, "modulus")["flat"], "no effect")
    page.get_by_role("button", name="keeps the CFL number").click()
    until(lambda: not data(page, "modulus")["flat"], "an effect")
    before, typed = scene(page), page.get_by_label("CFL number, typed", exact=True)
    row(page, "modulus").get_by_role("slider").focus()
    page.keyboard.type(f"{4 * before['modulus']:g}")
    page.keyboard.press("Enter")
    until(lambda: scene(page)["modulus"] == 4 * before["modulus"] and scene(page)["dt"] == before["dt"], "the modulus")
    until(lambda: typed.input_value() == "0.1", "twice the CFL number")


@pytest.mark.slow
def test_strips(server, chromium):
    """One visitor for all: a page of their own would cost each more than what is looked at."""
    with visit(chromium, server[0], SMALL) as page:
        until(lambda: scene(page)["cells"] == 10, "the scene")
        page.keyboard.press(" ")
        until(lambda: all(data(page, name).get("complete") and data(page, name)["state"].count("ok") > 1
                          for name in ("cells", "amplitude")), "points", 60.0)
        boxes = [row(page, name).locator(".lab-strip").bounding_box() for name in ("cells", "ppc", "cfl")]
        assert boxes[-1]["y"] + boxes[-1]["height"] < 720
        a_row_reads_where_the_pointer_is(page)
        keys_go_from_point_to_point(page)
        a_digit_opens_the_number(page)
        the_modulus_keeps_what_it_is_told_to(page)
