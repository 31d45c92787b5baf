"""Reader of HDF5 files, which need the package h5py: their datasets by name, and the columns of their tables."""

from typing import Any

import numpy as np

from solvers.untrusted.quoting import FileError, quote
from solvers.untrusted.size_limits import SizeLimits


def read_hdf5(path: str, limits: SizeLimits) -> dict[str, np.ndarray]:
    """Returns the numbers in a file: datasets by the last part of their names, and the columns of tables by theirs; and
    the numbers among the attributes of the file, such as its time."""
    try:
        import h5py
    except ImportError:
        raise FileError(path, "is an HDF5 file, which only the package h5py reads, and it is not installed; install "
                              "it, or give .npz, .csv or .vtu") from None
    found: dict[str, np.ndarray] = {}

    def add(name: str, values: Any) -> None:
        limits.check_numbers(path, *values.shape)
        for column in values.dtype.names or (None,):
            key = column or name.rpartition("/")[2]
            if key in found:
                raise FileError(path, "has two arrays called {name}; give each its own name", quote(key))
            kind = values.dtype if column is None else values.dtype[column].base
            found[key] = np.asarray(values[column] if column else values[()]) if kind.kind in "iuf" else np.empty(0)
            limits.check_columns(path, len(found))

    try:
        with h5py.File(path, "r") as file:
            stated = {name: np.asarray(value) for name, value in file.attrs.items()}
            found |= {name: value for name, value in stated.items() if value.dtype.kind in "iuf"}
            file.visititems(lambda name, one: add(name, one) if isinstance(one, h5py.Dataset) else None)
    except FileError:
        raise
    except Exception as error:  # what a broken file makes of the library
        raise FileError(path, "cannot be read as HDF5 ({name}); write it again", type(error).__name__) from None
    return found
