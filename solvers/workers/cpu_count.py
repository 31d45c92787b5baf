"""Number of available CPUs."""

import os

MOST_PROCESSES = 64  # that a command starts by default


def available_cpus() -> int:
    """Returns the number of CPUs that this process may use, at least 1; that of all CPUs if it is unknown."""
    affinity = getattr(os, "sched_getaffinity", None)  # not on every system
    return len(affinity(0)) if affinity else os.cpu_count() or 1


def default_processes() -> int:
    """Returns the default number of parallel processes of a command: one for each available CPU, at most 64."""
    return min(MOST_PROCESSES, available_cpus())
