"""Many numbers and arrays in few: one array for each type, because a kernel takes 64 arguments and no more.

Every member of a state's argument pack counts. An estimator with a second run has a state's worth of members, so it
keeps them in a :class:`Pool`: the arrays of one type lie one behind the other in a single one, and the numbers and the
places where arrays begin stand in front. In kernels ``look(POOL, state, prefix)`` is an object whose attributes are the
pooled members, for reading and for writing, so that functions written for a state (``bar.position[p]``) work on it.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import taichi as ti

from solvers import kinds

#: Types of arrays that can be pooled, by name, with the shape of an entry.
ARRAYS = {"integers": (), "integer_quads": (4,), "reals": (), "pairs": (2,), "quads": (4,), "octets": (8,)}


class Pool:
    """Members by name and type, kept in the state's members ``prefix`` + type.

    ``types`` are the state's members, ``values`` fills them, ``parts`` finds the members in them again.
    """

    def __init__(self, prefix: str, members: Mapping[str, object]):
        self.prefix, self.types, self.places = prefix, {}, {}
        count = {"integers": 0, "reals": 0}
        for name, kind in members.items():
            if kind is kinds.real:
                self.places[name] = ("reals", count["reals"], False)
                count["reals"] += 1
            else:  # an integer, or an array, whose beginning is one
                array = next((a for a in ARRAYS if getattr(kinds, a) is kind), "integers")
                self.places[name] = (array, count["integers"], kind is not ti.i32)
                count["integers"] += 1
        self.front = count
        for array in ARRAYS:
            if array in count or any(array == place[0] for place in self.places.values()):
                self.types[prefix + array] = getattr(kinds, array)

    def values(self, members: Mapping[str, object]) -> dict[str, np.ndarray]:
        """The pooled arrays that hold these members."""
        if members.keys() != self.places.keys():
            raise TypeError(f"pool {self.prefix} lacks or does not know {sorted(members.keys() ^ self.places.keys())}")
        pieces = {array: [np.zeros((self.front.get(array, 0), *shape), _dtype(array))]
                  for array, shape in ARRAYS.items()}
        length = {array: len(piece[0]) for array, piece in pieces.items()}
        for name, (array, slot, is_array) in self.places.items():
            front = pieces["reals" if array == "reals" and not is_array else "integers"][0]
            front[slot] = length[array] if is_array else members[name]
            if is_array:
                pieces[array].append(np.asarray(members[name], _dtype(array)).reshape(-1, *ARRAYS[array]))
                length[array] += len(pieces[array][-1])
        return {self.prefix + array: np.concatenate(piece) for array, piece in pieces.items()
                if self.prefix + array in self.types}

    def parts(self, memory: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
        """The arrays among the members, as they are now."""
        integers = memory[self.prefix + "integers"]
        begins = sorted((array, int(integers[slot]), name) for name, (array, slot, is_array) in self.places.items()
                        if is_array)
        found = {}
        for k, (array, begin, name) in enumerate(begins):
            following = begins[k + 1][:2] if k + 1 < len(begins) else ("", 0)
            found[name] = memory[self.prefix + array][begin:following[1] if following[0] == array else None]
        return found


class _Look:
    """A pool's members as attributes, while a kernel is compiled."""

    def __init__(self, pool: Pool, state: object, prefix: str):
        self._pool, self._state, self._prefix = pool, state, prefix

    def __getattr__(self, name: str) -> object:
        array, slot, is_array = self._pool.places[self._prefix + name]
        integers, own = (getattr(self._state, self._pool.prefix + a) for a in ("integers", array))
        return _Part(own, _entry(integers, slot)) if is_array else _entry(own, slot)


class _Part:
    """An array within a pooled one: its index counts from where it begins."""

    def __init__(self, array: object, begin: object):
        self._array, self._begin = array, begin

    def __getitem__(self, index: object) -> object:
        return _entry(self._array, self._begin + index)


def _entry(array: object, index: object) -> object:
    return ti.lang.impl.subscript(None, array, index)


def look(pool: Pool, state: object, prefix: str = "") -> _Look:
    """For kernels: the members of the pool whose names begin with ``prefix``, by the rest of their names."""
    return _Look(pool, state, prefix)


#: The compiler warns of a call that it does not translate unless the function has this; here nothing is to be.
look._is_taichi_function = False


def _dtype(array: str) -> type:
    return np.int32 if array.startswith("integer") else np.float64
