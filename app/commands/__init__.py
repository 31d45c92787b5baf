"""The commands of ``mpm-lab``, one file each.

A command is a frozen dataclass: its fields are its flags, its docstring is its help, and ``execute()`` does
the work and returns the exit status. To add one, write the dataclass and list it here.
"""

from app.commands.advise import AdviseBar, AdviseRing
from app.commands.bench import Bench
from app.commands.run_bar import RunBar
from app.commands.run_ring import RunRing
from app.commands.serve import Serve
from app.commands.sweep_bar import SweepBar
from app.commands.sweep_ring import SweepRing
from app.commands.tables import Tables

COMMANDS: dict[tuple[str, ...], type] = {
    ("serve",): Serve,
    ("run", "bar"): RunBar,
    ("run", "ring"): RunRing,
    ("sweep", "bar"): SweepBar,
    ("sweep", "ring"): SweepRing,
    ("tables",): Tables,
    ("advise", "bar"): AdviseBar,
    ("advise", "ring"): AdviseRing,
    ("bench",): Bench,
}
#: What ``mpm-lab`` does when no command is given.
DEFAULT_COMMAND = ("serve",)
