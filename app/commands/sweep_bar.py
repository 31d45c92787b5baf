"""``mpm-lab sweep bar``."""

from __future__ import annotations

from dataclasses import dataclass

from app.commands.flags import Switch
from app.commands.run_bar import BarFlags
from app.commands.sweep import Sweep


@dataclass(frozen=True, kw_only=True)
class SweepBar(Sweep, BarFlags):
    """Run the vibrating bar for every combination of the values given: what accuracy costs in time.

    Give any flag of a scene several values: --cells 20 40 80 --method ugimp bspline. Each combination is a row with
    its errors, estimates, times and status; rows are kept as they finish. Tables and pictures follow at the end.
    Exit status: 0 every row is there, 1 could not run or write, 2 bad input, 130 stopped by Ctrl-C (rows are kept).
    """

    linearity_preserving: Switch = False
    """Make the particle-grid transfers exact for linear fields."""
