"""Limits beyond which recovered cannot run in the plane at all: rows that problems include among their own."""

from solvers.scene.estimator_limits import Limit

POLAR = Limit("recovered", "layout", allowed=("polar",), impossible=True, why="recovered fits the particles along the "
              "lines of a polar lattice and cannot detect the error of a staircase boundary; take the polar layout")
#: Particles across the ring, for a parabola; with two, x is 2 to 15 times the error.
THREE_ACROSS = Limit(
    "recovered", lambda scene: scene.lattice_counts(scene.cells, scene.ppc)[1], least=3, impossible=True,
    why="recovered fits a cubic across the ring, or a parabola, which needs {least} particles there; take more cells "
        "or more particles per cell")
