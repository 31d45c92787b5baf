"""What a step keeps of its particles' weights for both mappings: eight numbers each, of four particles side by side.

So they are found for four particles at a time, and written as they are found. A block is one entry of the array:
within an entry the compiler knows what lies where, while it would work out a place of its own for every entry.
"""

from typing import Any

import numpy as np
import taichi as ti

from solvers.kernels.scalar_hoisting import subscript, untranslated, variable

BLOCK, NUMBERS = 4, 8  # particles of a block, and numbers of each
PARTS_PER_PARTICLE = {"cpdi": 2}  # how many times eight numbers there are of a particle, by method
SHIFT = BLOCK.bit_length() - 1  # BLOCK = 2^SHIFT


def parts_per_particle(method: str) -> int:
    """How many times eight numbers are kept of a particle."""
    return PARTS_PER_PARTICLE.get(method, 1)


def allocate_weights(method: str, particles: int) -> np.ndarray:
    """An array for what is kept of so many particles: blocks times parts, each of eight numbers of four particles."""
    return np.zeros((-(-particles // BLOCK) * parts_per_particle(method), NUMBERS * BLOCK))


def weights_by_particle(kept: np.ndarray, method: str, particles: int) -> np.ndarray:
    """What is kept, a particle a row (P, 8 parts)."""
    numbers = NUMBERS * parts_per_particle(method)
    return kept.reshape(-1, numbers, BLOCK).transpose(0, 2, 1).reshape(-1, numbers)[:particles]


@untranslated
def concatenate(numbers: Any) -> Any:
    """One vector of several. Each is a variable first: as it stands, it would be worked out again for every entry."""
    variables = [variable(number) for number in numbers]
    return ti.Vector([subscript(number, lane) for number in variables for lane in range(BLOCK)])


@ti.func
def store_part(body: ti.template(), p, part: ti.template(), numbers: ti.template(), on: ti.template()):
    """Keep a part, ``numbers``, of particle p, or of a whole block from p on: each is a vector of one entry or of
    four."""
    entry = (p >> SHIFT) * ti.static(parts_per_particle(on.method)) + part
    if ti.static(numbers[0].n == BLOCK):
        body.weights[entry] = concatenate(numbers)
    else:
        for k in ti.static(range(NUMBERS)):
            body.weights[entry][k * BLOCK + (p & (BLOCK - 1))] = numbers[k][0]


class _Stored:
    """What is kept of a particle, by number; while a kernel is compiled."""

    def __init__(self, array: Any, entry: Any, lane: Any):
        self._array, self._entry, self._lane = array, entry, lane

    def __getitem__(self, k: int) -> Any:
        entry = self._entry + k // NUMBERS if k // NUMBERS else self._entry
        return subscript(subscript(self._array, entry), self._lane + k % NUMBERS * BLOCK)


@untranslated
def stored_numbers(body: Any, p: Any, on: Any) -> _Stored:
    """For kernels: what is kept of particle p, by numbers that are known in advance; where it lies is found here."""
    return _Stored(body.weights, variable((p >> SHIFT) * parts_per_particle(on.method)), variable(p & (BLOCK - 1)))


@ti.func
def stored_number(body: ti.template(), p, k, on: ti.template()):
    """Number ``k``, which need not be known in advance."""
    entry = (p >> SHIFT) * ti.static(parts_per_particle(on.method)) + k // NUMBERS
    return body.weights[entry][k % NUMBERS * BLOCK + (p & (BLOCK - 1))]
