"""Files of particles as commands take them: some, and for each the time that it may not say itself."""

import os
from collections.abc import Sequence

from app.commands.flags import BadInput, real

MOST_FILES = 10_000


def times_of(words: tuple[str, ...], flag: str) -> list[float]:
    """Times in seconds, as they were typed."""
    times = []
    for word in words:
        time = real([word])
        if isinstance(time, str) or time < 0:
            raise BadInput(flag, word, "is no time; give seconds from 0 on")
        times.append(time)
    return times


def require_files(files: Sequence[str]) -> None:
    """Refuse none, and too many."""
    if not files:
        raise BadInput("", "", "give one or several files of particles")
    if len(files) > MOST_FILES:
        raise BadInput("", f"{len(files)} files", f"are too many; give at most {MOST_FILES:,}, each with many times "
                       "perhaps")


def look_for(files: Sequence[str]) -> None:
    """Refuse a file that is not there, before anything is written."""
    for file in files:
        try:
            os.stat(file)
        except (OSError, ValueError) as error:  # a character that no name can have is the latter
            why = getattr(error, "strerror", None) or str(error)
            raise BadInput("", file, f"cannot be read: {why.lower()}; give a file that exists and may be "
                                     "read") from None


def times_for(files: Sequence[str], words: tuple[str, ...]) -> list[float]:
    """The times of ``--time`` in s, one for each file; none where the files say them."""
    times = times_of(words, "time")
    if times and len(times) != len(files):
        raise BadInput("time", " ".join(words), f"gives {len(times)} times for {len(files)} files; give one for each")
    return times
