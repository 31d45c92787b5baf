"""A thing that was looked at: what came, from where on that is none of a sound run, and what is said of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from solvers.solver.norms import finite

BROKEN, SUSPICIOUS, HOLDS, UNKNOWN = "broken", "suspicious", "holds", "cannot be told"


@dataclass(frozen=True)
class Finding:
    """``name`` says what was held against what. ``measured`` and ``limit`` are in ``unit``, None where there is no
    number. ``says`` is a sentence without its full stop: what is wrong, why nothing can be told, or what else there is
    to say. Where it is wrong: ``time`` in s, ``particle`` by its number in the files, and its reference ``place``."""

    name: str
    verdict: str
    measured: float | None = None
    limit: float | None = None
    unit: str = ""
    says: str = ""
    time: float | None = None
    particle: int | None = None
    place: tuple[float, ...] | None = None

    @property
    def wrong(self) -> bool:
        return self.verdict in (BROKEN, SUSPICIOUS)

    def to_dict(self) -> dict[str, Any]:
        measured, limit = (None if value is None else finite(value) for value in (self.measured, self.limit))
        return {"finding": self.name, "verdict": self.verdict, "measured": measured, "limit": limit, "unit": self.unit,
                "says": self.says, "t": self.time, "particle": self.particle,
                "X": None if self.place is None else list(self.place)}


def unknown(name: str, why: str) -> Finding:
    return Finding(name, UNKNOWN, says=why)
