"""How many processors there are to work on."""

import os

MOST_PROCESSES = 64  # that a command starts without being told so


def available_cpus() -> int:
    """Those that this process may use, as far as the system tells, else all; 1 at least."""
    affinity = getattr(os, "sched_getaffinity", None)  # not on every system
    return len(affinity(0)) if affinity else os.cpu_count() or 1


def default_processes() -> int:
    """How many processes work side by side unless one says how many: one on each processor."""
    return min(MOST_PROCESSES, available_cpus())
