"""How a test drives the page: by the words a visitor reads."""

import io
import json
import re
from contextlib import suppress

import numpy as np
from PIL import Image

from app.colour_palette import colour_table
from app.names_and_units import parse_size
from tests.support import processes

PATIENCE = 20.0  # seconds for what follows a click; software rendering is slow
AGAIN, LOST = 5, 4.0  # times that a click is made, and seconds in which a box shows it, if it has not been lost


def until(condition, what, patience=PATIENCE):
    """Wait until ``condition()`` is true."""
    processes.wait_until(condition, what, patience, 0.1)


def shown(page, text):
    """Wait until these words are to be read."""
    until(page.get_by_text(text).first.is_visible, text)


def row(page, label):
    """The row of the control panel with this label."""
    return page.get_by_text(label).locator("xpath=ancestor::div[contains(@class,'mantine-Flex-root')][1]")


def readout(page):
    """All that is to be read in the fold, row by row, open or not."""
    return page.locator(".lab-readout").evaluate("""readout => [...readout.querySelectorAll("tr, p")].map(
        row => row.cells ? [...row.cells].map(cell => cell.textContent).join("\\t") : row.textContent).join("\\n")
        || readout.textContent""")


def number(page, pattern):
    """The first number in the readout that matches ``pattern``'s group."""
    return float(re.search(pattern, readout(page))[1].replace(",", ""))


def scene(page):
    """The running scene, field by field."""
    return json.loads(page.locator(".lab-scene").get_attribute("data-scene"))


def summary(page):
    """The sentence, without what keeps "0.25–0.30" and "25 mm" in one line."""
    return page.locator("#lab-summary[role=status]").inner_text().replace("\N{WORD JOINER}", "") \
        .replace("\N{NO-BREAK SPACE}", " ").replace("\n", " ")


def time(page):
    return number(page, r"time\s+(\S+) s")


def steps(page):
    return number(page, r"steps\s+([\d,]+)")


def step_size(page):
    """The time step in s."""
    return parse_size(re.search(r"steps\s+[\d,]+ of (\S+ \S*s)\b", readout(page))[1], "s")


def again_until(act, condition, what):
    """Click until it has had its effect: a click is lost when a busy browser moves, or makes anew, what is under it
    between its press and its release, and a visitor would click once more."""
    from playwright.sync_api import TimeoutError  # here: who has no playwright can still collect the tests

    for _ in range(AGAIN):
        with suppress(TimeoutError):
            act()
        with suppress(AssertionError):
            return until(condition, what, LOST)
    raise AssertionError(f"clicked {AGAIN} times in vain: {what}")


def downloaded(page, act):
    """The file that a click brings."""
    files = []
    page.on("download", lambda file: files.append(file))
    again_until(act, lambda: files, "a file")
    return files[0]


def choose(page, label, option):
    """Choose an option, or one whose name begins so, of a dropdown; methods are buttons, and problems where there is
    room."""
    if label in ("Problem", "Method") and (button := page.get_by_role("radio", name=option)).is_visible():
        return again_until(button.click, lambda: button.get_attribute("aria-checked") == "true", option)
    box, offered = page.get_by_label(label, exact=True), page.get_by_role("option", name=option)

    def click():
        if not offered.count():
            box.click()
        offered.click(timeout=1e3 * PATIENCE)

    again_until(click, lambda: not offered.count() and option in box.input_value(), f"{label}: {option}")


def tick(page, label):
    """Change a checkbox to what it is not; that of an estimator that does not run is asked for."""
    box, ask = page.get_by_label(label, exact=True), page.locator(".lab-ask[aria-expanded=false]")
    if not box.is_visible() and ask.is_visible():
        ask.click()
    before = box.is_checked()
    again_until(lambda: box.is_checked() == before and box.click(), lambda: box.is_checked() != before, label)


def enter(page, label, value):
    """Enter a number in the row with this label."""
    # A logarithmic slider hides its own number, and the page names the text beside it a moment after it is there.
    numbers = row(page, label).locator("input.mantine-NumberInput-input")
    box = page.get_by_label(f"{label}, typed", exact=True).or_(numbers).filter(visible=True)
    box.fill(value)
    box.press("Enter")


def to_the_ring(page):
    """Choose the ring, and wait for its controls: what is clicked among those of the bar goes with them."""
    choose(page, "Problem", "expanding ring")
    page.locator("label[data-words='h = 50 mm']").wait_for()


#: The controls' folders, by the beginning of their names, and what shows in them once they are open.
FOLDERS = {"Method details": "Remedies for long", "What is computed": "contradictions",
           "One step in slow motion": "Seconds a phase", "Look": "Plots show", "Your own data": "Choose a file",
           "All numbers of this run": re.compile("^steps$"),
           "Physics and method": re.compile("^(Motion|Poisson's ratio ν|Method details and remedies)$")}
#: Those within others, where no lesson has them by themselves.
WITHIN = {"Method details": "Physics and method", "What is computed": "Physics and method",
          "All numbers of this run": "Your own data"}


def unfold(page, *folders):
    """Open folders. One that is on its way opens slowly on a busy machine, and another click would close it again."""
    heads = page.locator(".mantine-Paper-root[aria-expanded]")
    for folder in folders:
        if (around := WITHIN.get(folder)) and heads.filter(has_text=around).count():
            unfold(page, around)
        inside = page.get_by_text(FOLDERS[folder]).first
        head = heads.filter(has_text=folder).first

        def opened(head=head):
            return head.get_attribute("aria-expanded") == "true"

        again_until(lambda: opened() or head.click(), opened, f"{folder} open")  # noqa: B023
        until(inside.is_visible, f"what is in {folder}")


def press(page, label, key, times=1):
    row(page, label).get_by_role("slider").focus()
    for _ in range(times):
        page.keyboard.press(key)


def pinned(page):
    """Whether a run is pinned beside the one on the stage: what the button says, which only lessons show."""
    return page.locator("[data-lab~=lab-at-pin] + div button").first.text_content() == "Unpin"


def click(page, button):
    page.get_by_role("button", name=button, exact=True).click()


def tab_to(page, name, most=80):
    """Go on by Tab alone until a button of this name has the focus, if it has not got it, and see that it shows."""
    passed = []
    for _ in range(most):
        kind, said, outline = page.evaluate(
            "(e => [e.tagName, e.getAttribute('aria-label') || e.textContent, getComputedStyle(e).outlineStyle])"
            "(document.activeElement)")
        if kind == "BUTTON" and name in said:
            assert outline != "none"
            return
        passed.append(said[:30])
        page.keyboard.press("Tab")
    raise AssertionError(f"no way to {name}: {passed}")


def stage(page):
    """The stage between the panels and what is above and below it, as an array of colours."""
    box = stage_box(page)
    shot = page.screenshot(clip={"x": box["x"], "y": 0, "width": box["width"], "height": page.viewport_size["height"]})
    return np.asarray(Image.open(io.BytesIO(shot)).convert("RGB")).astype(int)


def stage_box(page):
    """Where the stage is in the window, in pixels."""
    return page.locator("[data-dock-root] > div:first-child").bounding_box()


def lane(page, name):
    """The rows of the window in which the lane so called lies, but for its rim: its name stands at its middle."""
    box = page.locator("#lab-stage .lab-label").filter(has_text=re.compile(f"^{name}")).first.bounding_box()
    middle = round(box["y"] + 0.5 * box["height"])
    return slice(middle - 10, middle + 10)


def in_lane(page, name, share):
    """The place in the window that is so much of the way along the lane so called."""
    box, rows = stage_box(page), lane(page, name)
    return box["x"] + share * box["width"], (rows.start + rows.stop) / 2


def plotted(page):
    """Number of points each plot draws and the last time on it, from the charts themselves."""
    return page.evaluate("Object.values(window.__viserTestpoints.uplots).map(u => "
                         "[u.chart.data[0].length, u.chart.data[0][u.chart.data[0].length - 1]])")


def drawn(page):
    """Of the plot of error norms: the number of points, and of each series whether it draws more than one of them."""
    return page.evaluate("(() => { const d = Object.values(window.__viserTestpoints.uplots)[0].chart.data;"
                         "return [d[0].length, ...d.slice(1).map(s => +([...s].filter(v => v > 0).length > 1))]; })()")


def coloured(picture):
    """Share of the picture whose colours are those of the colour map, to within rounding."""
    table = {tuple(c) for c in colour_table().tolist()}
    return np.mean([tuple(c) in table for c in picture.reshape(-1, 3)[::7].tolist()])


def click_a_particle(page, x, y):
    """Click a place of the window once a particle is drawn there, in a colour of the map."""
    around = {"x": x - 4, "y": y - 4, "width": 9, "height": 9}

    def there():
        shot = Image.open(io.BytesIO(page.screenshot(clip=around))).convert("RGB")
        return coloured(np.asarray(shot).astype(int)) > 0.5

    until(there, f"a particle at ({x}, {y})")
    page.mouse.click(x, y)


def engine_processes(parent):
    """Ids of the processes that ``parent`` has spawned to simulate in."""
    return processes.children(parent, "spawn_main")
