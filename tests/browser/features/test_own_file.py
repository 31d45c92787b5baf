"""A file of one's own code in a real browser: chosen, dropped, judged, played, and gone again."""

import re

import numpy as np
import pytest

from app.cli import main
from tests.browser.driving import click, coloured, readout, row, scene, shown, stage, steps, to_the_ring, until
from tests.support.session_listener import PATIENCE

FIELD = "[data-lab~=lab-upload] + div input[type=file]"
#: Drags a text as a file over the stage, and lets it fall there.
DROP = """([name, text]) => {
    const what = new DataTransfer(), at = document.querySelector("canvas");
    what.items.add(new File([text], name));
    for (const kind of ["dragover", "drop"])
        at.dispatchEvent(new DragEvent(kind, {dataTransfer: what, bubbles: true, cancelable: true}));
}"""


def notice(page):
    return " ".join(page.locator(".lab-notice").all_inner_texts())


@pytest.fixture(scope="module")
def ring(tmp_path_factory):
    """A run of ours as a file."""
    file = tmp_path_factory.mktemp("ring") / "mine.npz"
    assert main(["run", "ring", "--cells", "12", "--periods", "0.5", "--particles", str(file), "--quiet"]) == 0
    return file


@pytest.mark.slow
def test_a_file_is_chosen_judged_and_left(page, ring):
    """It is played to its end and back; the run rests meanwhile, and goes on when one comes back."""
    to_the_ring(page)
    until(lambda: scene(page)["problem"] == "ring" and steps(page) > 0, "the ring", PATIENCE)
    link = page.url
    page.get_by_text("Your own code, judged").click()
    with page.expect_file_chooser() as chooser:
        click(page, "Choose a file")
    chooser.value.set_files(ring)
    until(lambda: "mine.npz" in readout(page), "the file on the stage", PATIENCE)
    until(lambda: "Worst of all" in readout(page), "the verdict", PATIENCE)
    last = re.search(r"frame\s+\d+ of (\d+)", readout(page))[1]
    until(lambda: f"frame\t{last} of {last}" in readout(page), "it is played to its end", PATIENCE)
    assert coloured(stage(page)) > 0.02  # of which the colour bar is a half
    shown(page, "At t = 0.01 s in mine.npz the displacement is")
    assert page.url == link
    picture = stage(page)
    row(page, "Frame").get_by_role("slider").focus()
    page.keyboard.press("Home")
    until(lambda: f"frame\t1 of {last}" in readout(page), "its first time")
    until(lambda: np.any(np.abs(stage(page) - picture) > 30, axis=2).mean() > 0.01, "another picture")
    click(page, "Play")
    until(lambda: f"frame\t{last} of {last}" in readout(page), "the file is played again", PATIENCE)
    click(page, "Back to our run")
    until(lambda: "periods" in readout(page) and "mine.npz" not in readout(page), "our run")
    before = steps(page)
    until(lambda: steps(page) > before, "it goes on")


@pytest.mark.short
def test_a_file_that_cannot_be_judged_is_said_and_nothing_is_lost(page):
    """Dropped on the stage; then one that can, beside which there is nothing of the run."""
    until(lambda: steps(page) > 20, "a run under way")
    page.evaluate(DROP, ["wrong.csv", "id,x\n0,0.5\n"])
    until(lambda: "The file wrong.csv has no time; give a column t" in notice(page), "why not", PATIENCE)
    before = steps(page)
    until(lambda: steps(page) > before, "the run goes on")
    page.evaluate(DROP, ["right.csv", "id,x,t\n0,0.503125,0.1\n1,0.51,0.1\n"])
    until(lambda: "right.csv" in readout(page), "the file on the stage", PATIENCE)
    said = readout(page)  # once: what is at work now may have ended a moment later
    assert "velocity" in said or "still at work" in said
    until(lambda: "No velocity was read" in readout(page), "what it has not", PATIENCE)
    until(lambda: not page.get_by_text("Change the run").is_visible(), "no controls of the run")
    assert page.get_by_role("button", name=re.compile("^(Play|Pause)$")).count() == 1
    click(page, "Back to our run")
    until(lambda: "right.csv" not in readout(page) and page.get_by_text("Change the run").is_visible(), "our run")


def test_a_file_that_is_too_large_is_not_even_sent(page):
    page.evaluate("""field => {
        const what = new DataTransfer();
        field = document.querySelector(field);
        what.items.add(new File([new Uint8Array(33e6)], "large.csv"));
        field.files = what.files;
        field.dispatchEvent(new Event("change", {bubbles: true}));
    }""", FIELD)
    until(lambda: "The file is larger than 32 MB" in notice(page), "why not")
    assert "coming" not in notice(page)
