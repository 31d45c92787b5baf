"""A directory that a command fills: new or empty, so that nothing of anybody's is overwritten."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from app.commands.flags import BadInput
from app.commands.output import Target, say


class Folder:
    """The directory after ``--out``, made and tried now."""

    def __init__(self, text: str | None):
        self.text = (text or "").strip()
        if not self.text:
            raise BadInput("out", "", "give a directory for the files")
        self.path = Path(self.text)
        try:
            self.path.mkdir(parents=True, exist_ok=True)
            names = [entry.name for entry in self.path.iterdir()]
        except (OSError, ValueError) as error:
            why = (getattr(error, "strerror", None) or str(error)).lower()
            raise BadInput("out", self.text, f"cannot be a directory: {why}; give one that exists or can be made and "
                                             "may be written to") from None
        if names:
            raise BadInput("out", self.text, "is not empty; give an empty or a new directory")
        Target("out", str(self.path / "try"))  # says now what would fail later

    def put(self, name: str, content: bytes) -> None:
        """Write a file into the directory, whole or not at all."""
        Target("out", str(self.path / name)).write(content)


def draw(figures: Mapping[str, Callable[[Any], Any]], values: Any, put: Callable[[str, bytes], None], out: str,
         rest: str) -> tuple[list[str], int]:
    """Draw ``values`` in every way and put the pictures into ``out``, but where a figure is None; one that fails costs
    nothing else, ``rest``. The files' names, and the exit status."""
    from app.pictures.run import png_bytes

    drawn, status = [], 0
    for name, figure in figures.items():
        try:
            if (picture := figure(values)) is not None:
                put(f"{name}.png", png_bytes(picture))
                drawn.append(f"{name}.png")
        except Exception as error:
            say(f"--out {out}: the picture {name} failed ({type(error).__name__}: {error}); {rest}")
            status = 1
    return drawn, status
