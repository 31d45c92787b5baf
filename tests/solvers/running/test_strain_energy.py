"""The strain energy of the plane problems against its formula, and its derivative against the stress that pushes."""

from dataclasses import replace

import numpy as np
import pytest
import taichi as ti

from solvers.kernels.kinds import quads, reals
from solvers.problems.planar.method import neo_hookean
from solvers.problems.ring.method import material as ring_material
from solvers.problems.ring.method import samples as ring_samples
from solvers.problems.ring.scene import RingScene
from solvers.problems.ring.solver import RingSolver
from solvers.problems.vortex.method import samples as vortex_samples
from solvers.problems.vortex.scene import VortexScene
from solvers.problems.vortex.solver import VortexSolver
from solvers.solver.arrays import aligned

BARE = {"effects": (), "estimators": ()}
SOLVERS = {"ring": (RingSolver, RingScene(cells=12, modulus=3e6, density=1300.0, **BARE)),
           "vortex": (VortexSolver, VortexScene(cells=12, density=700.0, **BARE))}


def kernel(Solver, samples, stress_times_J):
    """Strain energy and Kirchhoff stress of the particles, as a problem has them."""
    State = Solver.KERNELS.state

    @ti.kernel
    def measure(body: State, energy: reals, stress: quads):
        for p in range(body.particles):
            energy[p] = samples.strain_energy(body, p)
            tau = stress_times_J(body, p)
            stress[p] = ti.Vector([tau[0], tau[1], tau[1], tau[2]])

    return measure


@ti.func
def vortex_stress(body: ti.template(), p):
    return neo_hookean.cauchy_stress(body, p) * neo_hookean.determinant(body.deformation_gradient[p])


KERNELS = {"ring": kernel(RingSolver, ring_samples, ring_material.kirchhoff_stress),
           "vortex": kernel(VortexSolver, vortex_samples, vortex_stress)}


def measured(problem: str, solver, F: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Energies (P,) in J/m and Kirchhoff stresses (P, 2, 2) in Pa of the particles, deformed by F (P, 2, 2)."""
    a = solver._arrays
    a.deformation_gradient[:] = F.reshape(-1, 4)
    energy, stress = aligned(np.zeros(len(F))), aligned(np.zeros((len(F), 4)))
    KERNELS[problem](solver._pack, energy, stress)
    return energy, stress.reshape(-1, 2, 2)


@pytest.mark.parametrize("problem, changes", [("ring", {}), ("vortex", {}), ("vortex", {"poisson_ratio": 0.45})])
def test_the_strain_energy_and_its_derivative(problem, changes):
    """W = mu/2 (F:F - 2 - 2 ln J) + lambda/2 ln^2 J of random F with J from .4 to 2.5, the ring's lambda being 0: to
    rounding; and dW/dF F^T = J sigma, by differences of 1e-6 good to some 1e-8 of the largest stress."""
    kind, scene = SOLVERS[problem]
    scene = replace(scene, **changes)
    solver, random = kind(scene), np.random.default_rng(7)
    volume = solver._arrays.mass / scene.density
    nu = getattr(scene, "poisson_ratio", 0.0)
    mu, lam = 0.5 * scene.modulus / (1 + nu), scene.modulus * nu / ((1 + nu) * (1 - 2 * nu))
    F = np.eye(2) + random.uniform(-0.3, 0.3, (len(volume), 2, 2))
    growth = np.log(np.linalg.det(F))
    energy, stress = measured(problem, solver, F)
    expected = volume * (0.5 * mu * ((F**2).sum((1, 2)) - 2 - 2 * growth) + 0.5 * lam * growth**2)
    np.testing.assert_allclose(energy, expected, rtol=0, atol=1e-12 * expected.max())
    slope, step = np.zeros_like(F), 1e-6
    for i, j in np.ndindex(2, 2):
        change = np.zeros((2, 2))
        change[i, j] = step
        ends = [measured(problem, solver, F + sign * change)[0] for sign in (1, -1)]
        slope[:, i, j] = (ends[0] - ends[1]) / (2 * step * volume)
    np.testing.assert_allclose(slope @ F.transpose(0, 2, 1), stress, rtol=0, atol=1e-7 * np.abs(stress).max())
