"""Result of one check: the measured value, the limit of sound runs, and a sentence."""

from dataclasses import dataclass
from typing import Any

from solvers.solver.error_series import finite_or_none

HOLDS, UNKNOWN = "holds", "cannot be told"
OFF = "does not hold"  # against what a problem's particles should be
BROKEN, SUSPICIOUS = "broken", "suspicious"  # of a motion alone: what cannot be, and what should not


@dataclass(frozen=True)
class Finding:
    """Result of a check: ``name`` says what was compared. ``measured`` and ``limit`` are in ``unit``, None without a
    number. ``says`` is a sentence without its full stop: what is wrong, why the check is impossible, or a remark. If
    known, a defect's location: ``time`` in s, ``particle`` number in the files, and reference ``place`` in m."""

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
        """Whether the check failed; false where it holds or is impossible."""
        return self.verdict in (OFF, BROKEN, SUSPICIOUS)

    def to_dict(self) -> dict[str, Any]:
        """Returns the JSON object of ``mpm-lab check``."""
        measured, limit = map(finite_or_none, (self.measured, self.limit))
        return {"finding": self.name, "verdict": self.verdict, "measured": measured, "limit": limit, "unit": self.unit,
                "says": self.says, "t": self.time, "particle": self.particle,
                "X": None if self.place is None else list(self.place)}

    def to_judge_dict(self) -> dict[str, Any]:
        """Returns the JSON object of ``mpm-lab judge``."""
        measured, tolerance = map(finite_or_none, (self.measured, self.limit))
        return {"check": self.name, "measured": measured, "tolerance": tolerance, "unit": self.unit,
                "verdict": self.verdict, "says": self.says}


def unknown(name: str, why: str, measured: float | None = None, unit: str = "") -> Finding:
    """Returns the finding of an impossible check; ``why`` is a sentence without its full stop."""
    return Finding(name, UNKNOWN, measured, unit=unit, says=why)


def compare(name: str, measured: float, limit: float, unit: str, wrong: str, right: str = "") -> Finding:
    """Returns a finding that holds up to the ``limit``, with the remark ``right``, and fails beyond, with ``wrong``."""
    holds = measured <= limit
    return Finding(name, HOLDS if holds else OFF, measured, limit, unit, right if holds else wrong)
