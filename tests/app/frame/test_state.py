"""The text of what is on the stage: it means the same scene wherever it is read."""

from __future__ import annotations

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.cli import main
from app.state import VIEW, State, StateError, read, write
from solvers.problems.bar.scene import BarScene
from solvers.problems.ring.scene import RingScene

BAR = BarScene(method="mpm", cells=20, amplitude=0.03, linearity_preserving=True, estimators=("recovered", "companion"))
STATES = [
    State(BarScene()), State(RingScene(method="cpdi", dt="auto")), State(BAR, "sigma", "companion", True, 100, True),
    State(RingScene(estimators=()), domains=True, speed=0.25, traced=17, stops=True),
    State(BAR, pinned=BarScene(method="bspline", remedies=("null-space-filter",))),
    State(BarScene(effects=("truth",), estimators=("two-grid",), cfl=None, dt=1e-3 / 3))]


@pytest.mark.parametrize("state", STATES, ids=write)
def test_a_state_is_read_as_it_was_written(state):
    assert read(write(state)) == state
    assert read(write(state).replace(";", " ")) == state
    assert read(write(state).replace(";", "&")) == state


@given(cells=st.integers(4, 200), amplitude=st.floats(1e-9, 0.15), cfl=st.floats(1e-3, 2), ppc=st.integers(1, 8))
def test_numbers_come_back_to_the_bit(cells, amplitude, cfl, ppc):
    state = State(BarScene(cells=cells, amplitude=amplitude, cfl=cfl, ppc=ppc))
    assert read(write(state)) == state


def test_defaults_are_left_out():
    assert write(State(BarScene())) == "bar"
    assert write(State(BarScene(cells=80), stops=True)) == "bar;cells=80;stops"


@pytest.mark.parametrize("text, said", [
    ("", "begin with bar or ring"), ("cube", "'cube' is no problem"), ("bar;cels=3", "did you mean cells?"),
    ("bar;cells=x", "cells=x: give a whole number"), ("bar;amplitude=9", "inverts"),
    ("bar;dt=1e-3;cfl=.1", "one of the two"),
    ("ring;method=bspline", "give one of ugimp"), ("bar;error-of=q", "give one of x, v, sigma, a"),
    ("bar;on-stage=companion", "does not run"), ("bar;trace=999", "particles 0 to 159"), ("bar;trace=-1", "0 or more"),
    ("bar;magnify=3", "give one of 1, 10, 100, 1000"), ("bar;speed=0", "above 0"), ("bar;speed=inf", "above 0"),
    ("bar;stops=perhaps", "give yes or no"), ("bar;linearity-preserving=x", "give yes or no"),
    ("bar;pinned;method=cpdi", "give one of mpm"), ("bar;" + "x" * 3000, "too long"),
    ("bar;estimators=none,all", "not known"),
])
def test_what_is_no_state_is_refused_in_a_sentence(text, said):
    with pytest.raises(StateError) as refusal:
        read(text)
    assert said in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_every_word_of_the_view_sets_a_field_of_its_own():
    assert len({word.field for word in VIEW.values()}) == len(VIEW)


@pytest.mark.parametrize("text", ["bar;cells=8;ppc=2;periods=0.1;error-of=v;pinned;cells=20",
                                  "http://127.0.0.1:8080/#bar;cells=8;ppc=2;periods=0.1"])
def test_the_same_text_runs_without_a_page(text, capfd):
    assert main(["run", "--scene", text, "--json", "-", "--quiet"]) == 0
    scene = json.loads(capfd.readouterr().out)["scene"]
    assert (scene["problem"], scene["cells"], scene["ppc"], scene["periods"]) == ("bar", 8, 2, 0.1)


@pytest.mark.parametrize("arguments", [["run", "--scene"], ["run", "--scene="], ["run", "--scene", "bar;cells=3"]])
def test_a_bad_scene_is_bad_input(arguments, capfd):
    assert main(arguments) == 2
    said = capfd.readouterr().err
    assert said.startswith("mpm-lab: --scene") and said.count("\n") == 1
