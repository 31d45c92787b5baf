"""Errors of particles against the truth or the companion, their norms over time, and their maxima.

Errors are computed minus exact at a material point, their sizes Euclidean and Frobenius norms, a norm the root of the
mean square over the particles that are there: as in our own runs (``solvers.solver.samples``).
"""

import functools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from solvers.estimators.standalone_companion import ElasticBody
from solvers.judging.particle_data_types import Frame
from solvers.judging.problem_handout import fields_at_points, solve_companion
from solvers.problems import PROBLEMS
from solvers.scene.scene import Scene
from solvers.solver.error_series import error_index, finite_or_none, summary
from solvers.solver.rounding import largest_rounding_error

QUANTITIES = ("x", "v", "sigma")
Errors = dict[str, np.ndarray]  # (P, D) or (P, D, D) by quantity, for those that the file has


def true_errors(scene: Scene, frame: Frame) -> Errors:
    """Returns by quantity the particles' values minus those of the exact solution."""
    reference, X, t = PROBLEMS[scene.problem].reference, frame.material_position, frame.time
    return _errors_against(scene, frame, reference.displacement(scene, X, t), reference.velocity(scene, X, t),
                           reference.exact_stress(scene, X, t))


def frame_stress(scene: Scene, frame: Frame) -> np.ndarray | None:
    """Returns the Cauchy stress (P, D, D) in Pa: the file's own, or that from F by the material law, or None."""
    if frame.stress is not None or frame.deformation_gradient is None:
        return frame.stress
    with np.errstate(all="ignore"):
        return PROBLEMS[scene.problem].reference.stress(scene, frame.deformation_gradient)


def error_magnitudes(error: np.ndarray) -> np.ndarray:
    """Returns lengths (vectors) or Frobenius norms (tensors) (P,) of errors (P, ...), in their unit."""
    return np.sqrt(np.sum(error.reshape(len(error), -1) ** 2, axis=1))


def rms(error: np.ndarray) -> float:
    """Returns the root mean square over particles of the sizes of errors (P, ...)."""
    return float(np.sqrt(np.sum(error**2) / len(error)))


@dataclass(frozen=True)
class TwoMeshCompanion:
    """A companion (reference solution by spectral elements) at some ``times`` in s, on two meshes, whose difference
    estimates its own error."""

    scene: Scene
    times: tuple[float, ...]

    @functools.cached_property
    def _solutions(self) -> list[tuple[ElasticBody, list[tuple[np.ndarray, np.ndarray]]]]:
        return [solve_companion(self.scene, fine, self.times) for fine in (True, False)]

    def errors(self, frame: Frame, fine: bool = True) -> Errors:
        """Returns by quantity a frame's values minus the companion's on its fine or coarse mesh."""
        return _errors_against(self.scene, frame, *self._fields(frame, fine))

    def mesh_difference(self, frame: Frame) -> dict[str, float]:
        """Returns by quantity the RMS difference of the companion's two meshes at the frame's particles."""
        return {q: rms(one - other) for q, one, other in zip(QUANTITIES, self._fields(frame, True),
                                                             self._fields(frame, False), strict=True)}

    def _fields(self, frame: Frame, fine: bool) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        body, solved = self._solutions[0 if fine else 1]
        motion = solved[self.times.index(frame.time)]
        u, v, _, sigma = fields_at_points(self.scene, body, motion, frame.material_position)
        return u, v, sigma


def _errors_against(scene: Scene, frame: Frame, u: np.ndarray, v: np.ndarray, sigma: np.ndarray) -> Errors:
    """Returns by quantity the frame's x, v and sigma minus exact displacement, v and sigma (P, ...)."""
    found = {"x": frame.position - frame.material_position - u}
    if frame.velocity is not None:
        found["v"] = frame.velocity - v
    own = frame_stress(scene, frame)
    if own is not None:
        found["sigma"] = own - sigma
    return found


def norm_series(errors: Sequence[Errors]) -> dict[str, np.ndarray]:
    """Returns by quantity the RMS error (T,) over particles in each of T frames, NaN where one does not have it."""
    return {q: np.array([rms(e[q]) if q in e else np.nan for e in errors]) for q in QUANTITIES}


def as_json(norms: dict[str, np.ndarray]) -> dict[str, list[float | None]]:
    """Returns norms (T,) by quantity as lists for JSON, None where one is unknown."""
    return {q: [finite_or_none(value) for value in values] for q, values in norms.items()}


def summarise_norms(times: np.ndarray, norms: dict[str, np.ndarray]) -> dict[str, dict[str, float | None]]:
    """Returns by quantity final, largest and mean of norms (T,) after the time 0, as for our runs; None without any."""
    return {q: summary(np.concatenate([[np.nan], values[times > 0]])) for q, values in norms.items()}


@dataclass(frozen=True)
class WorstParticle:
    """Largest error of a quantity: ``size`` (SI unit), its particle's number, X (``place``, m), time in s, and file."""

    size: float
    particle: int
    place: tuple[float, ...]
    time: float
    file: str

    def to_dict(self) -> dict:
        return {"size": finite_or_none(self.size), "particle": self.particle, "X": list(self.place), "t": self.time,
                "file": self.file}


def largest_error(frames: Sequence[Frame], errors: Sequence[Errors], quantity: str) -> WorstParticle | None:
    """Returns the particle with the largest error of all frames; None where no file has the quantity."""
    found = [(float(error_magnitudes(e[quantity]).max()), k) for k, e in enumerate(errors) if quantity in e]
    if not found:
        return None
    size, k = max(found)
    p = int(np.argmax(error_magnitudes(errors[k][quantity])))
    place = tuple(map(float, frames[k].material_position[p]))
    return WorstParticle(size, int(frames[k].number[p]), place, frames[k].time, frames[k].file)


def cell_crossing_masks(scene: Scene, frames: Sequence[Frame]) -> Iterator[np.ndarray]:
    """Yields for each frame which particles (P,) have changed their cell since the frame before, or since rest."""
    before, corner = None, PROBLEMS[scene.problem].reference.grid_corner(scene)
    for frame in frames:
        order = np.lexsort(frame.material_position.T)
        X, x = frame.material_position[order], frame.position[order]
        if before is None or before[0].shape != X.shape or not np.array_equal(before[0], X):
            before = X, X
        was, now = (np.floor((place - corner) / scene.spacing) for place in (before[1], x))
        moved = np.empty(len(X), bool)
        moved[order] = (now != was).any(axis=1)
        yield moved
        before = X, x


def count_crossings(scene: Scene, frames: Sequence[Frame]) -> int:
    """Returns how often a particle was in another cell than at the time before: a lower bound of the crossings, because
    it may have gone back and forth in between."""
    return sum(int(moved.sum()) for moved in cell_crossing_masks(scene, frames))


def effectivity(estimated: dict[str, np.ndarray], true: dict[str, np.ndarray],
                scene: Scene | None = None) -> dict[str, float | None]:
    """Returns by quantity the sum of estimated norms (T,) over that of true ones; with a scene, None where the true
    error is only rounding."""
    return {q: error_index(estimated[q], true[q], largest_rounding_error(scene, q, scene.steps) if scene else 0.0)
            for q in QUANTITIES}


def differences(estimates: Sequence[Errors], errors: Sequence[Errors]) -> list[Errors]:
    """Returns estimates minus true errors (P, ...) by quantity, particle by particle, for each frame."""
    return [{q: mine[q] - theirs[q] for q in mine} for mine, theirs in zip(estimates, errors, strict=True)]


def distances(estimates: Sequence[Errors], errors: Sequence[Errors]) -> dict[str, float | None]:
    """Returns by quantity the norms of estimates minus true errors over those of true errors, summed over frames."""
    return effectivity(norm_series(differences(estimates, errors)), norm_series(errors))
