"""The ring's step with nothing optional in it."""

from solvers.problems.planar.baseline import baseline
from solvers.problems.ring.method.phases import TRAITS
from solvers.problems.ring.solver import RingSolver
from solvers.problems.ring.state import WatchedRing
from solvers.problems.ring.step import has_escaped

MEMBERS = "material_position", "farthest_move", "radial_force"

RingBaseline = baseline(RingSolver, WatchedRing, MEMBERS, TRAITS, has_escaped)
