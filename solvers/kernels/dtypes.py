"""Dtypes of numbers and arrays in kernels: double precision or 32-bit integers, numpy arrays without copies.

Vectors have 2, 4 or 8 numbers: compiled code moves them whole, and expects vectors of 3 at other addresses. Arrays of
them must be aligned (``solvers.solver.state_arrays``). Capitalised names annotate the fields of a dataclass whose
members are passed to kernels: for Python they are numbers and numpy arrays, for Taichi its own types.
"""

from typing import Annotated

import numpy as np
import taichi as ti

real = ti.f64
reals = ti.types.ndarray(dtype=real, ndim=1)
pairs = ti.types.ndarray(dtype=ti.types.vector(2, real), ndim=1)
quads = ti.types.ndarray(dtype=ti.types.vector(4, real), ndim=1)
octets = ti.types.ndarray(dtype=ti.types.vector(8, real), ndim=1)
rows = ti.types.ndarray(dtype=ti.types.vector(8, real), ndim=1)  # octets that a ``ArrayPacking`` leaves as they are
blocks = ti.types.ndarray(dtype=ti.types.vector(32, real), ndim=1)  # eight numbers of four
matrix = ti.types.ndarray(dtype=real, ndim=2)
integers = ti.types.ndarray(dtype=ti.i32, ndim=1)

Integer = Annotated[int, ti.i32]
Real = Annotated[float, real]
Reals = Annotated[np.ndarray, reals]
Pairs = Annotated[np.ndarray, pairs]
Quads = Annotated[np.ndarray, quads]
Octets = Annotated[np.ndarray, octets]
Blocks = Annotated[np.ndarray, blocks]
Matrix = Annotated[np.ndarray, matrix]
Integers = Annotated[np.ndarray, integers]
