"""The vortex's step with nothing optional in it."""

from solvers.problems.planar.baseline import baseline
from solvers.problems.vortex.method.phases import TRAITS
from solvers.problems.vortex.solver import VortexSolver
from solvers.problems.vortex.state import WatchedVortex
from solvers.problems.vortex.step import has_escaped

MEMBERS = "lame_modulus", "volumetric", "polar_force"

VortexBaseline = baseline(VortexSolver, WatchedVortex, MEMBERS, TRAITS, has_escaped)
