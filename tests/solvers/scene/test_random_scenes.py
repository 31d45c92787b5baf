"""Random scenes: each is refused in one sentence or ends as ok, unstable or lost, and no ok is far from the truth."""

import json

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from solvers.problems import PROBLEMS
from solvers.running.run import run
from solvers.scene.validation import SceneError
from solvers.solver.soundness import LOST, NOUNS, OK, UNSTABLE
from solvers.solver.verdict_basis import large_errors
from tests.support.random_scenes import ASKED, RARE, Inputs, inputs, odd_inputs, scenes_a_set, switch_sets

MOST_ERROR = 0.5  # amplitudes of the motion, of x: no run beyond it may be called ok
PRICED = 8  # one in so many runs measures its estimators' prices as well, which takes tenths of a second

here = settings(max_examples=scenes_a_set(), derandomize=ASKED is None, database=None,
                suppress_health_check=list(HealthCheck))
SETS = switch_sets()


def named(switches: Inputs) -> str:
    words = [" ".join(value) if isinstance(value, tuple) else str(value) for value in switches.values()]
    return "-".join(filter(None, words)).replace(" ", "+")


@pytest.mark.parametrize("switches", [
    pytest.param(switches, marks=pytest.mark.slow if switches in RARE and not ASKED else (), id=named(switches))
    for switches in SETS])
def test_a_random_scene_ends_well_or_says_that_it_did_not(switches):
    @here
    @given(inputs(switches), st.integers(1, PRICED))
    def ends(drawn, turn):
        check(drawn, prices=turn == PRICED)

    ends()


def check(drawn: Inputs, prices: bool) -> None:
    """Run a scene, and hold its verdict against what is known."""
    scene = PROBLEMS[drawn["problem"]].scene(**drawn)
    scene.warnings()
    result = run(scene, prices=prices)
    assert result.status in (OK, UNSTABLE, LOST)
    large = large_errors(scene, result.series, result.not_valid)
    assert (result.reason is None) == (result.status == OK and not large)
    assert result.reason is None or (result.reason.isprintable() and "nan" not in result.reason.split())
    json.dumps(result.to_dict(), allow_nan=False)
    if result.status == OK:
        assert np.isfinite(result.final.position).all() and np.isfinite(result.final.deformation_gradient).all()
        if scene.has("truth"):
            assert result.series["error_x"].max() <= MOST_ERROR * scene.motion_amplitude
            assert {q for q in ("v", "sigma", "a") if np.nanmax(result.series[f"error_{q}"], initial=0.0)
                    > scene.rms_of(q)} == large.keys()
            assert all(NOUNS[q] in result.reason for q in large)


@pytest.mark.parametrize("problem", PROBLEMS)
def test_odd_inputs_are_refused_in_one_sentence(problem):
    @settings(here, max_examples=300 if ASKED is None else ASKED)
    @given(odd_inputs(problem))
    def refused(drawn):
        try:
            scene = PROBLEMS[problem].scene(**drawn)
        except SceneError as error:
            assert error.field in drawn
            assert error.sentence and error.sentence.isprintable() and not error.sentence.endswith(".")
            return
        json.dumps(scene.to_dict(), allow_nan=False)
        hash(scene)
        scene.warnings()

    refused()
