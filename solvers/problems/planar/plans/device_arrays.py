"""Arrays on a GPU, which take their memory with them when they go.

Taichi 1.7.4 by itself frees no array of vectors that is let go of, and other arrays when Python comes to it, by their
address, at which the next program may have put another by then. So all are freed here, in time.
"""

from typing import Any

import numpy as np
import taichi as ti

from solvers.kernels import runtime


class DeviceArrays:
    """Copies on the GPU of ``arrays`` by name, which have the types of a kernel's argument."""

    def __init__(self, arrays: dict[str, np.ndarray], types: dict[str, Any]):
        self.arrays = arrays
        self.copies: dict[str, ti.Ndarray] = {}
        self.copies = {name: ti.ndarray(types[name].dtype, array.shape[:types[name].ndim])
                       for name, array in arrays.items()}
        runtime.holders.add(self)
        self.upload(*arrays)

    def __del__(self) -> None:
        self.forget()

    def fetch(self, *names: str) -> None:
        """Bring the arrays up to date."""
        for name in names:
            self.arrays[name][...] = self.copies[name].to_numpy()

    def upload(self, *names: str) -> None:
        """Bring the copies up to date."""
        for name in names:
            self.copies[name].from_numpy(self.arrays[name])

    def forget(self) -> None:
        """Free the copies: nobody uses them any more, or Taichi is about to end."""
        if self.copies:
            ti.sync()  # what is queued may use them
            program = ti.lang.impl.get_runtime().prog
            for copy in self.copies.values():
                program.delete_ndarray(copy.arr)
                copy.arr = None
            self.copies = {}
