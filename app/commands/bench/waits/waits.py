"""All that people wait for, in this code and perhaps in another folder of it, as one object."""

from collections.abc import Callable
from typing import Any

from app.commands.bench.waits.checkout import Checkout
from app.commands.bench.waits.commands import commands, step
from app.commands.bench.waits.page import page
from app.commands.bench.waits.turns import SCHEMA, take_turns
from app.commands.bench.waits.visits import searches, thirty


def waits(now: Checkout, before: Checkout | None, quick: bool, on_progress: Callable[[float], None]) -> dict[str, Any]:
    """Measure everything, three times and ``quick`` once. Rows are what is measured: its name, its unit, the processors
    that other work had meanwhile, and of each checkout the median, the least and the most."""
    from solvers.bench.bench import machine  # here: it brings Taichi along, which no bad input need wait for

    where = machine()  # before: its load is others' work
    everything = [page(), *searches(), thirty(quick), *commands(), step()]
    rows = take_turns(everything, {**({"before": before} if before else {}), "now": now}, quick, on_progress)
    return {"schema": SCHEMA, "quick": quick, "machine": where, "beside": before is not None, "rows": rows}
