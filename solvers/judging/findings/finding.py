"""A thing that was looked at: what came, from where on that is none of a sound run, and what is said of it."""

from dataclasses import dataclass
from typing import Any

from solvers.solver.error_norms import finite

HOLDS, UNKNOWN = "holds", "cannot be told"
OFF = "does not hold"  # against what a problem's particles should be
BROKEN, SUSPICIOUS = "broken", "suspicious"  # of a motion alone: what cannot be, and what should not


@dataclass(frozen=True)
class Finding:
    """``name`` says what was held against what. ``measured`` and ``limit`` are in ``unit``, None where there is no
    number. ``says`` is a sentence without its full stop: what is wrong, why nothing can be told, or what else there is
    to say. Where it is wrong, if that is known: ``time`` in s, ``particle`` by its number in the files, and its
    reference ``place``."""

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
    def is_contradiction(self) -> bool:
        return self.verdict in (OFF, BROKEN, SUSPICIOUS)

    def to_dict(self) -> dict[str, Any]:
        """As ``mpm-lab check`` writes it."""
        measured, limit = map(finite, (self.measured, self.limit))
        return {"finding": self.name, "verdict": self.verdict, "measured": measured, "limit": limit, "unit": self.unit,
                "says": self.says, "t": self.time, "particle": self.particle,
                "X": None if self.place is None else list(self.place)}

    def to_judge_dict(self) -> dict[str, Any]:
        """As ``mpm-lab judge`` writes it."""
        measured, tolerance = map(finite, (self.measured, self.limit))
        return {"check": self.name, "measured": measured, "tolerance": tolerance, "unit": self.unit,
                "verdict": self.verdict, "says": self.says}


def unknown(name: str, why: str, measured: float | None = None, unit: str = "") -> Finding:
    return Finding(name, UNKNOWN, measured, unit=unit, says=why)


def compare(name: str, measured: float, limit: float, unit: str, wrong: str, right: str = "") -> Finding:
    """What does not hold beyond the limit, and is ``wrong`` then; else what there is to say all the same."""
    holds = measured <= limit
    return Finding(name, HOLDS if holds else OFF, measured, limit, unit, right if holds else wrong)
