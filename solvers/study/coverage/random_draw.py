"""Random draws by number: the same number and seed give the same draw, however many are drawn. Each is one row."""

import hashlib
import json
import math
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any, ClassVar

import numpy as np

from solvers.study.row import FAILED, solver_source_hash

#: Schema of the identity of a draw's row.
IDENTITY = {"key": str, "problem": str, "seed": int, "number": int, "status": str, "reason": (str, type(None))}


@dataclass(frozen=True)
class RandomDraw:
    """Random draw of a ``problem`` ("bar"), the same for equal ``seed`` and ``number``; a task of ``study.executors``.
    ``SCHEMA`` names the schema of its row."""

    SCHEMA: ClassVar[str]
    problem: str
    seed: int
    number: int

    @property
    def key(self) -> str:
        """Key of the draw's row: 16 hexadecimal digits of a hash."""
        return hashlib.sha256(json.dumps(asdict(self), sort_keys=True).encode()).hexdigest()[:16]

    def remarks(self) -> list[str]:
        """Returns no remarks on the inputs, because nobody has chosen them."""
        return []

    def to_dict(self) -> dict:
        return asdict(self)

    def identity_columns(self) -> dict:
        """Returns the columns of the row that identify the draw."""
        return {"schema": self.SCHEMA, "key": self.key, **self.to_dict(), "solvers": solver_source_hash()}

    def failed_row(self, reason: str) -> dict:
        """Returns the row of a draw that could not be measured, with the ``reason`` as one line."""
        return {**self.identity_columns(), "status": FAILED, "reason": " ".join(reason.split())}

    def row(self, measure: Callable[[Any], dict]) -> dict:
        """Returns the row that ``measure(self)`` returns; an error becomes a row, never raised."""
        try:
            return measure(self)
        except Exception as error:
            return self.failed_row(f"{type(error).__name__}: {error}")

    def random_generator(self, purpose: int) -> np.random.Generator:
        """Returns the generator of random numbers for one ``purpose`` of several."""
        return np.random.default_rng([self.seed, self.number, purpose, *self.problem.encode()])


def draw_between(chance: np.random.Generator, low: float, high: float) -> float:
    """Returns a random number whose logarithm is uniform between those of ``low`` and ``high``."""
    return math.exp(chance.uniform(math.log(low), math.log(high)))
