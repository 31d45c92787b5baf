"""A problem as another code sees it: what it needs to be set up, and what its particles are held against.

A problem's descriptor has its :class:`ProblemReference`.
"""

import string
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any

import numpy as np

from solvers.estimators.standalone import ElasticBody

#: Fields of a scene that say how we would solve it, and nothing of the problem.
METHOD_FIELDS = frozenset({"method", "linearity_preserving", "velocity", "estimators", "effects", "remedies", "arch",
                           "threads", "sample_every", "plan", "dt", "cfl"})


@dataclass(frozen=True)
class Start:
    """Particles at the time 0: where they are, P of them (P, D), and the ``volume`` (P,) that they fill there, in m^D;
    ``more`` has columns (P,) that the problem knows beside it, such as the edges of a particle's domain."""

    material_position: np.ndarray
    volume: np.ndarray
    more: Mapping[str, np.ndarray] = field(default_factory=dict)


@dataclass(frozen=True)
class Texts:
    """What numbers cannot say, in Markdown with formulas, each a paragraph or several."""

    body: str  # what it is and where
    material: str
    force: str
    boundary: str
    start: str
    exact: str  # how the exact solution reads, or why there is none
    table: str  # where the points of the table of the force are, and what holds elsewhere


class Template(string.Template):
    """Markdown with formulas, in which ``@name`` stands for something: dollars and braces are taken."""

    delimiter = "@"


def read_parts(path: Path, **values: float | str) -> dict[str, str]:
    """The parts of a file of Markdown by their headings, ``## name``, each as one line. In a part ``@name`` stands for
    a value, numbers to 15 digits, or for a part further up."""
    parts = {name: value if isinstance(value, str) else f"{value:.15g}" for name, value in values.items()}
    for part in path.read_text(encoding="utf-8").split("\n## ")[1:]:
        head, _, text = part.partition("\n")
        parts[head] = Template(" ".join(text.split())).substitute(parts)
    return parts


def read_texts(path: Path, *cases: str, **values: float | str) -> Texts:
    """The texts in a file (:func:`read_parts`), headed by their names, or by ``name: case`` where one of the cases has
    another one, the first of them."""
    parts = read_parts(path, **values)
    return Texts(*(next(parts[one] for one in (*(f"{text.name}: {case}" for case in cases), text.name) if one in parts)
                   for text in fields(Texts)))


class ProblemReference(ABC):
    """One problem for other codes; ``axes`` are the names of its D coordinates, ``EXACT`` is the module of its exact
    solution.

    Parameters
    ----------
    scene
        Of the problem, in every method.
    X, x : (P, D) array, m
        Material positions, and positions, which are not wrapped; two axes also where D is 1.
    t : float, s
    F : (P, D, D) array
        Deformation gradients.
    """

    EXACT: Any
    axes: tuple[str, ...] = ("x",)

    @abstractmethod
    def start(self, scene: Any) -> Start:
        """The particles of a scene, in the order of their ids."""

    @abstractmethod
    def texts(self, scene: Any) -> Texts:
        """The problem in words and formulas."""

    @abstractmethod
    def table_points(self, scene: Any, count: int) -> np.ndarray:
        """About ``count`` material points (n, D) for a table of the body force."""

    def displacement(self, scene: Any, X: np.ndarray, t: float) -> np.ndarray:
        """Of the exact solution, where one is built in, u (P, D) in m."""
        return self.EXACT.displacement(scene, X, t)

    def velocity(self, scene: Any, X: np.ndarray, t: float) -> np.ndarray:
        """Of it v (P, D) in m/s; at the time 0 of every scene."""
        return self.EXACT.velocity(scene, X, t)

    def deformation_gradient(self, scene: Any, X: np.ndarray, t: float) -> np.ndarray:
        """Of it F (P, D, D)."""
        return self.EXACT.deformation_gradient(scene, X, t).reshape(len(X), *2 * X.shape[1:])

    @abstractmethod
    def stress(self, scene: Any, F: np.ndarray) -> np.ndarray:
        """Cauchy stress (P, D, D) in Pa by the law of the material."""

    @abstractmethod
    def body_force(self, scene: Any, X: np.ndarray, t: float) -> np.ndarray:
        """b (P, D) in m/s^2, per mass, at the material points."""

    @abstractmethod
    def is_outside(self, scene: Any, X: np.ndarray) -> np.ndarray:
        """Which of the material points (P,) are none of the body's, by more than rounding."""

    @abstractmethod
    def companion(self, scene: Any, fine: bool) -> ElasticBody:
        """What can be solved beside the particles (``solvers.estimators.standalone``), on a fine or a coarser mesh."""

    def exact_stress(self, scene: Any, X: np.ndarray, t: float) -> np.ndarray:
        """Cauchy stress (P, D, D) in Pa of the exact solution."""
        return self.stress(scene, self.deformation_gradient(scene, X, t))

    def initial_deformation_gradient(self, scene: Any, X: np.ndarray) -> np.ndarray:
        """F (P, D, D) at the time 0."""
        return np.broadcast_to(np.eye(X.shape[1]), (len(X), X.shape[1], X.shape[1])).copy()

    @abstractmethod
    def along(self, quantity: str, X: np.ndarray, x: np.ndarray, values: np.ndarray) -> np.ndarray:
        """The component (P,) that a plot shows of a quantity by its key (``samples.QUANTITIES``), u for x: of vectors
        (P, D) or tensors (P, D, D) of particles at the places x that were at X."""

    def grid_corner(self, scene: Any) -> float:
        """Where the lines of our grid begin, in m, in each direction."""
        return 0.0

    def unwrap_positions(self, scene: Any, X: np.ndarray, x: np.ndarray, t: np.ndarray) -> np.ndarray:
        """Positions x (P, D) at the times t (P,) that a code may have moved by a period, moved back; as they are where
        nothing has one."""
        return x
