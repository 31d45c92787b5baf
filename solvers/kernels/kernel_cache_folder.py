"""Cache of compiled kernels: its size, and its folder where the home folder is read-only or missing.

Taichi writes them below ``XDG_CACHE_HOME``, by default ``~/.cache``, when it ends; where it cannot, it ends in a
segmentation fault, even with its cache off, and without a ``HOME`` does not start. Matplotlib's font list is there.
"""

import atexit
import os
import shutil
import tempfile
from contextlib import suppress
from pathlib import Path

CACHE_SIZE = "TI_OFFLINE_CACHE_MAX_SIZE_OF_FILES"
HOME, KERNELS, PICTURES = "XDG_CACHE_HOME", "TI_OFFLINE_CACHE_FILE_PATH", "MPLCONFIGDIR"


def raise_cache_size() -> None:
    """Limits Taichi's cache on disk to 500 MB of kernels, unless the environment sets its size. A kernel takes 1 MB,
    and with Taichi's own 100 MB a page, a sweep and a class displace each other's kernels."""
    os.environ.setdefault(CACHE_SIZE, str(500 * 2**20))


def ensure_writable_cache_folder() -> None:
    """Sets the cache folder of this process and its children to a temporary one, which is removed at the end, if the
    usual one is not writable; otherwise does nothing. Call before Taichi is imported."""
    below_home = os.path.join(os.environ["HOME"], ".cache") if "HOME" in os.environ else ""
    if os.name == "nt" or (_is_writable(os.environ.get(HOME, below_home)) and _is_writable(os.environ.get(KERNELS))):
        return  # Windows has another folder, which is never read-only
    with suppress(OSError):  # no folder is writable: Taichi will report it
        folder = tempfile.mkdtemp(prefix="mpm-lab-")
        atexit.register(shutil.rmtree, folder, ignore_errors=True)  # before Taichi is imported: after it has written
        os.environ[HOME] = folder
        os.environ.pop(KERNELS, None)
        os.environ.setdefault(PICTURES, folder)


def _is_writable(folder: str | None) -> bool:
    """Returns whether a folder, by its path, can be written to, or created; True for None, which means no setting."""
    if folder is None:
        return True
    there = next((place for place in (Path(folder), *Path(folder).parents) if place.exists()), Path())
    return bool(folder) and there.is_dir() and os.access(there, os.W_OK | os.X_OK)
