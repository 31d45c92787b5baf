"""Particles as they were at an instant, whoever computed them, and the grids that they belong to."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from solvers.outside import quoting
from solvers.outside.file_error import FileError


class Misfit(FileError):
    """Particles that are not those of the problem: for a ``reason``, with what is ``allowed``; ``problems`` are those
    that they could be of."""

    def __init__(self, file: str, reason: str, allowed: str, problems: tuple[str, ...] = ()):
        self.reason, self.allowed, self.problems = quoting.sentence(reason), allowed, problems
        fits = f"it fits {' or '.join(f'`mpm-lab judge {problem}`' for problem in problems)}" if problems else allowed
        super().__init__(file, f"{reason}; {fits}")


@dataclass(frozen=True)
class Said:
    """What a file says of its scene: the problem, and the inputs of it that matter to a judge, by their fields."""

    problem: str
    inputs: Mapping[str, Any]
    step: float | None = None  # of its run, s


@dataclass(frozen=True)
class Raw:
    """A file as it was read: one table of n rows. ``columns`` maps the keys of ``columns`` to (n, ...), vectors (n, d)
    and tensors (n, d, d) of as many dimensions as the file has; ``cells`` is what it says of its grid, ``said`` of its
    whole scene."""

    file: str
    columns: dict[str, np.ndarray]
    names: tuple[str, ...]  # of everything in the file, for messages
    time: float | None = None
    cells: int | None = None
    said: Said | None = None
    step: float | None = None  # of its run in s, where it says that


@dataclass(frozen=True)
class Frame:
    """P particles at a ``time``: material position and position (P, D), what there is of velocity (P, D), F and Cauchy
    stress (P, D, D), mass in kg and volume in m^D (P,), and the ``number`` (P,) of each in the file, its id where it
    has one."""

    file: str
    time: float
    number: np.ndarray
    material_position: np.ndarray
    position: np.ndarray
    velocity: np.ndarray | None = None
    deformation_gradient: np.ndarray | None = None
    stress: np.ndarray | None = None
    mass: np.ndarray | None = None
    volume: np.ndarray | None = None


@dataclass(frozen=True)
class Grid:
    """The frames of one run, by their times; ``notes`` are sentences about what was found in the files, ``step`` is
    that of the run in s where they say it."""

    cells: int
    frames: tuple[Frame, ...]
    notes: tuple[str, ...] = ()
    step: float | None = None

    @property
    def times(self) -> np.ndarray:
        return np.array([frame.time for frame in self.frames])
