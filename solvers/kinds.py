"""The kinds of arrays that kernels take: numpy arrays of double precision or 32-bit integers, handed over uncopied.

Vectors have 2, 4 or 8 numbers: compiled code moves them whole, and one of 3 would not lie where it looks for it. Arrays
of them must be aligned (``solvers.memory``).
"""

import taichi as ti

real = ti.f64
reals = ti.types.ndarray(dtype=real, ndim=1)
pairs = ti.types.ndarray(dtype=ti.types.vector(2, real), ndim=1)
quads = ti.types.ndarray(dtype=ti.types.vector(4, real), ndim=1)
octets = ti.types.ndarray(dtype=ti.types.vector(8, real), ndim=1)
table = ti.types.ndarray(dtype=real, ndim=2)
integers = ti.types.ndarray(dtype=ti.i32, ndim=1)
integer_quads = ti.types.ndarray(dtype=ti.types.vector(4, ti.i32), ndim=1)
