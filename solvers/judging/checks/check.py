"""A thing that was compared: what came, what it may be, and what is said of it."""

from __future__ import annotations

from dataclasses import dataclass

from solvers.solver.norms import finite

HOLDS, OFF, UNKNOWN = "holds", "does not hold", "cannot be told"


@dataclass(frozen=True)
class Check:
    """``name`` says what was held against what. ``measured`` and ``tolerance`` are in ``unit``, None where there is no
    number; beyond the tolerance, either way, it does not hold. ``says`` is a sentence without its full stop: what is
    wrong, why nothing can be told, or what else there is to say."""

    name: str
    measured: float | None
    tolerance: float | None
    unit: str
    verdict: str
    says: str = ""

    def to_dict(self) -> dict:
        measured, tolerance = (None if value is None else finite(value) for value in (self.measured, self.tolerance))
        return {"check": self.name, "measured": measured, "tolerance": tolerance, "unit": self.unit,
                "verdict": self.verdict, "says": self.says}


def unknown(name: str, why: str, measured: float | None = None, unit: str = "") -> Check:
    return Check(name, measured, None, unit, UNKNOWN, why)
