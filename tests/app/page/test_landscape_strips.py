"""Strips under the sliders: what a row says to the browser, what the browser says of the hand, and the time step that a
modulus keeps."""

from __future__ import annotations

import contextlib
import json
import math
from dataclasses import replace
from threading import RLock
from types import SimpleNamespace

import pytest

from app.page.panels.landscape_strips import LandscapeStrips, row_data, words_beside
from app.page.panels.log_number_slider import SliderSpec
from solvers.problems.bar.scene import BarScene
from solvers.study.landscape.landscape import Landscape, LandscapeRequest
from tests.support.processes import wait_until
from tests.support.raw_client import RawClient

BAR = BarScene(cells=40, ppc=4, cfl=0.05)
STIFFNESS = SliderSpec("Modulus E", "Pa", (1.0, 1000.0), 4.0, "")


def test_a_row_says_its_points_in_few_digits_and_nothing_of_those_that_are_unknown():
    request = LandscapeRequest(BAR, "cells", 0.25, "sigma", "recovered", (8, 160, 1))
    landscape = Landscape(request, (36, 40), (0.0401234567, math.nan), (0.04, math.nan), (1e-3, 2e-3),
                          ("ok", "pending"), 37, None, flat=False, complete=False)
    row = row_data("cells", SliderSpec("Cells", "", (8, 160), 40, "", 1), BAR, ("red", (7, 3)), landscape)
    assert row == {"words": "h = 25 mm", "unit": "", "multiple": 1, "line": ["red", "7 3"], "v": [36, 40],
                   "true": [0.04012, None],
                   "est": [0.04, None], "sec": [0.001, 0.002], "state": ["ok", "pending"], "flat": False, "cross": 37,
                   "bound": None, "complete": False}


@pytest.mark.parametrize(("step", "kept"), [({"cfl": 0.05}, "cfl"), ({"dt": 1e-4}, "dt"), ({"dt": "auto"}, "cfl")])
def test_the_row_of_the_modulus_says_what_it_keeps(step, kept):
    assert row_data("modulus", STIFFNESS, BarScene(**step), ("red", ()), None)["keeps"] == kept


def test_words_beside_a_name_are_of_the_scene():
    assert [words_beside(name, BAR) for name in ("cells", "cfl", "modulus")] == ["h = 25 mm", "CFL 0.05 = 625 µs", ""]


def test_nothing_is_requested_while_no_strip_is_seen():
    """A browser says so, and which slider is in the hand; anything else that it says means nothing."""
    requests, store = [], SimpleNamespace(heard={})
    landscapes = SimpleNamespace(request=lambda hand, until, *about, held: requests.append((hand, until, *about, held)),
                                 curves=dict)
    gui = SimpleNamespace(add_html=lambda content: SimpleNamespace(content=content))
    strips = LandscapeStrips(gui, SimpleNamespace(scene=BAR), landscapes, store, RLock(), lambda: ("sigma", None))
    strips.build_heading(gui)
    report = SimpleNamespace(time=0.25 * BAR.period, scene=BAR)
    for message in (7, {"hand": "cells"}, {"seen": 1, "hand": "cells"}, {"seen": True, "hand": "cells", "held": True},
                    {"seen": True, "hand": ["cells"]}):
        store.heard["strips"](message)
        strips.follow(report)
    assert requests == [("cells", 0.25, "sigma", None, True), (None, 0.25, "sigma", None, False)]


@pytest.mark.parametrize("playing", [False, True])
def test_a_change_of_a_run_at_rest_requests_its_strips_before_its_frame_comes(playing):
    requests, store = [], SimpleNamespace(heard={})
    session = SimpleNamespace(scene=BAR, playing=playing, first_instant=0.3)
    landscapes = SimpleNamespace(request=lambda hand, until, *_, held: requests.append(until), curves=dict)
    gui = SimpleNamespace(add_html=lambda content: SimpleNamespace(content=content),
                          add_slider=lambda *_, **__: SimpleNamespace(min=0, max=9),
                          add_text=lambda *_, **__: SimpleNamespace())
    bound = SimpleNamespace(on_change=lambda *_: None, on_enter=lambda *_: None, turn=contextlib.nullcontext(),
                            apply_or_reset=lambda widget, act, reset: act() or True)
    strips = LandscapeStrips(gui, session, landscapes, store, RLock(), lambda: ("x", None))
    slider = strips.add(gui, bound, "modulus", STIFFNESS, 4.0,
                        lambda value: value > 8 and setattr(session, "scene", replace(BAR, modulus=value)))
    store.heard["strips"]({"seen": True})
    slider.choose(7.0)  # refused
    assert not requests
    slider.choose(9.0)
    assert requests == ([] if playing else [0.3])


def test_a_kept_time_step_moves_the_cfl_number_along(here):
    """The switch keeps the step in seconds: 256 times the stiffness is 16 times the CFL number; and back."""
    with RawClient(here[1]) as visitor:
        cfl, modulus = visitor.find("CFL number, typed"), visitor.find("Modulus E, typed")

        def tell(**message):
            visitor.set(visitor.find("kept by the browser"), json.dumps(message))

        def shows(widget, text):
            wait_until(lambda: visitor.widgets[widget]["value"] == text, text)

        tell(keep="dt")
        tell(point=["modulus", 4 * 256])
        shows(modulus, "1.024 kPa")
        shows(cfl, "0.8")
        tell(point=["cfl", 0.4])
        shows(cfl, "0.4")
        tell(keep="cfl")
        tell(point=["modulus", 4.0])
        shows(modulus, "4 Pa")
        shows(cfl, "0.4")
