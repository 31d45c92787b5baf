"""The vortex in what shows problems: state, page, recording, slow motion."""

import numpy as np
import pytest

from app import state
from app.export.record import Wanted, recording
from app.page.visit.session import first_scene
from app.problems.views import VIEWS
from app.words import choices, unit_of
from solvers.problems import PROBLEMS
from solvers.problems.planar.layout import particle_layout
from solvers.problems.vortex import VortexScene
from solvers.running.run import build
from solvers.study.stability import offered


def test_a_state_and_words():
    text = "vortex;method=cpgimp-v;cells=24;effects=truth,spin;poisson-ratio=0.4;frequency=2"
    assert state.write(state.read(text)) == text
    assert offered(VortexScene) == ("plain", "filter", "frozen")
    assert choices(VortexScene, "method")["cpgimp-v"] == "cpGIMP with the spatial stretch V"
    assert [unit_of(PROBLEMS[name].scene, "amplitude") for name in ("bar", "ring", "vortex")] == ["m", "m", "rad"]


def test_the_page_begins_with_half_a_period_and_an_estimate_that_holds():
    first = first_scene("vortex")
    assert first.end_time == 1 and not first.warnings() and first.estimators[0] == "companion"


def test_regions_divide_the_whole_ring():
    scene = VortexScene(cells=24)
    found = VIEWS["vortex"].regions(particle_layout(scene).position)
    counts = np.bincount(found.number, minlength=len(found.names))
    assert len(counts) == 8 * 5 and counts.min() > 0 and counts.sum() == scene.particles


def test_a_recording():
    head = recording(Wanted("vortex cells=12 ppc=2 t-end=0.1", 3, 1000, ("x",), domains=True))["head"]
    assert head["outermost"] == 1.25 and head["shown"] == VortexScene(cells=12, ppc=2).particles
    assert VIEWS["vortex"].stage.MIRRORS == ((1, 1),) and VIEWS["vortex"].stage.PLOT.component == "angular"


@pytest.mark.parametrize("changes", [{"method": "cpdi"}, {"method": "cpgimp-v"},
                                     {"method": "ugimp", "remedies": ("frozen-weights",)}], ids=str)
def test_a_step_taken_apart_adds_up(changes):
    """What the particles give is what the solver's nodes have, to rounding: mass, momentum, forces; and a = f/m."""
    solver = build(VortexScene(cells=12, ppc=2, **changes))
    solver.advance(20)
    _, a = solver.break_down(40)
    k, W, dW = a.links.members, a.links.weight, a.links.slope
    np.testing.assert_allclose(W.T @ a.mass, a.node_mass, rtol=1e-11)
    np.testing.assert_allclose(W.T @ (a.mass[:, None] * a.before.velocity), a.momentum, rtol=0,
                               atol=1e-11 * np.abs(a.momentum).max())
    force = -np.einsum("knd,ked->ne", dW, a.tension)
    np.testing.assert_allclose(force, a.internal_force, rtol=0, atol=1e-9 * np.abs(a.internal_force).max())
    np.testing.assert_allclose((a.internal_force + a.body_force) / a.node_mass[:, None], a.acceleration, rtol=1e-9,
                               atol=1e-9 * np.abs(a.acceleration).max())
    assert len(k) > 4 and a.particle == 40
