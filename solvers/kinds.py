"""The kinds of arrays that kernels take: numpy arrays of double precision or 32-bit integers, handed over uncopied."""

import taichi as ti

real = ti.f64
reals = ti.types.ndarray(dtype=real, ndim=1)
pairs = ti.types.ndarray(dtype=ti.types.vector(2, real), ndim=1)
triples = ti.types.ndarray(dtype=ti.types.vector(3, real), ndim=1)
quads = ti.types.ndarray(dtype=ti.types.vector(4, real), ndim=1)
octets = ti.types.ndarray(dtype=ti.types.vector(8, real), ndim=1)
table = ti.types.ndarray(dtype=real, ndim=2)
integers = ti.types.ndarray(dtype=ti.i32, ndim=1)
integer_quads = ti.types.ndarray(dtype=ti.types.vector(4, ti.i32), ndim=1)
