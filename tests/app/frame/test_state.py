"""The text of what is on the stage: it means the same scene wherever it is read."""

import json

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from app.cli import main
from app.names_and_units import MAGNIFICATIONS, QUANTITIES
from app.shareable_state import State, StateError, parse_state, write_state
from solvers.problems import PROBLEMS
from solvers.problems.bar.scene import BarScene
from solvers.problems.ring import RingScene
from solvers.problems.vortex import VortexScene
from tests.support.random_scenes import ASKED, SETS, inputs

BAR = BarScene(method="mpm", cells=20, amplitude=0.03, linearity_preserving=True, estimators=("recovered", "companion"))
STATES = [
    State(BarScene()), State(RingScene(method="cpdi", dt="auto")), State(BAR, "sigma", "companion", True, 100, True),
    State(VortexScene(method="cpgimp-v", cells=24, effects=("truth", "spin"), poisson_ratio=0.4, frequency=2.0)),
    State(RingScene(estimators=()), domains=True, speed=0.25, traced=17, stops=True),
    State(BarScene(cells=20), "sigma", compared="bspline"),
    State(BAR, pinned=BarScene(method="bspline", remedies=("null-space-filter",))),
    State(BarScene(effects=("truth",), estimators=("two-grid",), cfl=None, dt=1e-3 / 3))]


@pytest.mark.parametrize("state", STATES, ids=write_state)
def test_a_state_is_read_as_it_was_written(state):
    assert parse_state(write_state(state)) == state
    assert parse_state(write_state(state).replace(";", " ")) == state
    assert parse_state(write_state(state).replace(";", "&")) == state


@pytest.mark.parametrize("switches", SETS, ids=str)
def test_any_state_comes_back_to_the_bit(switches):
    """Random scenes and views of every kind of problem; what a text does not say, as threads, is as it was."""
    @settings(max_examples=20, suppress_health_check=list(HealthCheck))
    @given(inputs(switches), st.sampled_from(list(QUANTITIES)), st.booleans(), st.booleans(),
           st.sampled_from(MAGNIFICATIONS), st.none() | st.floats(1e-3, 10.0), st.booleans())
    def same(drawn, quantity, difference, logarithmic, magnified, speed, stops):
        scene = PROBLEMS[drawn["problem"]].scene(**drawn)
        state = State(scene, quantity, None, difference, magnified, logarithmic, speed=speed, stops=stops,
                      pinned=type(scene)() if stops else None)
        assert parse_state(write_state(state)) == state

    same()


def test_defaults_are_left_out():
    assert write_state(State(BarScene())) == "bar"
    assert write_state(State(BarScene(cells=80), stops=True)) == "bar;cells=80;stops"


@pytest.mark.parametrize("text, said", [
    ("", "begin with bar or square"), ("cube", "'cube' is no problem"), ("bar;cels=3", "did you mean cells?"),
    ("bar;cells=x", "cells=x: give a whole number"), ("bar;amplitude=9", "inverts"),
    ("bar;dt=1e-3;cfl=.1", "one of the two"),
    ("ring;method=bspline", "give one of ugimp"), ("bar;error-of=q", "give one of x, v, sigma, a"),
    ("bar;on-stage=recovered", "does not run"), ("bar;trace=999", "particles 0 to 159"), ("bar;trace=-1", "0 or more"),
    ("bar;magnify=3", "give one of 1, 10, 100, 1000"), ("bar;speed=0", "above 0"), ("bar;speed=inf", "above 0"),
    ("bar;compare=cpdi", "give one of mpm"), ("bar;compare=mpm;pinned", "and no pinned run"),
    ("bar;stops=perhaps", "give yes or no"), ("bar;linearity-preserving=x", "give yes or no"),
    ("bar;pinned;method=cpdi", "give one of mpm"), ("bar;" + "x" * 3000, "too long"),
    ("bar;estimators=none,all", "not known"),
    ("bar;__class__=1", "'__class__=1' means nothing here; give what"), ("bar;__dict__", "means nothing here"),
    ("bar;problem=ring", "the problem stands once, as the first word"), ("ring;problem", "the problem stands once"),
    ("bar;bar", "the problem stands once"), ("bar;pinned;pinned", "pinned stands once"),
    ("bar;pinned;ring", "the pinned run is of the bar too"), ("bar;pinned=1", "pinned stands once, alone"),
    ("bar;pinned;speed=1", "is of the view, which both runs share"), ("bar;pinned;cels=3", "did you mean cells?"),
    ("bra", "did you mean bar?"), ("bar;method=ugipm", "did you mean ugimp?"), ("bar;error-of=sigm", "mean sigma?"),
    ("bar;spede=1", "did you mean speed?"), ("bar;zzz", "means nothing here; give"),
    ("bar;cells=20;cells=40", "cells is given twice"), ("bar;t_end=1;t-end=1", "t-end is given twice"),
    ("bar;estimate=none;estimators=none", "estimators is given twice"),
    ("bar;speed=1;speed=1", "speed is given twice"),
    ("bar;cells=" + "9" * 1900, "999…999"), ("bar;trace=٣", "0 or more"), ("bar;speed=nan", "above 0"),
    ("bar;\x1b[31mred=1", r"'\x1b[31mred=1' means nothing"), ("bar;%1b%5b31m", r"'\x1b[31m' means nothing"),
    ("bar;cells=%E2%80%AE4", r"cells=\u202e4: give a whole number"), ("bar;=", "means nothing here"),
    ("companion," * 190, "is no problem"), ("bar;estimators=" + "companion," * 190, "names something twice"),
    (";;; \n", "'' is no problem"),
])
def test_what_is_no_state_is_refused_in_a_sentence(text, said):
    with pytest.raises(StateError) as refusal:
        parse_state(text)
    assert said in str(refusal.value)
    assert str(refusal.value).isprintable() and len(str(refusal.value)) <= 400


PARTS = st.sampled_from([
    "bar", "ring", "vortex", "pinned", "cells", "method=mpm", "cells=20", "cells=1e2", "t-end", "periods=.5", "cfl=0.1",
    "dt=auto", "estimators=all", "effects=none", "stops", "speed=2", "trace=3", "on-stage=transport", "problem", "=",
    "",    "__init__=1", "linearity-preserving=no", "remedies=frozen-weights", "%1b", "amplitude=0.01"])


@settings(max_examples=400 if ASKED is None else ASKED, suppress_health_check=list(HealthCheck))
@given(st.lists(PARTS | st.text(max_size=12), max_size=7), st.sampled_from([";", "&", " ", "\n", ""]))
def test_any_text_is_a_state_that_comes_back_or_is_refused_shortly(parts, mark):
    """And a whole link, or what is none."""
    for text in (mark.join(parts), mark.join(["bar", *parts])):
        try:
            state = parse_state(text)
        except StateError as error:
            assert str(error).isprintable() and len(str(error)) <= 400
        else:
            assert parse_state(write_state(state)) == state


@pytest.mark.parametrize("text", ["bar;cells=8;ppc=2;periods=0.1;error-of=v;pinned;cells=20",
                                  "http://127.0.0.1:8080/#bar;cells=8;ppc=2;periods=0.1"])
def test_the_same_text_runs_without_a_page(text, capfd):
    assert main(["run", "--scene", text, "--json", "-", "--quiet"]) == 0
    scene = json.loads(capfd.readouterr().out)["scene"]
    assert (scene["problem"], scene["cells"], scene["ppc"], scene["periods"]) == ("bar", 8, 2, 0.1)
