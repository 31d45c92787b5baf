"""The vortex's step with nothing optional in it."""

from solvers.planar.stripped import stripped
from solvers.vortex.phases import TRAITS
from solvers.vortex.solver import VortexSolver
from solvers.vortex.state import WatchedVortex
from solvers.vortex.step import outside

SOLVER = stripped(VortexSolver, WatchedVortex, ("lame_modulus", "volumetric", "polar_force"), TRAITS, outside)
