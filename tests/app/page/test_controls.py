"""Every control of a scene reaches the field that it names, and no other. No browser, and no engine: a visitor's values
come as they would from a browser, and what an engine is asked for tells the scene."""

from __future__ import annotations

import json
import math
from dataclasses import fields

import pytest

from app import shareable_state
from app.names_and_units import CHOICES
from app.page.visit.first_scene import first_scene
from solvers.scene.effects import ALL
from solvers.scene.estimator_registry import ESTIMATORS
from solvers.scene.stabilisations import REMEDIES
from tests.support import page_server
from tests.support.processes import wait_until
from tests.support.raw_client import RawClient

#: What a problem is called, and the hint of its cells.
FIRST_SCENE = first_scene("bar")
BEGINNINGS = {"bar": ("vibrating bar", "grid cells across 1 m"), "ring": ("expanding ring", "grid cells across 1.2 m"),
              "vortex": ("generalized vortex", "grid cells across 3 m")}
#: Labels of sliders, which show logarithms.
LOGARITHMS = {"Amplitude A": "amplitude", "Modulus E": "modulus", "CFL number": "cfl"}
DROPDOWNS = {"Body force": "body_force", "Velocity": "velocity", "Layout": "layout"}
TOGETHER = ("corners",)  # goes with one method only
BOXES = {"estimators": {name: one.title for name, one in ESTIMATORS.items()},
         "remedies": {name: one.label for name, one in REMEDIES.items()},
         "effects": {name: one.label for name, one in ALL.items()}}


@pytest.fixture
def asked(monkeypatch):
    """The scenes that engines were asked for, in order."""
    scenes, ask = [], page_server.SilentLink.ask

    def listening(link, scene, *others, **more):
        scenes.append(scene)
        return ask(link, scene, *others, **more)

    monkeypatch.setattr(page_server.SilentLink, "ask", listening)
    return scenes


class Driver:
    """Moves controls of one page, and knows what may be another in its scene then."""

    def __init__(self, visitor: RawClient, asked: list, problem: str):
        self.visitor, self.asked = visitor, asked
        title, cells = BEGINNINGS[problem]
        visitor.find("Download CSV")  # the last of the controls
        opened = visitor.find("step margin")
        visitor.follow(shareable_state.write_state(shareable_state.State(FIRST_SCENE)))
        wait_until(lambda: asked and asked[-1] == FIRST_SCENE, "the first scene")
        wait_until(lambda: visitor.find("step margin") != opened, "its controls in place of the opening's")
        if problem != "bar":
            visitor.set(visitor.find("Problem"), title)
        visitor.find(cells)
        visitor.find("step margin")
        wait_until(lambda: asked and asked[-1].problem == problem, f"the {problem}")

    @property
    def scene(self):
        return self.asked[-1]

    def move(self, label: str, value: object, **wanted) -> None:
        """What a browser says when a control is moved to a value. Then these fields of the scene are as wanted, and all
        others as before."""
        self._expect(lambda: self.visitor.set(self.visitor.find(label), value), label, **wanted)

    def choose_method(self, method: str) -> None:
        """What a browser says when the tile of a method is clicked."""
        self._expect(lambda: self.visitor.set(self.visitor.find("kept by the browser"), json.dumps({"method": method})),
                     "Method", method=method)

    def _expect(self, act, label: str, **wanted) -> None:
        before = self.scene
        act()
        wait_until(lambda: all(getattr(self.scene, name) == one for name, one in wanted.items()), f"{label}: {wanted}")
        changed = {field.name for field in fields(before)
                   if getattr(self.scene, field.name) != getattr(before, field.name)}
        assert changed == set(wanted), label


@pytest.fixture(params=BEGINNINGS)
def driver(request, here, asked):
    with RawClient(here[1]) as visitor:
        yield Driver(visitor, asked, request.param)


def test_numbers(driver):
    """Sliders whose steps are factors say logarithms."""
    before = driver.scene
    for label, field, to in (("Cells", "cells", before.cells + 12), ("Particles / cell", "ppc", before.ppc - 1)):
        driver.move(label, math.log10(to), **{field: to})
    for label, field in LOGARITHMS.items():
        to = math.log10(before.courant_number if field == "cfl" else getattr(before, field)) - 0.1
        driver.move(label, to, **{field: pytest.approx(10**to, rel=6e-3)})
    driver.move("Auto step", True, cfl=None, dt="auto")


def test_choices(driver):
    """Each dropdown, one after the other, to its last choice and back."""
    for label, field in DROPDOWNS.items():
        if first := getattr(driver.scene, field, None):
            others = [name for name in type(driver.scene).choices(field) if name not in (first, *TOGETHER)]
            for name in (*others, first):
                driver.move(label, CHOICES[field][name], **{field: name})


def test_methods(driver):
    """Each tile, one after the other, and back to the first."""
    first = driver.scene.method
    for name in (*(name for name in type(driver.scene).choices("method") if name != first), first):
        driver.choose_method(name)


def test_boxes(driver):
    """Each box turns its own name about, and comes back; frozen weights stand alone. Not all remedies go with CPDI."""
    if driver.scene.method != "ugimp":
        driver.choose_method("ugimp")
    for field, labels in BOXES.items():
        names = type(driver.scene).choices(field)
        for name in names:
            for _ in ("there", "and back"):
                held = getattr(driver.scene, field)
                driver.move(labels[name], name not in held,
                            **{field: tuple(one for one in names if (one in held) != (one == name))})
