"""The side panel in a browser: folds by keys, cards and pictures by a click, typed numbers, hints beside it."""

import pytest

from tests.browser.driving import row, scene, tick, until

#: Left and right of what is seen of elements, in one look: a hint goes when the panel moves below the pointer.
SIDES = """found => found.map(e => e.getBoundingClientRect()).filter(box => box.width > 0)
    .map(box => [box.left, box.right])"""


def folds_are_buttons_for_keys(page):
    """Each can be reached, says whether it is open, and opens and closes; made anew for another scene it stays open."""
    fold = page.get_by_role("button", name="Physics and method")
    assert fold.get_attribute("tabindex") == "0" and fold.get_attribute("aria-expanded") == "false"
    inside = page.get_by_text("What is computed")
    for key, shown in (("Enter", True), ("Space", False), ("Enter", True)):
        fold.focus()
        page.keyboard.press(key)
        until(lambda shown=shown: inside.is_visible() == shown
              and fold.get_attribute("aria-expanded") == str(shown).lower(), f"open: {shown}")


#: A fold as the viewer makes it in a busy browser, which opens it late; made anew as for another scene, and pressed by
#: the visitor in the same moment, or not.
FOLD = """([pressed]) => {
    document.getElementById("fold-of-the-test")?.remove();
    const around = document.createElement("div"), head = around.appendChild(document.createElement("div"));
    const inside = around.appendChild(document.createElement("div"));
    around.id = "fold-of-the-test";
    head.className = "mantine-Paper-root";
    head.style.cursor = "pointer";
    head.append("A fold of the test");
    head.addEventListener("click", () => setTimeout(() => inside.inert = !inside.inert, 250));
    inside.inert = true;
    document.getElementById("root").append(around);
    if (pressed) head.click();
}"""


def a_fold_that_was_open_stays_open(page):
    """Made anew it is opened again; by whoever is first, the visitor or the page, and not closed by the other."""
    inside = page.locator("#fold-of-the-test > div").nth(1)
    for pressed in (True, False, True):
        page.evaluate(FOLD, [pressed])
        page.wait_for_timeout(1000)  # the page looks a tenth of a second after a change
        assert not inside.evaluate("inside => inside.inert")
        assert inside.evaluate("inside => inside.previousElementSibling.ariaExpanded") == "true"
    page.evaluate("document.getElementById('fold-of-the-test').remove()")


def a_card_says_what_a_judge_finds_and_puts_it_on_the_stage(page):
    """Those that do not run come on request, with their price; a click on one runs it, and it is on the stage then."""
    card, ask = page.locator(".lab-judge[data-judge=recovered]"), page.locator(".lab-ask")
    assert not card.is_visible() and "recovered" in ask.inner_text()
    ask.click()
    until(card.is_visible, "a judge that does not run")
    assert "lab-off" in card.get_attribute("class") and "%" in card.inner_text()
    card.click()
    until(lambda: page.get_by_label("recovered", exact=True).is_checked(), "the switch on")
    until(lambda: "lab-on-stage" in card.get_attribute("class"), "on the stage")
    until(lambda: "%" in card.locator(".lab-finds strong").inner_text(), "what it finds")
    assert page.get_by_label("On the stage", exact=True).input_value() == "recovered"
    ask.click()
    tick(page, "recovered")
    until(lambda: not card.is_visible(), "off again")


def what_is_typed_is_written_with_its_unit(page):
    """Once it is entered; what cannot be goes back, and under the control it says why."""
    typed = page.get_by_label("Amplitude A, typed", exact=True)
    typed.fill("0.003")
    typed.press("Enter")
    until(lambda: typed.input_value() == "3 mm" and scene(page)["amplitude"] == 0.003, "3 mm")
    typed.fill("0.3")
    typed.press("Enter")
    answer = page.locator("[data-answer]")
    answer.wait_for()
    assert "0.159" in answer.get_attribute("data-answer")
    until(lambda: typed.input_value() == "3 mm", "3 mm again")
    assert scene(page)["amplitude"] == 0.003


def a_hint_stands_beside_the_panel(page):
    """At its left, never on it, and no longer once the control is used."""
    row(page, "Modulus E").first.locator("label").hover()
    hint, panel = page.locator(".mantine-Tooltip-tooltip"), page.locator("[data-dock-region=right]").bounding_box()
    sides = []
    until(lambda: sides.extend(hint.evaluate_all(SIDES)) or sides, "the hint")
    assert all(left >= 0 and right <= panel["x"] for left, right in sides)
    page.mouse.down()
    until(lambda: not hint.count() or not hint.first.is_visible(), "no hint")
    page.mouse.up()


@pytest.mark.slow
def test_the_side_panel(page):
    """One visitor for all: a page of their own would cost each more than what is looked at."""
    until(lambda: scene(page)["problem"] == "bar", "a scene")
    folds_are_buttons_for_keys(page)
    a_fold_that_was_open_stays_open(page)
    a_card_says_what_a_judge_finds_and_puts_it_on_the_stage(page)
    what_is_typed_is_written_with_its_unit(page)
    a_hint_stands_beside_the_panel(page)
