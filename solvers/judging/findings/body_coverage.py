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
VACANT = 0.35  # of their distance: a place where a particle should be, with none so near
AT_A_HOLE = 1.5  # times the particles' distance: farther from the next is a hole
POINTS = 4000  # of the body, about, at which holes are searched


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
    reference, count = PROBLEMS[scene.problem].reference, len(frame.number)
    found = _share_by_mass(scene, reference, frame) or _share_by_lattice(scene, reference, frame.material_position) \
        or _share_by_holes(scene, reference, frame.material_position)
    return found.to_finding(count) if found else unknown(
        NAME, f"of {count:,} particles, without masses, volumes or a lattice")


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
    short = len(places) - len(X)
    weight = reference.start(candidate).volume
    share = float(weight[who[:, 0]].sum() / weight.sum())
    return BodyShare(share, 1 - 0.5 / len(places), Message("{short:,} of the {places:,} places of a lattice of {ppc:g} "
                                                           "a cell in each direction are empty", short, len(places),
                                                           candidate.ppc))


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


def _share_by_holes(scene: Scene, reference: JudgingReference, X: np.ndarray) -> BodyShare | None:
    """Returns the covered share of the body by empty places between particles at X (P, D), and by parts of the body
    without particles nearby; None for too few particles."""
    P, D = X.shape
    if P < 8 * D:
        return None
    around = NeighbourSearch(X)
    some = np.arange(0, P, -(-P // MOST_ASKED))
    far, who = (found[:, 1:] for found in around.nearest(X[some], FOURTH + 1))  # without itself
    side, apart = float(np.median(far[:, 0])), float(np.median(far[:, -1]))
    if not np.isfinite(apart):
        return None
    cells = max(type(scene).FEWEST_CELLS, min(scene.cells, round(0.5 * POINTS ** (1 / scene.DIMENSIONS))))
    points = reference.start(replace(scene, cells=cells, ppc=2)).material_position
    distance = NeighbourSearch(X, max(around.width, AT_A_HOLE * apart)).nearest(points, 1)[0][:, 0]
    bare = float(np.mean(distance > AT_A_HOLE * apart))
    vacant = 0.0
    if np.quantile(far[:, 0], 0.75) <= 1.1 * np.quantile(far[:, 0], 0.25):  # a lattice: what is beside one is opposite
        beside = np.nonzero(far <= 1.2 * side)  # the nearest
        step = X[some[beside[0]]] - X[who[beside]]
        place = X[some[beside[0]]] + step
        inside = ~(reference.is_outside(scene, place) | reference.is_outside(scene, place + 0.6 * step))
        if inside.any():
            vacant = float(np.mean(around.nearest(place[inside], 1)[0] > VACANT * side))
    return BodyShare(1 - max(bare, vacant), 1 - LEAST, Message("by the holes between them"))
