"""The ring's step with nothing optional in it."""

from solvers.problems.planar.baseline import baseline
from solvers.problems.ring.solver import RingSolver

RingBaseline = baseline(RingSolver, "material_position", "farthest_move", "radial_force")
