"""A stranger's first minute with the bar, after the introduction: a slider is dragged at rest, every place says the
same numbers, a second run follows, Cost is filled, and all of it is undone. No change at rest loses its instant."""

import json
import math
import re

from app.cli import main
from app.frame.headline import InstantErrors, lane_facts
from app.names_and_units import per_cent
from tests.browser.conftest import SIZE, visit
from tests.browser.driving import choose, click, press, scene, stage, step_size, steps, summary, until
from tests.browser.page.test_present import small
from tests.browser.page.test_strips import place, row

FIRST = 0.003125  # m: from a particle to the boundary of its cell, of which each has four, 25 mm wide
TRACK, NONE = ".mantine-Slider-track", "No particle has changed its cell yet"
RUNS = "#lab-stage .lab-role-note:has(.lab-part-number)"  # the end of each run's title
#: What a visitor can use, as [its name, left, lower end], each radio button and tab one; values of sliders are text.
ALL = """[...document.querySelectorAll("a[href], [role=tab], [role=radio], [role=slider], [type=checkbox], select, "
        + "[role=button], [aria-haspopup=listbox], button:not([role])")]
    .filter(e => e.checkVisibility({visibilityProperty: true}) && e.offsetWidth > 1 && !e.closest("[data-disabled]"))"""
CONTROLS = f"""() => {ALL}
    .map(e => {{ const {{left, bottom}} = e.getBoundingClientRect();
        return [e.getAttribute("aria-label") || e.textContent.trim().slice(0, 30), left, bottom]; }})"""
#: What has the focus: its name, whether it had it before, and whether it or what is around it shows that.
FOCUS = """() => {
    const e = document.activeElement, around = [e, e.parentElement, e.parentElement.parentElement,
        ...e.parentElement.children], before = "reached" in e.dataset;
    e.dataset.reached = "";
    return [e.getAttribute("aria-label") || e.textContent.trim().slice(0, 30), before,
        e === document.body || around.some(one => getComputedStyle(one).outlineStyle !== "none")]; }"""
#: Controls that have not had it, nor another of their group.
MISSED = f"""() => {ALL}
    .filter(e => !e.matches("[data-reached], :is([role=tablist], [role=radiogroup]):has([data-reached]) *"))
    .map(e => e.getAttribute("aria-label") || e.textContent.trim().slice(0, 30))"""
#: Keeps what the headline says in between.
LISTEN = """() => {
    const summary = document.getElementById("lab-summary");
    window.heard = [];
    new MutationObserver(() => heard.push(summary.textContent)).observe(summary, {childList: true, subtree: true}); }"""


def there_are_few_controls(page):
    """All of the panel's are seen at once in a laptop's window; nothing is too small to be read."""
    found = page.evaluate(CONTROLS)
    panel = [control for control in found if control[1] > SIZE["width"] - 368]
    assert (len(panel), len(found)) == (21, 38), found
    assert max(bottom for _, _, bottom in panel) < SIZE["height"]
    assert small(page, 12) == []


def keys_reach_all(page):
    """By Tab alone, and it is seen where one is; Escape closes what opens."""
    stops = []
    while not stops or not stops[-1][1]:
        page.keyboard.press("Tab")
        stops.append(page.evaluate(FOCUS))
    assert [name for name, _, seen in stops if not seen] == [] == page.evaluate(MISSED), stops
    page.get_by_role("radio", name="Your own").click()
    menu = page.get_by_role("menu", name="Your own")
    until(menu.is_visible, "the menu")
    page.keyboard.press("Escape")
    until(lambda: not menu.is_visible(), "no menu")
    row(page, "amplitude").get_by_role("slider").press("t")
    until(page.locator("#lab-table").is_visible, "the table")
    page.keyboard.press("Escape")
    until(lambda: not page.locator("#lab-table").is_visible(), "no table")


def leave_introduction(page):
    """Until two runs play."""
    until(lambda: "Material Point Method" in summary(page), "the introduction", 60.0)
    click(page, "Skip")
    page.locator("#lab-first-words").get_by_role("button", name="Close").click()
    until(lambda: "Try one" in page.locator("#lab-sparks").inner_text(), "the questions", 60.0)
    until(lambda: page.locator(RUNS).count() == 2, "two runs", 60.0)


def pause(page):
    page.evaluate("document.activeElement.blur()")
    page.keyboard.press("Space")
    until(lambda: not page.locator("body.lab-playing").count(), "a pause")


def crossed(page):
    """Whether a particle in the upper plot has the ring of one that has changed its cell."""
    title, lane = (page.locator("#lab-stage .lab-label", has_text=text).first.bounding_box()["y"]
                   for text in ("This run", "estimate"))
    red, green, blue = (stage(page)[round(title) + 14:round(lane), :, k] for k in range(3))
    return bool(((red > 150) & (green < 90) & (blue > 80)).any())


def type_amplitude(page, typed, value):
    row(page, "amplitude").get_by_role("slider").focus()
    page.keyboard.type(typed)
    page.keyboard.press("Enter")
    until(lambda: scene(page)["amplitude"] == value, typed)


def a_drag_shows_the_first_crossing(page):
    """On the stage from the amplitude on at which a particle reaches its cell's end; on the strip at just that."""
    type_amplitude(page, "2 mm", 0.002)
    until(lambda: NONE in summary(page) and not crossed(page), "the run with 2 mm")
    page.mouse.move(*place(page, "amplitude", 0.002, TRACK))
    page.mouse.down()
    for value, crosses in ((0.98 * FIRST, False), (1.03 * FIRST, True), (0.005, True)):
        page.mouse.move(*place(page, "amplitude", value, TRACK))
        until(lambda value=value: abs(scene(page)["amplitude"] / value - 1) < 0.02, f"{value} m")
        until(lambda crosses=crosses: (NONE in summary(page)) != crosses == crossed(page), f"crossings: {crosses}")
    page.mouse.up()
    type_amplitude(page, "5 mm", 0.005)
    line, strip = (row(page, "amplitude").locator(part) for part in (".lab-strip path[style*='--cross']", ".lab-strip"))
    until(line.count, "the first crossing on the strip")
    at = strip.bounding_box()["x"] + float(re.match(r"M([\d.]+)", line.get_attribute("d"))[1])
    assert abs(at - place(page, "amplitude", FIRST)[0]) < 1


def every_place_says_the_same(page, folder):
    """Headline, title of the lane and card; and a run by the command, of the same scene to the same instant."""
    file, shown = folder / "run.json", scene(page)
    assert main(["run", "bar", "--method", "mpm", "--amplitude", f"{shown['amplitude']}", "--estimator", "recovered",
                 "--t-end", f"{steps(page) * step_size(page)}", "--json", str(file)]) == 0
    result = json.loads(file.read_text(encoding="utf-8"))
    errors = InstantErrors(*(result[kind]["sigma"]["final"] for kind in ("error", "estimate")))
    facts = lane_facts(errors, 2 * math.pi * shown["amplitude"] * shown["modulus"], "recovered", False, 0.0)
    wrong, found = "".join(text for _, text in facts).split(" · ")
    until(lambda: f"{wrong}; {found}" in summary(page), f"{wrong}, {found} in the headline")
    title = page.locator("#lab-stage .lab-role-note:has(.lab-part-duration)").first
    assert title.inner_text().startswith(f"{wrong} · {found} · ")
    assert page.locator(".lab-judge[data-judge=recovered] .lab-finds strong").inner_text() == per_cent(errors.index)


def a_second_run_follows(page):
    """By another method, chosen in its title: its numbers change with the next slider."""
    titles = page.locator(RUNS)
    page.get_by_label("Compare with").select_option("nothing")
    until(lambda: titles.count() == 1, "one run")
    press(page, "Particles / cell", "ArrowLeft")  # else both choices would be one step of Undo
    until(lambda: scene(page)["ppc"] < 4, "fewer particles")
    page.get_by_label("Compare with").select_option("bspline")
    until(lambda: titles.count() == 2 and "B-spline at the same settings" in summary(page), "two runs")
    before = titles.all_inner_texts()
    press(page, "Cells", "ArrowLeft")
    until(lambda: scene(page)["cells"] < 40 and all(now != then for now, then in zip(
        titles.all_inner_texts(), before, strict=True)), "other numbers of both")


def cost_is_filled(page):
    page.get_by_role("tab", name="Cost").click()
    until(lambda: page.locator(".lab-dot").count() >= 24 and page.locator(".lab-dot.lab-own").count() == 1, "runs")
    until(lambda: "Your run" in page.locator("#lab-cost h2").inner_text(), "the run on the stage among them")
    page.get_by_role("tab", name="Explore").click()


def undo_goes_back(page):
    """Step by step, the button says to what; the instant stays, to a step of time, which cells change."""
    button, at = page.locator("#lab-undo"), clock(page)
    until(lambda: "Cells" in button.get_attribute("title"), "what is undone")
    button.click()
    until(lambda: scene(page)["cells"] == 40 and scene(page)["amplitude"] == 0.005, "40 cells")
    until(lambda: "Compare with" in button.get_attribute("title"), "the step before")
    page.keyboard.press("Control+z")
    until(lambda: page.locator(RUNS).count() == 1, "one run")
    now, then = (float(text.removesuffix(" s")) for text in (clock(page), at))
    assert abs(now - then) < step_size(page) + 0.001  # the clock's last digit


def no_change_loses_the_instant(page):
    """Of slider, method, judge or problem: at rest, the errors at the same phase come, and never "not measured"."""
    page.evaluate(LISTEN)
    for field, value, change in (
            ("amplitude", 0.004, lambda: type_amplitude(page, "4 mm", 0.004)),
            ("method", "ugimp", lambda: choose(page, "Method", "uGIMP")),
            ("estimators", ["recovered", "companion"], lambda: choose_companion(page)),
            ("problem", "ring", lambda: choose(page, "Problem", "expanding ring"))):
        at = clock(page)
        change()
        until(lambda: scene(page)[field] == value and " wrong" in summary(page), f"another {field}", 60.0)  # noqa: B023
        assert field == "problem" or clock(page) == at
        assert summary(page).startswith("At t = ")
    assert [said for said in page.evaluate("heard") if "measured" in said] == []


def clock(page):
    return page.locator("#lab-clock").inner_text()


def choose_companion(page):
    page.locator(".lab-ask").click()
    page.locator(".lab-judge[data-judge=companion]").click()
    until(lambda: "companion" in summary(page), "another judge")


def test_a_strangers_minute(server, chromium, tmp_path):
    """One visitor for all: a page of their own would cost each more than what is looked at."""
    with visit(chromium, server[0], "#") as page:
        leave_introduction(page)
        there_are_few_controls(page)
        pause(page)
        keys_reach_all(page)
        a_drag_shows_the_first_crossing(page)
        every_place_says_the_same(page, tmp_path)
        a_second_run_follows(page)
        cost_is_filled(page)
        undo_goes_back(page)
        no_change_loses_the_instant(page)
