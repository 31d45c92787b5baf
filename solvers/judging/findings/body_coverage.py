"""Check that the particles in the files cover the whole body, by their masses or positions."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from solvers.judging.findings.finding import Finding, compare, unknown
from solvers.judging.findings.neighbour_comparison import MOST_ASKED, NeighbourSearch
from solvers.judging.particle_data_types import Frame
from solvers.problems import PROBLEMS
from solvers.problems.judging_reference import JudgingReference
from solvers.scene.scene import Scene
from solvers.scene.validation import SceneError
from solvers.translatable_message import Message

NAME, UNIT = "part of the body that no particle stands for", "of the body"
ON_LATTICE = 1e-3  # of the distance of particles, within which a place coincides with one of a lattice
MOST_EMPTY = 20  # times as many places as particles: with more of them empty the lattice is none of theirs
MOST_PLACES, FEW = 2_000_000, 100  # of a candidate lattice; particles of a first test
MOST_EACH_WAY = 8  # particles per direction in a cell of candidate lattices
STAIRS = 0.5  # of a particle may be too much or too little at each place of a rim, by chance
LEAST = 0.02  # of the body that may be missing unreported
FOURTH = 4  # of the nearest others: on any lattice, and by chance, little of the body is far beyond its distance
FEWEST_EACH_WAY = 8  # particles per dimension from which on distances say something
VACANT = 0.5  # of their distance: a place where a particle should be, with none so near
AT_A_HOLE = 1.5  # times the particles' distance: farther from the next is a hole
POINTS = 4000  # of the body, about, at which holes are searched
HOLES = Message("by the holes between them")


@dataclass(frozen=True)
class BodyShare:
    """Covered ``share`` (0 to 1) of the body and ``how`` it was determined; ``least`` is the limit of a whole body."""

    share: float
    least: float
    how: str

    def to_finding(self, count: int) -> Finding:
        return compare(NAME, abs(1 - self.share), 1 - self.least, UNIT,
                       Message("the {count:,} particles cover {share:.3g} % of the body ({how}): the norms are over "
                               "these alone", count, 100 * self.share, self.how), self.how)


def check_body_is_covered(scene: Scene, frame: Frame) -> Finding:
    """Checks that a frame, the one with the fewest particles, covers the scene's whole body."""
    reference, count, X = PROBLEMS[scene.problem].reference, len(frame.number), frame.material_position
    lattice = _share_by_lattice(scene, reference, X)
    by_size = _share_by_mass(scene, reference, frame) or (None if lattice else _share_by_distance(scene, reference, X))
    known = [share for share in (by_size, lattice or _share_by_vacancies(scene, reference, X)) if share]
    found = [share.to_finding(count) for share in known]
    return max(found, key=lambda one: (one.is_contradiction, one.measured), default=unknown(
        NAME, f"of {count:,} particles, without masses, volumes or a lattice"))


def _share_by_mass(scene: Scene, reference: JudgingReference, frame: Frame) -> BodyShare | None:
    """Returns the covered share (0 to 1) of the body by masses or volumes in the file, None without these."""
    weights, word = (frame.volume, Message("volumes")) if frame.mass is None else (frame.mass, Message("masses"))
    if weights is None:
        return None
    start = reference.start(scene)
    size = float(start.volume.sum())
    F = reference.initial_deformation_gradient(scene, start.material_position)
    whole = size if word == "volumes" else scene.density * float(np.sum(start.volume / np.linalg.det(F)))
    across = float(np.ptp(start.material_position, axis=0).max())
    D, P = frame.material_position.shape[1], len(weights)
    side = (size / P) ** (1 / D)
    rims = STAIRS * side**2 * np.sqrt(2 * np.pi * across / side) / size if D > 1 else 0.0
    return BodyShare(float(np.sum(weights)) / whole, 1 - max(LEAST, rims), Message("by the {word} in the files", word))


def _share_by_lattice(scene: Scene, reference: JudgingReference, X: np.ndarray) -> BodyShare | None:
    """Returns the covered share of the body by occupied places, where all particles at X (P, D) lie on one of our
    layouts; of several that with the fewest particles. None without one."""
    fitting: list[tuple[np.ndarray, np.ndarray, Scene]] = []
    few = X[::-(-len(X) // FEW)]
    for candidate in _lattices(scene):
        # of a Cartesian one about so many
        if candidate != scene and not 0.5 * len(X) <= candidate.particles <= min(MOST_EMPTY * len(X), MOST_PLACES):
            continue
        places = reference.start(candidate).material_position
        if len(places) < len(X) or (fitting and len(places) >= len(fitting[0][0])):
            continue
        near = (candidate.spacing / candidate.ppc) * ON_LATTICE
        lattice = NeighbourSearch(places)
        if (lattice.nearest(few, 1)[0] > near).any():
            continue
        far, who = lattice.nearest(X, 1)
        if (far <= near).all() and len(np.unique(who)) == len(X):
            fitting = [(places, who, candidate)]
    if not fitting:
        return None
    places, who, candidate = fitting[0]
    weight = reference.start(candidate).volume
    empty = np.setdiff1d(np.arange(len(places)), who)
    if getattr(candidate, "layout", "") == "cartesian":  # which of the places at its rims are inside, codes may differ
        side = candidate.spacing / candidate.ppc
        beside = places[empty, None] + side * np.concatenate([np.eye(2), -np.eye(2)])
        empty = empty[~reference.is_outside(scene, beside.reshape(-1, 2)).reshape(-1, 4).any(axis=1)]
    share = 1 - float(weight[empty].sum() / weight.sum())
    return BodyShare(share, 1 - 0.5 / len(places), Message("{short:,} of the {places:,} places of a lattice of {ppc:g} "
                                                           "a cell in each direction are empty", len(empty),
                                                           len(places), candidate.ppc))


def _lattices(scene: Scene) -> list[Scene]:
    """Returns the scene, and those like it with other numbers of particles per cell and other layouts."""
    tried = [scene]
    layouts = type(scene).choices("layout") if "layout" in type(scene).__dataclass_fields__ else (None,)
    for ppc in dict.fromkeys((scene.ppc, *range(1, MOST_EACH_WAY + 1))):
        for layout in layouts:
            try:
                more: dict[str, Any] = {} if layout is None else {"layout": layout}
                tried.append(replace(scene, ppc=ppc, **more))
            except SceneError:
                continue
    return tried


def _share_by_distance(scene: Scene, reference: JudgingReference, X: np.ndarray) -> BodyShare | None:
    """Returns the share of the body that has particles at X (P, D) nearby; None for too few particles."""
    if len(X) < FEWEST_EACH_WAY * X.shape[1]:
        return None
    around = NeighbourSearch(X)
    apart = float(np.median(around.nearest(_some_of(X), FOURTH + 1)[0][:, -1]))
    if not np.isfinite(apart):
        return None
    cells = max(type(scene).FEWEST_CELLS, min(scene.cells, round(0.5 * POINTS ** (1 / scene.DIMENSIONS))))
    points = reference.start(replace(scene, cells=cells, ppc=2)).material_position
    distance = NeighbourSearch(X, max(around.width, AT_A_HOLE * apart)).nearest(points, 1)[0][:, 0]
    return BodyShare(1 - float(np.mean(distance > AT_A_HOLE * apart)), 1 - LEAST, HOLES)


def _share_by_vacancies(scene: Scene, reference: JudgingReference, X: np.ndarray) -> BodyShare | None:
    """Returns the occupied share of the places opposite each particle's nearest neighbours, where particles at X (P, D)
    form a lattice of any kind; None where they do not."""
    if len(X) < FEWEST_EACH_WAY * X.shape[1]:
        return None
    around, some = NeighbourSearch(X), _some_of(X)
    far, who = (found[:, 1:] for found in around.nearest(some, FOURTH + 1))  # without itself
    side = float(np.median(far[:, 0]))
    if not np.quantile(far[:, 0], 0.75) <= 1.1 * np.quantile(far[:, 0], 0.25):
        return None
    beside = np.nonzero(far <= 1.2 * side)  # the nearest
    step = some[beside[0]] - X[who[beside]]
    place = some[beside[0]] + step
    inside = ~(reference.is_outside(scene, place) | reference.is_outside(scene, place + 0.6 * step))
    if not inside.any():
        return None
    vacant = around.nearest(place[inside], 1)[0] > VACANT * side
    return BodyShare(1 - float(np.mean(vacant)), 1 - 0.5 / len(vacant), HOLES)


def _some_of(X: np.ndarray) -> np.ndarray:
    """Returns at most ``MOST_ASKED`` of the points X (P, D), evenly chosen."""
    return X[::-(-len(X) // MOST_ASKED)]
