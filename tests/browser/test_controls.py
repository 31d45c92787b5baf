"""Every control of a scene reaches the field that it names, and no other: read back from the scene that runs."""

from __future__ import annotations

from contextlib import contextmanager

import pytest

from app.words import CHOICES
from solvers.bar.scene import BarScene
from solvers.effects import EFFECTS
from solvers.estimators.registry import ESTIMATORS
from solvers.remedies import REMEDIES
from solvers.ring.scene import RingScene
from tests.browser.driving import choose, click, press, row, scene, to_the_ring, unfold, until


@contextmanager
def changes(page, **fields):
    """What is done within changes these fields of the running scene, to these values, and leaves all others."""
    before = scene(page)
    yield

    def met(name, wanted):
        value = scene(page)[name]
        return wanted(value) if callable(wanted) else value == wanted

    until(lambda: all(met(name, wanted) for name, wanted in fields.items()), f"a scene with {fields}")
    after = scene(page)
    assert {name for name in after if after[name] != before[name]} == set(fields)


def fill(page, label, value):
    row(page, label).locator("input.mantine-NumberInput-input").fill(value)


def tick(page, label):
    row(page, label).get_by_role("checkbox").click()


def test_numbers_of_the_bar(page):
    """Sliders whose steps are factors move by these; what is typed is meant."""
    with changes(page, cells=24):
        fill(page, "Cells, h = 1/", "24")
    page.get_by_text("Cells, h = 1/24").wait_for()
    with changes(page, ppc=2):
        fill(page, "Particles / cell", "2")
    with changes(page, amplitude=lambda A: A == pytest.approx(0.025 * 10**-0.1, rel=6e-3)):
        press(page, "Amplitude A", "ArrowLeft", 20)
    with changes(page, modulus=lambda E: E == pytest.approx(4 * 10**0.1, rel=6e-3)):
        press(page, "Modulus E", "ArrowRight", 20)
    with changes(page, cfl=lambda cfl: cfl == pytest.approx(0.05 * 10**0.1, rel=6e-3)):
        press(page, "CFL number", "ArrowRight", 20)
    with changes(page, cfl=None, dt="auto"):
        tick(page, "Auto step")


def test_choices_and_boxes_of_the_bar(page):
    """Each dropdown and each box, one after the other; what a box took away comes back with it. Small: much is
    compiled."""
    fill(page, "Cells, h = 1/", "20")
    until(lambda: scene(page)["cells"] == 20, "a small bar")
    click(page, "Pause")
    for name in ("recovered", "transport"):
        left = [other for other in scene(page)["estimators"] if other != name]
        with changes(page, estimators=left):
            tick(page, ESTIMATORS[name].title)
    unfold(page, "Method details", "Effects: compute")
    for label, field, code in (("Method", "method", "mpm"), ("Body force", "body_force", "node"),
                               ("Velocity", "velocity", "particle")):
        with changes(page, **{field: code}):
            choose(page, label, CHOICES[field][code])
    with changes(page, linearity_preserving=True):
        tick(page, "Linearity preserving")
    for field, kinds in (("remedies", REMEDIES), ("effects", EFFECTS)):
        for name in BarScene.choices(field):
            if name == "frozen-weights":
                continue  # stands alone: refused beside the others
            before = scene(page)[field]
            wanted = [n for n in BarScene.choices(field) if (n in before) != (n == name)]
            with changes(page, **{field: wanted}):
                tick(page, kinds[name].label)


def test_controls_of_the_ring(page):
    to_the_ring(page)
    until(lambda: scene(page)["problem"] == "ring" if "problem" in scene(page) else "layout" in scene(page), "the ring")
    with changes(page, cells=12):
        fill(page, "Cells, h = ", "12")
    click(page, "Pause")
    with changes(page, ppc=1):
        fill(page, "Particles / cell", "1")
    with changes(page, modulus=lambda E: E == pytest.approx(RingScene().modulus * 10**0.1, rel=6e-3)):
        press(page, "Modulus E", "ArrowRight", 20)
    with changes(page, amplitude=lambda A: A == pytest.approx(RingScene().amplitude * 10**-0.1, rel=6e-3)):
        press(page, "Amplitude A", "ArrowLeft", 20)
    unfold(page, "Method details")
    with changes(page, layout="cartesian"):
        choose(page, "Layout", CHOICES["layout"]["cartesian"])
    with changes(page, estimators=[]):
        tick(page, ESTIMATORS["transport"].title)
