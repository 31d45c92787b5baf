"""The ring's step with nothing optional in it."""

from solvers.planar.stripped import stripped
from solvers.ring.phases import TRAITS
from solvers.ring.solver import RingSolver
from solvers.ring.state import WatchedRing
from solvers.ring.step import outside

SOLVER = stripped(RingSolver, WatchedRing, ("material_position", "farthest_move", "radial_force"), TRAITS, outside)
