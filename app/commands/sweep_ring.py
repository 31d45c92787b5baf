"""``mpm-lab sweep ring``."""

from __future__ import annotations

from dataclasses import dataclass

from app.commands.flags import Switch
from app.commands.run_ring import RingFlags
from app.commands.sweep import Sweep


@dataclass(frozen=True, kw_only=True)
class SweepRing(Sweep, RingFlags):
    """Run the expanding ring for every combination of the values given: what accuracy costs in time.

    Give any flag of a scene several values: --cells 12 24 48 --method ugimp cpdi. Each combination is a row with its
    errors, estimates, times and status; rows are kept as they finish. Tables and pictures follow at the end.
    Exit status: 0 every row is there, 1 could not run or write, 2 bad input, 130 stopped by Ctrl-C (rows are kept).
    """

    linearity_preserving: Switch = False
    """Not offered for the ring: only off is accepted."""
