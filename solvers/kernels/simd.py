"""SIMD: several particles at a time, as a vector with one number of each, in one register of a CPU.

The compiler does not vectorise by itself: after every store it reloads the address of each array, which might have
changed, and so it finds no loop to vectorise.
"""

import taichi as ti

LANES = 4  # numbers in a register of most processors; no bar has fewer particles


@ti.func
def load(numbers: ti.template(), p):
    """Returns, as a vector, the ``LANES`` entries of an array of numbers from index ``p`` on."""
    return ti.Vector([numbers[p + k] for k in ti.static(range(LANES))])


@ti.func
def load_component(vectors: ti.template(), some: ti.template(), c: ti.template()):
    """Returns, as a vector, component ``c`` of the entries of an array of vectors at the indices ``some``."""
    return ti.Vector([vectors[some[k]][c] for k in ti.static(range(some.n))])
