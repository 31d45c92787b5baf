"""A directory that a command fills: new or empty, so that nothing of anybody's is overwritten."""

from pathlib import Path

from app.commands.flags import BadInput
from app.commands.output import Target


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
