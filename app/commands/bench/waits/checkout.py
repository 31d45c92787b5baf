"""A folder that the lab runs from: this code's own, or another version's, run by the same Python and packages."""

import subprocess
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from app.commands.bench.itself import command_of
from app.commands.flags import BadInput
from solvers.workers.processes import HOME

PATIENCE = 900.0  # seconds for any one command
FOLDER = "{folder}"  # in a command line: a folder of its own, which is empty


class NotMeasured(Exception):
    """Something could not be measured in a checkout; the sentence says why."""


@dataclass(frozen=True)
class Checkout:
    """``folder`` holds the packages ``app`` and ``solvers``."""

    folder: Path

    @property
    def command(self) -> tuple[str, ...]:
        """``mpm-lab`` from there."""
        return command_of(self.folder)

    def seconds(self, line: str) -> float:
        """How long a command line of ``mpm-lab`` takes, in s of wall time. Raises :class:`NotMeasured`."""
        return self.run(line, lambda folder: None)[0]

    def run(self, line: str, read: Callable[[Path], object]) -> tuple[float, object]:
        """The same, with what is ``read`` from its empty folder before that goes."""
        with tempfile.TemporaryDirectory(prefix="mpm-lab-waits-", ignore_cleanup_errors=True) as folder:
            words = [word.replace(FOLDER, folder) for word in line.split("|")]
            begun = time.perf_counter()
            try:
                done = subprocess.run([*self.command, *words], cwd=folder, stdin=subprocess.DEVNULL,
                                      capture_output=True, text=True, timeout=PATIENCE)
            except subprocess.TimeoutExpired:
                raise NotMeasured(f"{' '.join(words)} took longer than {PATIENCE:g} s") from None
            seconds = time.perf_counter() - begun
            if done.returncode:
                said = (done.stderr.strip().splitlines() or [f"ended with status {done.returncode}"])[-1]
                raise NotMeasured(f"mpm-lab {words[0]}: {said}")
            return seconds, read(Path(folder))


def here() -> Checkout:
    """This code."""
    return Checkout(HOME)


def beside(text: str) -> Checkout:
    """Another one, as typed after ``--beside``."""
    folder = Path(text)
    if not text.strip() or not all((folder / name / "__init__.py").is_file() for name in ("app", "solvers")):
        raise BadInput("beside", text, "holds no mpm-lab; give a folder with the packages app and solvers of another "
                                       "version of it")
    return Checkout(folder.resolve())
