"""The vortex's step with nothing optional in it."""

from solvers.problems.planar.stripped import stripped
from solvers.problems.vortex.phases import TRAITS
from solvers.problems.vortex.solver import VortexSolver
from solvers.problems.vortex.state import WatchedVortex
from solvers.problems.vortex.step import outside

SOLVER = stripped(VortexSolver, WatchedVortex, ("lame_modulus", "volumetric", "polar_force"), TRAITS, outside)
