"""A fingerprint of the solvers' source: what was measured by other source is not the same measurement."""

import functools
import hashlib
from pathlib import Path


@functools.cache
def fingerprint() -> str:
    """Of the source of everything that is computed: a changed solver makes what is kept of it out of date."""
    root = Path(__file__).parents[1]
    digest = hashlib.sha256()
    for path in sorted(root.rglob("*.py")):
        digest.update(path.relative_to(root).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()
