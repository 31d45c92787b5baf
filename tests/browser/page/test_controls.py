"""Every control of a scene reaches the field that it names, and no other: read back from the scene that runs. Those of
all problems are in tests/app/page/test_controls.py, without a browser; here the bar's sliders are for every day."""

from __future__ import annotations

from contextlib import contextmanager

import pytest

from app.words import CHOICES
from solvers.problems.bar.scene import BarScene
from solvers.problems.ring.scene import RingScene
from solvers.scene.effects import EFFECTS
from solvers.scene.registry import ESTIMATORS
from solvers.scene.remedies import FROZEN, REMEDIES
from tests.browser.driving import choose, click, press, row, scene, tick, to_the_ring, unfold, until


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


def choose_each(page, wanted):
    """From each dropdown with one of these labels the name of ``code``, for the field."""
    for label, field, code in wanted:
        with changes(page, **{field: code}):
            choose(page, label, CHOICES[field][code])


def click_boxes(page, field, names, choices, labels):
    """The boxes of these ``names``, one after the other, each of which turns its own name in the field about."""
    for name in names:
        before = scene(page)[field]
        with changes(page, **{field: [n for n in choices if (n in before) != (n == name)]}):
            tick(page, labels[name])


def click_all_boxes(page, kind):
    """Every box of the estimators, the remedies and the effects of this kind of scene, estimators first, those that are
    there until there are none, then each other alone: that compiles faster, and so does what follows. Frozen weights
    stand alone, and so go before the other remedies come."""
    estimators, remedies, effects = (kind.choices(field) for field in ("estimators", "remedies", "effects"))
    present = scene(page)["estimators"]
    alone = [name for name in estimators if name not in present for _ in ("on", "off")]
    click_boxes(page, "estimators", [*present, *alone], estimators,
                {name: estimator.title for name, estimator in ESTIMATORS.items()})
    together = [name for name in remedies if name != FROZEN]
    click_boxes(page, "remedies", [FROZEN, FROZEN, *together], remedies,
                {name: remedy.label for name, remedy in REMEDIES.items()})
    click_boxes(page, "effects", effects, effects, {name: effect.label for name, effect in EFFECTS.items()})


@pytest.mark.slow
def test_choices_and_boxes_of_the_bar(page):
    """Each dropdown and each box, one after the other; what a box took away comes back with it. Small: much is
    compiled."""
    fill(page, "Cells, h = 1/", "20")
    until(lambda: scene(page)["cells"] == 20, "a small bar")
    click(page, "Pause")
    unfold(page, "Method details", "Effects: compute")
    click_all_boxes(page, BarScene)  # first: frozen weights do not go with what follows
    choose_each(page, (("Method", "method", "mpm"), ("Body force", "body_force", "node"),
                       ("Velocity", "velocity", "particle")))
    with changes(page, linearity_preserving=True):
        tick(page, "Linearity preserving")


@pytest.mark.slow
def test_numbers_of_the_ring(page):
    to_the_ring(page)
    until(lambda: "layout" in scene(page), "the ring")
    with changes(page, cells=12):
        fill(page, "Cells, h = ", "12")
    click(page, "Pause")
    with changes(page, ppc=1):
        fill(page, "Particles / cell", "1")
    with changes(page, modulus=lambda E: E == pytest.approx(RingScene().modulus * 10**0.1, rel=6e-3)):
        press(page, "Modulus E", "ArrowRight", 20)
    with changes(page, amplitude=lambda A: A == pytest.approx(RingScene().amplitude * 10**-0.1, rel=6e-3)):
        press(page, "Amplitude A", "ArrowLeft", 20)
    with changes(page, cfl=lambda cfl: cfl == pytest.approx(0.05 * 10**0.1, rel=6e-3)):
        press(page, "CFL number", "ArrowRight", 20)
    with changes(page, cfl=None, dt="auto"):
        tick(page, "Auto step")


@pytest.mark.slow
def test_choices_and_boxes_of_the_ring(page):
    """Without a body force there is no truth to compute, and less to compile."""
    to_the_ring(page)
    until(lambda: "layout" in scene(page), "the ring")
    fill(page, "Cells, h = ", "12")
    until(lambda: scene(page)["cells"] == 12, "a small ring")
    click(page, "Pause")
    unfold(page, "Method details", "Effects: compute")
    choose_each(page, (("Body force", "body_force", "none"), ("Method", "method", "mpm"),
                       ("Layout", "layout", "cartesian"), ("Velocity", "velocity", "particle")))
    click_all_boxes(page, RingScene)
