"""The strain energy of the plane problems against its formula, and the stress of a step against that in numpy."""

from dataclasses import replace

import numpy as np
import pytest
import taichi as ti

from solvers.kernels.dtypes import quads, reals
from solvers.problems import PROBLEMS
from solvers.problems.planar.method import material_laws
from solvers.problems.ring import RingScene
from solvers.problems.square import SquareScene
from solvers.problems.vortex import VortexScene
from solvers.running.run import build
from solvers.scene.kernel_options import kernel_options_of
from solvers.solver.state_arrays import aligned_copy

BARE = {"effects": (), "estimators": ()}
SCENES = {"ring": RingScene(cells=12, modulus=3e6, density=1300.0, **BARE),
          "vortex": VortexScene(cells=12, density=700.0, **BARE),
          "square": SquareScene(cells=12, law="st-venant-kirchhoff", **BARE)}


def kernel(solver):
    """Strain energy and Kirchhoff stress of the particles, as a problem's step has them."""
    State, traits = solver.KERNELS.state, solver.PARTS.traits

    @ti.kernel
    def measure(body: State, energy: reals, stress: quads, on: ti.template()):
        traits.prepare(body, 0, body.particles, on)
        for p in range(body.particles):
            energy[p] = material_laws.strain_energy(body, p, on)
            stress[p] = traits.stress(body, p, on)

    return measure


def measured(measure, solver, F: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Energies (P,) in J/m and Kirchhoff stresses (P, 2, 2) in Pa of the particles, deformed by F (P, 2, 2)."""
    solver._arrays.deformation_gradient[:] = F.reshape(-1, 4)
    energy, stress = aligned_copy(np.zeros(len(F))), aligned_copy(np.zeros((len(F), 4)))
    measure(solver._stepping.pack, energy, stress, kernel_options_of(solver.scene))
    return energy, stress.reshape(-1, 2, 2)


@pytest.mark.parametrize("problem, changes", [("ring", {}), ("vortex", {}), ("vortex", {"poisson_ratio": 0.45}),
                                              ("square", {})])
def test_the_strain_energy_and_the_stress(problem, changes):
    """W = mu/2 (F:F - 2 - 2 ln J) + lambda/2 ln^2 J of random F with J from .4 to 2.5, the ring's lambda being 0, or
    lambda/2 (tr E)^2 + mu E:E: to rounding; and J sigma is that of numpy, whose derivatives are tested there. For
    strains of 1e-9 the energy of either law is lambda/2 (tr e)^2 + mu e:e, as exact as F is."""
    scene = replace(SCENES[problem], **changes)
    solver, random = build(scene), np.random.default_rng(7)
    measure = kernel(solver)
    volume = solver._arrays.mass / scene.density
    nu = getattr(scene, "poisson_ratio", 0.0)
    mu, lam = 0.5 * scene.modulus / (1 + nu), scene.modulus * nu / ((1 + nu) * (1 - 2 * nu))
    F = np.eye(2) + random.uniform(-0.3, 0.3, (len(volume), 2, 2))
    growth = np.log(np.linalg.det(F))
    energy, stress = measured(measure, solver, F)
    expected = volume * (0.5 * mu * ((F**2).sum((1, 2)) - 2 - 2 * growth) + 0.5 * lam * growth**2)
    if problem == "square":
        E = 0.5 * (F.transpose(0, 2, 1) @ F - np.eye(2))
        expected = volume * (0.5 * lam * np.trace(E, axis1=1, axis2=2) ** 2 + mu * (E**2).sum((1, 2)))
    np.testing.assert_allclose(energy, expected, rtol=0, atol=1e-12 * expected.max())
    law = np.linalg.det(F)[:, None, None] * PROBLEMS[problem].reference.stress(scene, F)
    np.testing.assert_allclose(stress, law, rtol=0, atol=1e-13 * np.abs(law).max())
    small = 1e-8 * (F - np.eye(2))
    strain = 0.5 * (small + small.transpose(0, 2, 1))
    linear = volume * (0.5 * lam * np.trace(strain, axis1=1, axis2=2) ** 2 + mu * (strain**2).sum((1, 2)))
    energy, _ = measured(measure, solver, np.eye(2) + small)
    np.testing.assert_allclose(energy, linear, rtol=1e-5)
