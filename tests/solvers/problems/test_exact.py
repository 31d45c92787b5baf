"""What first layouts are. Of exact solutions ``tests/solvers/scene/test_exact_solutions.py`` has all."""

from dataclasses import replace

import numpy as np
import pytest

from solvers.problems import PROBLEMS
from solvers.problems.bar.scene import BarScene
from solvers.problems.planar.particle_layout import particle_layout
from solvers.problems.ring import RingScene
from solvers.problems.square import SquareScene
from solvers.problems.vortex import VortexScene
from solvers.running.run import build

#: Not the usual numbers; the vortex turns by more than 45 degrees.
SCENES = {"bar": BarScene(cells=12, amplitude=0.05, modulus=7.0, density=1.3),
          "ring": RingScene(cells=12, amplitude=0.15, density=1300.0, modulus=3e6),
          "vortex": VortexScene(cells=12, amplitude=1.2, frequency=0.7, modulus=1700.0, poisson_ratio=0.4,
                                density=900.0),
          "square": SquareScene(cells=12, amplitude=0.03, density=1300.0, poisson_ratio=0.2)}
RINGS = (SCENES["ring"], SCENES["vortex"])


@pytest.mark.parametrize("changes", [{"problem": "bar", "ppc": ppc} for ppc in (1, 4, 5)] + [
    {"problem": name} for name in ("ring", "vortex", "square")], ids=str)
def test_initial_state_is_the_exact_one(changes):
    """Particles fill the body; u = 0, F = 1, and velocities are the exact solution's, of some half a step before:
    symplectic Euler is the leapfrog scheme, whose velocities belong to the middle of the steps."""
    scene = replace(SCENES[changes["problem"]], **changes)
    reference, snapshot = PROBLEMS[scene.problem].reference, build(scene).snapshot()
    X, start = snapshot.material_position, reference.start(scene)
    np.testing.assert_allclose(X.reshape(start.material_position.shape), start.material_position, rtol=0, atol=1e-15)
    np.testing.assert_array_equal(snapshot.position, X)
    np.testing.assert_array_equal(snapshot.deformation_gradient, np.broadcast_to(
        np.eye(2) if scene.DIMENSIONS == 2 else 1.0, snapshot.deformation_gradient.shape))
    before = -0.5 * scene.time_step if scene.problem in ("vortex", "square") else 0.0
    np.testing.assert_array_equal(snapshot.velocity, reference.velocity(scene, X, before))
    if scene.problem == "bar":
        np.testing.assert_allclose(X, (np.arange(len(X)) + 0.5) / len(X), rtol=0, atol=1e-15)
        np.testing.assert_array_equal(snapshot.error, 0)


@pytest.mark.parametrize("scene", [replace(scene, cells=cells, layout=layout, ppc=ppc) for scene in RINGS
                                   for cells in (12, 48) for layout in ("polar", "cartesian") for ppc in (1, 2, 4)],
                         ids=lambda scene: f"{scene.problem} {scene.cells} {scene.layout} {scene.ppc}")
def test_layouts_fill_the_ring(scene):
    """Polar volumes sum to the area exactly (midpoint rule of R); Cartesian ones miss part of a rim of width h/ppc: at
    most half a particle's side along the rims, a bound never reached by chance. Volumes are those of the domains, whose
    edges are the lattice's own."""
    made = particle_layout(scene)
    polar, rims = scene.layout == "polar", scene.ANGLE * (scene.INNER + scene.OUTER)
    area = 0.5 * scene.ANGLE * (scene.OUTER**2 - scene.INNER**2)
    assert abs(made.volume.sum() - area) < (1e-12 if polar else 0.5 * scene.spacing / scene.ppc * rims)
    assert not polar or len(made.volume) == scene.particles
    R = np.linalg.norm(made.position, axis=1)
    assert np.abs(made.orbits[made.orbit, 0] - R).max() < 1e-11  # radii are grouped to 12 digits
    assert R.min() > scene.INNER and R.max() < scene.OUTER
    assert scene.problem == "vortex" or made.position.min() > 0
    a, b = made.edges[:, :2], made.edges[:, 2:]
    np.testing.assert_allclose(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0], made.volume, rtol=1e-12)
    assert np.abs((a * b).sum(1)).max() < 1e-15
    if polar:
        assert np.abs((a * made.position).sum(1)).max() < 1e-14
