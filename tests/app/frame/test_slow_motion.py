"""One step in slow motion: what is shown of a step is the step's own, and adds up."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from app.frame.slow_motion.stage import SIDES, averaged_hat
from app.frame.slow_motion.step_phases import PHASES, format_scaled
from app.names_and_units import PREFIXES
from app.problems.views import VIEWS
from app.renderers.viewer_renderer import LabelLayer, ViewerSurface
from solvers.engine.engine_messages import Pace, SessionRequest
from solvers.engine.shared_frames import FrameOptions
from solvers.problems.bar.scene import BarScene
from solvers.problems.ring import RingScene
from solvers.problems.vortex import VortexScene
from solvers.running.run import build
from tests.solvers.engine.test_stepper import one_session
from tests.support.recording_scene import RecordingScene

GUI = SimpleNamespace(add_html=lambda content: SimpleNamespace())
ROUND_OFF = 1e-12  # of sums of a few dozen terms of the size that the comparison is relative to
BAR, RING = BarScene(cells=12, ppc=2, amplitude=0.05), RingScene(cells=12, estimators=())
VORTEX = VortexScene(cells=12, ppc=2, amplitude=0.25, cfl=0.01, estimators=())
SCENES = {**{f"bar {method}": replace(BAR, method=method) for method in ("mpm", "ugimp", "cpgimp", "bspline")},
          "bar node": replace(BAR, body_force="node"), "bar free": replace(BAR, body_force="none"),
          "bar corners": replace(BAR, method="cpgimp", velocity="corners"),
          "bar particle": replace(BAR, velocity="particle"), "bar linear": replace(BAR, linearity_preserving=True),
          "bar frozen": replace(BAR, remedies=("frozen-weights",)), "bar pieces": replace(BAR, remedies=("pieces",)),
          "bar mended": replace(BAR, remedies=("null-space-filter", "coupled-deformation")),
          **{f"ring {method}": replace(RING, method=method) for method in ("mpm", "ugimp", "cpgimp", "cpdi")},
          "ring free": replace(RING, body_force="none"), "ring cartesian": replace(RING, layout="cartesian"),
          "ring parallel": replace(RING, plan="parallel", threads=2),
          "ring frozen": replace(RING, remedies=("frozen-weights",)),
          "ring frozen gimp": replace(RING, method="ugimp", remedies=("frozen-weights",)), "vortex cpdi": VORTEX,
          "vortex stretched": replace(VORTEX, method="cpgimp-v"),
          "vortex frozen": replace(VORTEX, method="ugimp", remedies=("frozen-weights",))}

#: Whose kernels nothing else here needs: their steps are those of the others with other weights or forces.
RARE = ("bar node", "bar free", "bar particle", "ring mpm", "ring ugimp", "ring cpgimp", "ring free", "ring cartesian",
        "ring frozen gimp")


def close(one, other, scale):
    return np.abs(one - other).max() <= ROUND_OFF * max(scale, np.abs(one).max())


@pytest.mark.parametrize("name", [pytest.param(name, marks=pytest.mark.slow if name in RARE else ())
                                  for name in SCENES])
def test_the_parts_of_a_step_add_up(name):
    """Around every particle, at the ends and planes too: what members give is what nodes have, and comes back."""
    scene = SCENES[name]
    solver = build(scene)
    solver.advance(40)
    for particle in range(0, solver.snapshot().position.shape[0], 3):
        _, a = solver.break_down(particle)
        S, dS, dt, carried = a.links.weight, a.links.slope, a.time_step, a.before
        assert a.particle == particle and a.links.members[0] == particle and a.step == solver.step
        assert close(S[0].sum(), 1.0, 1.0) and close(dS[0].sum(axis=0), 0.0, 1 / a.spacing)
        assert close(S.T @ a.mass, a.node_mass, a.node_mass.max())
        given = S.T @ (a.mass[:, None] * carried.velocity)
        assert close(given, a.momentum, np.abs(a.mass).max() * np.abs(carried.velocity).max())
        pull, size = -np.einsum("kde,kne->nd", a.tension, dS), np.abs(a.tension).max() * np.abs(dS).max()
        if not getattr(scene, "linearity_preserving", False) and "pieces" not in scene.remedies:
            assert close(pull, a.internal_force, size)
        on_plane = (np.abs(a.nodes) < 1e-9 * a.spacing) & (scene.problem == "ring")  # nothing moves across
        new = np.where(on_plane, 0.0, a.before_velocity + dt * a.acceleration)
        assert close(new, a.velocity, np.abs(new).max())
        force = a.node_mass[:, None] * a.acceleration
        assert close(np.where(on_plane, 0.0, a.internal_force + a.body_force), force, size)
        came = {"grid": S[0] @ a.velocity, "particle": a.after.velocity[0]}.get(scene.velocity)
        if came is not None:
            assert close(carried.position[0] + dt * came, a.after.position[0], 1.0)
        L, F = np.einsum("nd,ne->de", a.velocity, dS[0]), carried.deformation_gradient[0]
        if name == "bar mended":
            continue
        assert close(a.velocity_change_by_remedies, 0.0, np.abs(carried.velocity).max())
        if name == "bar pieces":
            continue
        assert close(F + dt * (L if scene.frozen else L @ F), a.after.deformation_gradient[0], 1.0)


def test_what_remedies_add_is_said():
    """With the filter, the new velocity is not of the nodes alone, and the rest is reported."""
    solver = build(SCENES["bar mended"])
    rest = [np.abs(solver.break_down(5)[1].velocity_change_by_remedies).max() for _ in range(40)]
    assert max(rest) > 1e3 * ROUND_OFF


@pytest.mark.parametrize("name", ["bar ugimp", "ring cpdi"])
def test_a_step_taken_apart_is_an_ordinary_step(name):
    """To the bit: state, samples and all."""
    scene = replace(SCENES[name], estimators=("recovered",) if name == "bar ugimp" else ())
    one, other = build(scene), build(scene)
    for _ in range(12):
        assert one.advance(1).tobytes() == other.break_down(3)[0].tobytes()
    (steps, mine), (_, theirs) = one.state(), other.state()
    assert steps == other.step == 12
    assert {key for key in mine if mine[key].tobytes() != theirs[key].tobytes()} == set()


def test_an_engine_sends_what_a_wish_asks_for():
    """With the frame of a single step, again with the next while the run rests, and not once it has gone on."""
    wish = SessionRequest(1, 1, "", BAR, Pace(False), FrameOptions(broken_down=4))
    with one_session(wish) as session:
        def ask(pace=(), frame=()):
            wish = session.wish
            session.accept(replace(wish, number=wish.number + 1, pace=replace(wish.pace, **dict(pace)),
                                   frame=replace(wish.frame, **dict(frame))))

        def after(**changes):
            ask(**changes)
            return session.write_frame()

        assert session.write_frame().breakdown is None
        report = after(pace={"single_steps": 3})
        assert report.step == report.breakdown.step == 3 and report.breakdown.particle == 4
        assert after(frame={"plotted": "v"}).breakdown is report.breakdown
        other = after(frame={"broken_down": 5})  # of the same step
        assert (other.step, other.breakdown.step, other.breakdown.particle) == (3, 3, 5)
        back = after(frame={"broken_down": 4})
        assert back.step == 3 and back.breakdown is not report.breakdown
        for name, values in vars(report.breakdown).items():
            assert not isinstance(values, np.ndarray) or np.array_equal(vars(back.breakdown)[name], values), name
        assert after(frame={"broken_down": None}).breakdown is None
        ask({"playing": True}, {"broken_down": 4})
        session.advance_slice()
        assert session.write_frame().breakdown is None
        assert after(pace={"restarts": 1, "playing": False}).breakdown is None


@pytest.mark.parametrize("name", ["bar ugimp", "bar frozen", "bar pieces", "ring cpdi", "ring frozen"])
def test_the_page_shows_the_numbers_of_the_step(name):
    """Every number of every phase, read back, is the solver's to as many digits as are shown."""
    scene = SCENES[name]
    solver = build(scene)
    solver.advance(40)
    _, a = solver.break_down(7)
    for phase in PHASES:
        for column in phase.columns:
            values = column.scale * column.values(a)
            texts, unit = format_scaled(values, column.unit, 4)
            factor = 1000.0 ** next((power for power, prefix in PREFIXES.items() if prefix + column.unit == unit), 0)
            read = np.array([[float(x.replace("−", "-")) for x in text.split(", ")] for text in texts])
            assert unit.endswith(column.unit) and len(texts) == len(a.nodes)
            assert np.allclose(factor * read, values.reshape(len(values), -1), rtol=1e-3,
                               atol=1e-9 * np.abs(values).max())
        assert all(phase.front(scene, a)) and phase.words(scene)


def test_the_drawn_shape_function_is_that_of_the_solver():
    """The curves go through the weights, and slope as the solver's slopes do."""
    for name in ("bar mpm", "bar ugimp", "bar cpgimp", "bar bspline"):
        solver = build(SCENES[name])
        solver.advance(20)
        _, a = solver.break_down(5)
        reach = 0.5 if name == "bar bspline" else a.edges[0, 0, 0] / a.spacing
        drawn = averaged_hat((a.place[0, 0] - a.nodes[:, 0]) / a.spacing, reach)
        assert close(drawn, a.links.weight[0], 1.0)


@pytest.mark.parametrize("name", ["bar ugimp", "ring cpdi"])
def test_words_stay_on_a_small_stage(name):
    """A narrower window has shorter lines; words that were there are broken anew when the window changes."""
    lettering = LabelLayer(GUI)
    stage = VIEWS[SCENES[name].problem].slow_motion_stage(ViewerSurface(SimpleNamespace(scene=RecordingScene()),
                                                                        lettering, "/slow"))
    solver = build(SCENES[name])
    solver.advance(40)
    _, breakdown = solver.break_down(7)
    longest = []
    for width in (773.0, 390.0):
        lettering.set_pixel_layout(width, 340.0, 0.0)
        for phase in range(len(PHASES)):
            stage.draw(SCENES[name], breakdown, phase, 1.0)
            lines = [line for _, label in lettering.visible_labels for line in label.text.split("\n")]
            assert max(map(len, lines)) <= stage.letters_per_caption_line
        longest.append(stage.letters_per_caption_line)
    assert longest[1] < 0.65 * longest[0]


@pytest.mark.parametrize("name", ["bar ugimp", "ring cpdi", "vortex cpdi"])
def test_numbers_lie_neither_over_the_particle_in_front_nor_over_each_other(name):
    scene = replace(SCENES[name], cells=16 if name == "vortex cpdi" else 12)
    drawn, lettering = RecordingScene(), LabelLayer(GUI)
    stage = VIEWS[scene.problem].slow_motion_stage(ViewerSurface(SimpleNamespace(scene=drawn), lettering, "/slow"))
    solver = build(scene)
    solver.advance(40)
    sides = {anchor: np.array(side) for anchor, side in SIDES}
    for particle in range(0, 24, 7):
        _, breakdown = solver.break_down(particle)
        for phase in range(len(PHASES)):
            stage.draw(scene, breakdown, phase, 1.0)
            front = drawn.made["dots2"].points[-1, :2]
            numbers = [label for _, label in lettering.visible_labels if label.x]  # captions begin at the edge
            assert len(numbers) == len(breakdown.nodes)
            halves = [0.5 * stage.sheet.stage_metrics.text_extent(label.text) for label in numbers]
            middles = [np.array((label.x, label.y)) + half * sides[label.anchor]
                       for label, half in zip(numbers, halves, strict=True)]
            for k, (half, middle) in enumerate(zip(halves, middles, strict=True)):
                assert (np.abs(front - middle) > half).any()
                assert all((np.abs(middles[j] - middle) >= half + halves[j]).any() for j in range(k))
