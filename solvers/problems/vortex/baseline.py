"""The vortex's step with nothing optional in it."""

from solvers.problems.planar.baseline import baseline
from solvers.problems.vortex.solver import VortexSolver

VortexBaseline = baseline(VortexSolver, "lame_modulus", "volumetric", "polar_force")
