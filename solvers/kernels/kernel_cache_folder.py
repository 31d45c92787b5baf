"""Cache of compiled kernels: its size, and its folder where the home folder cannot be written to.

Taichi writes them below ``XDG_CACHE_HOME``, by default ``~/.cache``, when it ends; where it cannot, it ends in a
segmentation fault, even with its cache off, and without a ``HOME`` does not start. Matplotlib's font list is there.
"""

import atexit
import logging
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
    usual = os.environ.get(HOME, os.path.join(os.environ.get("HOME") or "~", ".cache"))
    folders = {HOME: os.path.join(usual, "taichi", "ticache"), KERNELS: os.environ.get(KERNELS)}
    bad = [(name, folder) for name, folder in folders.items() if folder is not None and not _is_writable(folder)]
    if os.name == "nt" or not bad:
        return  # Windows has another folder, which is never read-only
    with suppress(OSError):  # no folder is writable: Taichi will report it
        folder = tempfile.mkdtemp(prefix="mpm-lab-")
        atexit.register(_remove_kernels, folder, *bad[0])  # before Taichi is imported: after it has written
        os.environ[HOME] = folder
        os.environ.pop(KERNELS, None)
        os.environ.setdefault(PICTURES, folder)


def _remove_kernels(folder: str, name: str, usual: str) -> None:
    """Removes a temporary ``folder``; if it holds compiled kernels, logs that the ``usual`` one, which the environment
    variable ``name`` sets, was not writable."""
    if os.path.exists(os.path.join(folder, "taichi")):
        logging.getLogger(__name__).warning(
            "Compiled kernels are not kept: their folder (%r) must be an absolute path and writable; %s sets another.",
            usual, name)
    shutil.rmtree(folder, ignore_errors=True)


def _is_writable(folder: str) -> bool:
    """Returns whether a folder, by its absolute path, can be written to, or created. This is tried: /proc, and some
    shares of servers, grant root the right to write and then refuse."""
    try:
        there = next(place for place in (Path(folder), *Path(folder).parents) if place.exists())
        os.rmdir(tempfile.mkdtemp(prefix="mpm-lab-", dir=there))
    except (OSError, ValueError):
        return False
    return os.path.isabs(folder)  # Taichi takes an empty HOME for the root folder
