"""Measurements in a fresh Python process that does nothing else and answers with one line of JSON."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]  # where the packages lie, so that -m finds them
PATIENCE = 120.0  # seconds


class Failed(Exception):
    """The process did not answer; the message is one line."""


def ask(module: str, environment: Mapping[str, str] | None = None) -> dict:
    """Run ``python -m module`` and return what it printed last, as an object."""
    done = _run([sys.executable, "-m", module], environment)
    lines = done.stdout.splitlines()
    if done.returncode or not lines:
        said = (done.stderr.splitlines() or [f"it ended with status {done.returncode}"])[-1]
        raise Failed(" ".join(said.split()))
    return json.loads(lines[-1])


def seconds(command: Sequence[str]) -> float:
    """Wall time from the start of a process to its end."""
    begun = time.perf_counter()
    done = _run(command)
    if done.returncode:
        raise Failed(f"ended with status {done.returncode}")
    return time.perf_counter() - begun


def _run(command: Sequence[str], environment: Mapping[str, str] | None = None) -> subprocess.CompletedProcess[str]:
    try:
        return subprocess.run(command, cwd=ROOT, env={**os.environ, **(environment or {})}, capture_output=True,
                              text=True, stdin=subprocess.DEVNULL, timeout=PATIENCE)
    except (OSError, subprocess.TimeoutExpired) as error:
        raise Failed(" ".join(str(error).split())) from None
