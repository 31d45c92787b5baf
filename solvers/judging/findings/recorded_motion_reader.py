"""Motion of particles of any problem: the same particles at all times, with all quantities in the files."""

import functools
import itertools
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from solvers.judging.findings.finding import BROKEN, HOLDS, Finding
from solvers.judging.findings.findings_input import largest_stored_rounding
from solvers.judging.findings.neighbour_comparison import (
    MOST,
    TINY,
    NearestNeighbours,
    departures,
    find_neighbours,
)
from solvers.judging.findings.row_identities import RowsAtTime, check_identities, identify_rows
from solvers.judging.findings.time_series_fitting import largest_rms
from solvers.judging.particle_data_types import (
    RawTable,
    group_rows_by_time,
    identity_hint,
    row_times,
    unread_columns,
)
from solvers.judging.particle_scene_matching import FLAT, LARGEST
from solvers.judging.quantity_names import describe_columns
from solvers.untrusted.quoting import FileError, quote

MOST_MOMENTS = 32  # that are checked one by one, evenly spread
BOXES = 10  # that represent a large body
VECTORS, TENSORS, SCALARS = ("x", "v"), ("F", "sigma"), ("mass", "volume")
NUMBERS = "all numbers are finite"
LEAVES, MOST_LEAVING = 0.5, 0.01  # of the distance, and of the particles: by which rows keep their order
SAME_TIME = 1e-12  # of the last time
FEWEST = 3  # particles
ROUNDED = 4.0  # times the rounding of a number, from which on a motion is more than that
NOTHING = 1e-6  # of the spacing: what the rounding of many steps may add up to, also where a method makes it grow


@dataclass(frozen=True)
class NeighbourPairs:
    """Pairs (n,) of neighbours in the reference configuration: indices ``one`` and ``other``, distance vectors
    ``apart`` (n, D) from one to other and their ``length`` (n,) in m."""

    one: np.ndarray
    other: np.ndarray
    apart: np.ndarray
    length: np.ndarray

    def deformed_vectors(self, F: np.ndarray) -> np.ndarray:
        """Returns distance vectors (n, D) in m by each pair's mean F (P, D, D): trapezoidal rule, third-order error."""
        return np.einsum("nij,nj->ni", 0.5 * (F[self.one] + F[self.other]), self.apart)


@dataclass(frozen=True)
class RecordedMotion:
    """P particles at T increasing times in s.

    ``reference`` (P, D) are their positions before all deformation, or at the first time where the files do not contain
    these (``from_start``). ``fields`` has x and v (T, P, D), F and sigma (T, P, D, D), mass and volume (T, P), if the
    files have finite values at all times. ``step`` is the run's time step in s if known.
    """

    times: np.ndarray
    number: np.ndarray
    reference: np.ndarray
    from_start: bool
    fields: dict[str, np.ndarray]
    step: float | None = None
    notes: list[str] = field(default_factory=list)
    by_rows: bool = False  # nothing but the order of rows says which particles they are

    @property
    def x(self) -> np.ndarray:
        return self.fields["x"]

    @property
    def dimensions(self) -> int:
        return self.reference.shape[1]

    @functools.cached_property
    def deformation_gradient(self) -> np.ndarray | None:
        """F (T, P, D, D) relative to the reference; if that is the first time, F times the inverse of F then."""
        F = self.fields.get("F")
        if F is None or not self.from_start:
            return F
        return F @ np.linalg.inv(F[0]) if (np.abs(np.linalg.det(F[0])) > TINY).all() else None

    def get(self, needed: str) -> np.ndarray | None:
        """Returns a quantity's field by its key, or F relative to the reference for ``gradient``; None without one."""
        return self.deformation_gradient if needed == "gradient" else self.fields.get(needed)

    @functools.cached_property
    def checked_time_indices(self) -> list[int]:
        """Indices of the times that are checked one by one, including the first and the last."""
        T = len(self.times)
        return sorted(set(np.linspace(0, T - 1, min(T, MOST_MOMENTS)).round().astype(int).tolist()))

    @functools.cached_property
    def neighbourhood(self) -> NearestNeighbours | None:
        """Neighbourhoods in the reference configuration; None for too few particles."""
        return find_neighbours(self.reference)

    @functools.cached_property
    def neighbour_pairs(self) -> NeighbourPairs | None:
        """Pairs of each particle with its nearest neighbours, two per dimension; None without any."""
        if self.neighbourhood is None:
            return None
        count = 2 * self.dimensions
        there = self.neighbourhood.there[:, :count]
        one = np.repeat(np.arange(len(self.reference)), there.sum(axis=1))
        other = self.neighbourhood.who[:, :count][there]
        apart = self.reference[other] - self.reference[one]
        length = np.linalg.norm(apart, axis=1)
        real = length > 0
        return NeighbourPairs(one[real], other[real], apart[real], length[real]) if real.any() else None

    @functools.cached_property
    def spacing(self) -> float:
        """Median distance in m of particles from their nearest neighbours in the reference configuration."""
        return float(np.median(self.neighbour_pairs.length)) if self.neighbour_pairs else np.nan

    @functools.cached_property
    def amplitude(self) -> float:
        """Size in m of the particles' relative motion: the largest RMS of the displacement without its mean, at least
        what rounding may feign of it."""
        moved = self.x - self.reference
        return max(largest_rms(moved - moved.mean(axis=1, keepdims=True)), self.rounding)

    @functools.cached_property
    def rounding(self) -> float:
        """Distance in m that rounding may feign: of positions, of F over the body's length, and of many steps."""
        length = float(np.ptp(self.reference, axis=0).max())
        of_numbers = self.stored_rounding["x"] + self.stored_rounding.get("F", 0.0) * length
        return ROUNDED * of_numbers + NOTHING * (0.0 if np.isnan(self.spacing) else self.spacing)

    @functools.cached_property
    def stored_rounding(self) -> dict[str, float]:
        """Largest rounding error of the numbers of each field in the files, by its key, in its unit."""
        return {key: largest_stored_rounding(list(values)) for key, values in self.fields.items()}

    @functools.cached_property
    def speed(self) -> float:
        """Largest RMS of the velocity, in m/s; 0 where that moves the particles by no more than rounding."""
        size = largest_rms(self.fields["v"])
        return 0.0 if size * float(np.ptp(self.times)) <= self.rounding else size

    def doubt_about_rows(self, not_read: Sequence[str]) -> str:
        """Returns why rows may be of other particles at another moment; "" where they are known, or keep their order as
        can be seen: between two moments hardly any particle leaves what its neighbours move by half their distance."""
        if not self.by_rows:
            return ""
        near, moves = self.neighbourhood, np.diff(self.x, axis=0)
        why = "they are too few to see whether they keep their order"
        if near is not None:
            lost = [int((departures(near, move) > LEAVES * self.spacing).sum()) for move in moves]
            if max(lost) <= MOST_LEAVING * len(self.reference):
                return ""
            k = int(np.argmax(lost))
            why = (f"{lost[k]:,} of {len(self.reference):,} do not keep their order, or part, between t = "
                   f"{self.times[k]:.4g} and {self.times[k + 1]:.4g} s")
        return f"nothing says which particles the rows are, and {why}; give id or X" + identity_hint(not_read)

    @functools.cached_property
    def representative_part(self) -> "RecordedMotion":
        """Motion of the particles in some boxes spread over the body, where all are too many to find neighbours."""
        P, D = self.reference.shape
        if P <= MOST:
            return self
        low, reach = self.reference.min(axis=0), np.ptp(self.reference, axis=0)
        sides = int(np.ceil((P * BOXES / MOST) ** (1 / D)))
        place = np.minimum((sides * (self.reference - low) / np.maximum(reach, TINY)).astype(int), sides - 1)
        boxes, box, counts = np.unique(place, axis=0, return_inverse=True, return_counts=True)
        order = np.argsort(np.arange(len(boxes)) * 0.5 * (5**0.5 - 1) % 1)  # far from each other, one after the other
        which = np.isin(box.ravel(), order[:max(1, int(np.sum(np.cumsum(counts[order]) <= MOST)))])
        return replace(self, number=self.number[which], reference=self.reference[which],
                       fields={key: values[:, which] for key, values in self.fields.items()})

    def finding_location(self, moment: int, p: int) -> dict:
        """Returns the fields time, particle and place of a ``Finding``, from indices of time and particle."""
        return {"time": float(self.times[moment]), "particle": int(self.number[p]),
                "place": tuple(map(float, self.reference[p]))}


def read_motion(files: Sequence[RawTable], times: Sequence[float]) -> tuple[RecordedMotion, list[Finding]]:
    """Returns the motion in the files, and findings about invalid numbers and missing particles. The motion ends before
    the first time with positions that are not finite. ``times`` in s are those of the files, if they contain none.
    Raises :class:`FileError` where there are no two times with the same particles to compare."""
    moments = sorted(_read_rows_by_time(files, times), key=lambda one: one.time)
    _check_distinct_times(moments)
    findings = [_check_finite_numbers(moments)]
    sound = [one for one in moments if np.isfinite(one.rows["x"]).all() and (np.abs(one.rows["x"]) < LARGEST).all()]
    sound = sound[:next((k for k, (a, b) in enumerate(zip(sound, moments, strict=False)) if a is not b), len(sound))]
    if len(sound) < 2:
        raise FileError(moments[min(len(sound), len(moments) - 1)].file,
                        "leaves fewer than two moments whose positions are all numbers; give moments from before that")
    who, by_rows = identify_rows(sound, unread_columns(files))
    finding, common = check_identities(sound, who)
    findings.append(finding)
    if len(common) < FEWEST:
        raise FileError(sound[-1].file, f"has {len(common)} particles that are there at all moments; give {FEWEST} or "
                                        "more")
    return replace(_assemble_motion(files, sound, who, common), by_rows=by_rows), findings


def _read_rows_by_time(files: Sequence[RawTable], times: Sequence[float]) -> list[RowsAtTime]:
    found = []
    if len({raw.cells for raw in files if raw.cells is not None}) > 1:
        raise FileError(files[-1].file, "is of another grid than the others; give the files of one run")
    for k, raw in enumerate(files):
        if "x" not in raw.columns:
            raise FileError(raw.file, f"has no positions ({describe_columns('x', 3)} or position); its columns are "
                                      f"{', '.join(quote(name, 20) for name in raw.names[:12])}")
        every = row_times(raw, times[k] if times else None)
        found += [RowsAtTime(raw.file, float(every[at][0]), {key: values[at] for key, values in raw.columns.items()
                                                              if key != "t"}) for at in group_rows_by_time(every)]
    return found


def _check_distinct_times(moments: list[RowsAtTime]) -> None:
    if len(moments) < 2:
        raise FileError(moments[0].file, "has one moment, and nothing within one contradicts a motion; give two or "
                                         "more")
    near = SAME_TIME * moments[-1].time
    for one, other in itertools.pairwise(moments):
        if other.time - one.time <= near:
            raise FileError(other.file, f"has the time {other.time:g} s, which {quote(one.file)} has too; give each "
                                        "time once, and the files of one run")
    widths = {one.rows["x"].shape[1] for one in moments}
    if len(widths) > 1:
        raise FileError(moments[-1].file, "has positions in another number of directions than the others; give the "
                                          "files of one run")


def _check_finite_numbers(moments: list[RowsAtTime]) -> Finding:
    """Checks that all numbers are finite, and reports the first that is not."""
    for one in moments:
        for key, values in one.rows.items():
            bad = ~(np.abs(values.reshape(len(values), -1)) < LARGEST).all(axis=1)
            if count := int(bad.sum()):
                row = int(np.argmax(bad))
                who = int(one.rows["id"][row]) if "id" in one.rows and np.isfinite(one.rows["id"][row]) else row
                return Finding(NUMBERS, BROKEN, float(count), 0.0, "particles",
                               f"{key} of {count:,} particle{'s' * (count != 1)} is no number, or beyond "
                               f"{LARGEST:g}, at t = {one.time:.4g} s, first of particle {who}; what comes later was "
                               "not looked at", one.time, who)
    return Finding(NUMBERS, HOLDS)


def _assemble_motion(files: Sequence[RawTable], moments: list[RowsAtTime], who: list[np.ndarray],
                     common: np.ndarray) -> RecordedMotion:
    """Returns the motion of the particles ``common``, in order, in the directions in which they extend."""
    rows: list[Any] = []
    for now in who:
        if len(now) == len(common) and np.array_equal(now, common):
            rows.append(slice(None))
        else:
            first, at = np.unique(now, return_index=True)
            rows.append(at[np.searchsorted(first, common)])
    x = np.stack([one.rows["x"][at] for one, at in zip(moments, rows, strict=True)])
    reach = np.ptp(x.reshape(-1, x.shape[-1]), axis=0)
    axes = np.flatnonzero(reach > FLAT * reach.max()) if reach.max() > 0 else np.arange(1)
    fields, notes = {"x": x[..., axes]}, list[str]()
    for key in (*VECTORS[1:], *TENSORS, *SCALARS):
        if not all(key in one.rows for one in moments):
            continue
        values = np.stack([one.rows[key][at] for one, at in zip(moments, rows, strict=True)])
        if key not in SCALARS and values.shape[-1] <= axes.max():
            notes.append(f"{key} has {values.shape[-1]} directions and the positions more, so it was left out")
            continue
        values = values[..., axes] if key in VECTORS else values[..., axes[:, None], axes] if key in TENSORS else values
        if not (np.abs(values) < LARGEST).all():
            notes.append(f"{key} is not always a number, so it was left out")
            continue
        fields[key] = values
    X = moments[0].rows.get("X")
    usable = X is not None and X.shape[1] > axes.max() and (np.abs(X) < LARGEST).all()
    reference = X[rows[0]][:, axes] if usable else fields["x"][0]  # type: ignore[index]  # it is usable
    step = next((raw.step for raw in files if raw.step is not None), None)
    return RecordedMotion(np.array([one.time for one in moments]), common, reference, not usable, fields, step, notes)
