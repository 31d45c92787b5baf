"""Stored weights of a step's particles for both mappings: eight numbers each, interleaved for four particles.

They are computed for four particles at a time, and stored in that order. A block is one entry of the array: within an
entry the compiler knows all addresses, but would compute one for each separate entry.
"""

from typing import Any

import numpy as np
import taichi as ti

from solvers.kernels.scalar_hoisting import make_kernel_variable, mark_untranslated_by_taichi, subscript_expression

BLOCK, NUMBERS = 4, 8  # particles of a block, and numbers of each
PARTS_PER_PARTICLE = {"cpdi": 2}  # how many times eight numbers there are of a particle, by method
SHIFT = BLOCK.bit_length() - 1  # BLOCK = 2^SHIFT


def weight_octets_per_particle(method: str) -> int:
    """Returns the number of parts, of eight weights each, that are stored per particle with a ``method``: 1 or 2."""
    return PARTS_PER_PARTICLE.get(method, 1)


def allocate_weights(method: str, particles: int) -> np.ndarray:
    """Returns zeros for the weights of so many particles: (blocks times parts, eight numbers of four particles)."""
    return np.zeros((-(-particles // BLOCK) * weight_octets_per_particle(method), NUMBERS * BLOCK))


def weights_by_particle(kept: np.ndarray, method: str, particles: int) -> np.ndarray:
    """Returns the array of :func:`allocate_weights`, ``kept``, with one row per particle (P, 8 parts)."""
    numbers = NUMBERS * weight_octets_per_particle(method)
    return kept.reshape(-1, numbers, BLOCK).transpose(0, 2, 1).reshape(-1, numbers)[:particles]


@mark_untranslated_by_taichi
def concatenate(numbers: Any) -> Any:
    """Returns vectors of ``BLOCK`` entries as one. Each becomes a variable first, or every entry would recompute it."""
    variables = [make_kernel_variable(number) for number in numbers]
    return ti.Vector([subscript_expression(number, lane) for number in variables for lane in range(BLOCK)])


@ti.func
def store_weight_part(body: ti.template(), p, part: ti.template(), numbers: ti.template(), on: ti.template()):
    """Stores ``numbers``, eight vectors, as part number ``part`` of particle p (vectors of one entry) or of a whole
    block from p on (of four)."""
    entry = (p >> SHIFT) * ti.static(weight_octets_per_particle(on.method)) + part
    if ti.static(numbers[0].n == BLOCK):
        body.weights[entry] = concatenate(numbers)
    else:
        for k in ti.static(range(NUMBERS)):
            body.weights[entry][k * BLOCK + (p & (BLOCK - 1))] = numbers[k][0]


class _ParticleWeightAccessor:
    """Stored weights of one particle by index, while a kernel is compiled; ``array`` has those of all."""

    def __init__(self, array: Any, entry: Any, lane: Any):
        self._array, self._entry, self._lane = array, entry, lane

    def __getitem__(self, k: int) -> Any:
        entry = self._entry + k // NUMBERS if k // NUMBERS else self._entry
        return subscript_expression(subscript_expression(self._array, entry), self._lane + k % NUMBERS * BLOCK)


@mark_untranslated_by_taichi
def stored_weight_entries(body: Any, p: Any, on: Any) -> _ParticleWeightAccessor:
    """Returns the stored weights of particle p, for kernels with constant indices; computes their address once."""
    return _ParticleWeightAccessor(body.weights,
                                   make_kernel_variable((p >> SHIFT) * weight_octets_per_particle(on.method)),
                                   make_kernel_variable(p & (BLOCK - 1)))


@ti.func
def stored_weight_entry(body: ti.template(), p, k, on: ti.template()):
    """Returns number ``k``, which may be a variable, of the stored weights of particle p."""
    entry = (p >> SHIFT) * ti.static(weight_octets_per_particle(on.method)) + k // NUMBERS
    return body.weights[entry][k % NUMBERS * BLOCK + (p & (BLOCK - 1))]
