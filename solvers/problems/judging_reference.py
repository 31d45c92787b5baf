"""Reference of a problem for other codes: how to set it up, and exact values for its particles.

A problem's descriptor has its :class:`JudgingReference`.
"""

import string
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any

import numpy as np

from solvers.estimators.standalone_companion import ElasticBody

#: Fields of a scene that belong to our method, and not to the problem.
METHOD_FIELDS = frozenset({"method", "linearity_preserving", "velocity", "estimators", "effects", "remedies", "arch",
                           "threads", "sample_every", "plan", "dt", "cfl"})


@dataclass(frozen=True)
class InitialParticles:
    """P particles at the time 0: their positions (P, D) in m and volumes (P,) in m^D; ``more`` has further columns
    (P,) by name, such as the edges of a particle's domain in m."""

    material_position: np.ndarray
    volume: np.ndarray
    more: Mapping[str, np.ndarray] = field(default_factory=dict)


@dataclass(frozen=True)
class ProblemDescription:
    """Description of a problem beyond numbers, in Markdown with formulas, one or several paragraphs each."""

    body: str  # what it is and where
    material: str
    force: str
    boundary: str
    start: str
    exact: str  # how the exact solution reads, or why there is none
    table: str  # where the points of the table of the force are, and what holds elsewhere


class FormulaTemplate(string.Template):
    """Template for Markdown with formulas, in which ``@name`` is a placeholder, as formulas need $ and {}."""

    delimiter = "@"


def read_parts(path: Path, **values: float | str) -> dict[str, str]:
    """Returns the parts of a Markdown file by their headings, ``## name``, each as one line, and the ``values``. In a
    part ``@name`` is replaced by that one of the ``values``, a number with 15 digits, or by a previous part."""
    parts = {name: value if isinstance(value, str) else f"{value:.15g}" for name, value in values.items()}
    for part in path.read_text(encoding="utf-8").split("\n## ")[1:]:
        head, _, text = part.partition("\n")
        parts[head] = FormulaTemplate(" ".join(text.split())).substitute(parts)
    return parts


def read_texts(path: Path, *cases: str, **values: float | str) -> ProblemDescription:
    """Returns the texts in a Markdown file (:func:`read_parts`): for each field of :class:`ProblemDescription` the
    part ``name: case`` of the first of the ``cases`` that has one, or the part ``name``."""
    parts = read_parts(path, **values)
    return ProblemDescription(*(next(parts[one] for one in (*(f"{text.name}: {case}" for case in cases), text.name)
                                     if one in parts) for text in fields(ProblemDescription)))


class JudgingReference(ABC):
    """Description of a problem for other codes; ``axes`` are the names of its D coordinates, ``EXACT`` its solution.

    In every method, ``scene`` is a scene of the problem, X and x (P, D) in m are material positions, and positions,
    which are not wrapped, with two axes even if D is 1; t is in s, and F (P, D, D) are deformation gradients.
    """

    EXACT: Any
    axes: tuple[str, ...] = ("x",)

    @abstractmethod
    def start(self, scene: Any) -> InitialParticles:
        """Returns the particles of a scene at the time 0, in the order of their ids."""

    @abstractmethod
    def texts(self, scene: Any) -> ProblemDescription:
        """Returns the problem in words and formulas."""

    @abstractmethod
    def table_points(self, scene: Any, count: int) -> np.ndarray:
        """Returns about ``count`` material points (n, D), in m, for a table of the body force."""

    def displacement(self, scene: Any, X: np.ndarray, t: float) -> np.ndarray:
        """Returns u (P, D) in m of the exact solution, where one is built in, at X (P, D) and the time t in s."""
        return self.EXACT.displacement(scene, X, t)

    def velocity(self, scene: Any, X: np.ndarray, t: float) -> np.ndarray:
        """Returns v (P, D) in m/s of the exact solution at X (P, D) and t in s; valid for every scene at t = 0."""
        return self.EXACT.velocity(scene, X, t)

    def deformation_gradient(self, scene: Any, X: np.ndarray, t: float) -> np.ndarray:
        """Returns the deformation gradient F (P, D, D) of the exact solution at X (P, D) and the time t in s."""
        return self.EXACT.deformation_gradient(scene, X, t).reshape(len(X), *2 * X.shape[1:])

    @abstractmethod
    def stress(self, scene: Any, F: np.ndarray) -> np.ndarray:
        """Returns the Cauchy stress (P, D, D) in Pa of deformation gradients F (P, D, D) by the material law."""

    @abstractmethod
    def body_force(self, scene: Any, X: np.ndarray, t: float) -> np.ndarray:
        """Returns the body force per mass (P, D) in m/s^2 at material points X (P, D) in m and the time t in s."""

    @abstractmethod
    def is_outside(self, scene: Any, X: np.ndarray) -> np.ndarray:
        """Returns a mask (P,) of the material points X (P, D) that are outside the body, by more than rounding."""

    @abstractmethod
    def companion(self, scene: Any, fine: bool) -> ElasticBody:
        """Returns the scene's body for ``solvers.estimators.standalone_companion``, on a ``fine`` or coarser mesh."""

    def exact_stress(self, scene: Any, X: np.ndarray, t: float) -> np.ndarray:
        """Returns the Cauchy stress (P, D, D) in Pa of the exact solution at X (P, D) and the time t in s."""
        return self.stress(scene, self.deformation_gradient(scene, X, t))

    def initial_deformation_gradient(self, scene: Any, X: np.ndarray) -> np.ndarray:
        """Returns F (P, D, D) of particles at X (P, D) at the time 0."""
        return np.broadcast_to(np.eye(X.shape[1]), (len(X), X.shape[1], X.shape[1])).copy()

    def grid_corner(self, scene: Any) -> float:
        """Returns the coordinate in m at which the lines of a run's grid begin, in each direction."""
        return 0.0

    def unwrap_positions(self, scene: Any, X: np.ndarray, x: np.ndarray, t: np.ndarray) -> np.ndarray:
        """Returns positions x (P, D) in m at the times t (P,) in s without the lengths of a periodic body that a code
        may have added; unchanged for problems that are not periodic in space."""
        return x
