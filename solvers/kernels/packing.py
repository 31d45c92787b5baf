"""Many numbers and arrays in few: one array for each type, because a kernel takes 64 arguments and no more.

Every member of a state's argument pack counts, and an estimator with a second run has a state's worth of them. So all
that estimators keep is in a :class:`ArrayPacking`: the arrays of one type lie one behind the other in a single one, and
the numbers and the places where arrays begin stand in front. In kernels :class:`PackedAttributesView` gives the state
with the packed members as attributes, for reading and for writing to arrays, and ``prefix_view`` gives those of one
prefix by the rest of their names, so that functions written for a state (``bar.position[p]``) work on a second one.
"""

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import taichi as ti

from solvers.kernels import dtypes
from solvers.kernels.scalar_hoisting import make_kernel_variable, mark_untranslated_by_taichi, subscript_expression

PREFIX = "memory_"  # of the arrays that hold the others, unless a packing has one of its own
#: Types of arrays that can be packed, by name, with the shape of an entry.
SHAPES = {"integers": (), "reals": (), "pairs": (2,), "quads": (4,), "octets": (8,)}


class ArrayPacking:
    """Packing of ``members``, numbers and arrays by name with their Taichi types, into one array for each type.

    ``types`` has the names (with the ``prefix``) and types of the packed arrays, and of the members whose types cannot
    be packed, which stay as they are; :meth:`pack` returns their values, :meth:`unpack` the members in them."""

    def __init__(self, members: Mapping[str, object], prefix: str = PREFIX):
        self.types: dict[str, object] = {}
        self.prefix = prefix
        self.places: dict[str, tuple[str, int, bool]] = {}  # array, entry in front, whether it is an array
        self.front = {"integers": 0, "reals": 0}
        for name, kind in members.items():
            array = next((a for a in SHAPES if getattr(dtypes, a) is kind), None)
            if array is None and kind not in (dtypes.real, ti.i32):
                self.types[name] = kind
                continue
            # An integer, or an array, whose beginning is one; or a real number.
            held = "reals" if kind is dtypes.real else "integers"
            self.places[name] = (array or held, self.front[held], array is not None)
            self.front[held] += 1
        used = {"integers", "reals"} | {place[0] for place in self.places.values()}
        self.types.update({prefix + array: getattr(dtypes, array) for array in SHAPES if array in used})

    def pack(self, members: Mapping[str, Any]) -> dict[str, np.ndarray]:
        """Returns the packed arrays, new ones by the names in ``types``, that contain these values of the members."""
        pieces: dict[str, list[np.ndarray]] = {
            array: [np.zeros((self.front.get(array, 0), *shape), _dtype(array))] for array, shape in SHAPES.items()}
        length = {array: len(piece[0]) for array, piece in pieces.items()}
        for name, (array, slot, is_array) in self.places.items():
            front = pieces["reals" if array == "reals" and not is_array else "integers"][0]
            front[slot] = length[array] if is_array else members[name]
            if is_array:
                pieces[array].append(np.asarray(members[name], _dtype(array)).reshape(-1, *SHAPES[array]))
                length[array] += len(pieces[array][-1])
        packed = {self.prefix + array: np.concatenate(piece) for array, piece in pieces.items()}
        return {name: packed[name] if name in packed else members[name] for name in self.types}

    def unpack(self, packed: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
        """Returns the arrays among the members, by name, as views of the packed arrays; not the numbers."""
        members = {name: packed[name] for name in self.types if not name.startswith(self.prefix)}
        for array in SHAPES:
            begins = sorted((int(packed[self.prefix + "integers"][slot]), name)
                            for name, (held, slot, is_array) in self.places.items() if is_array and held == array)
            for k, (begin, name) in enumerate(begins):
                members[name] = packed[self.prefix + array][begin:begins[k + 1][0] if k + 1 < len(begins) else None]
        return members


class PackedAttributesView:
    """View of a kernel's ``state`` with the packed members of these ``names`` as more of its attributes.

    Numbers, and the places where arrays begin, are read once, where the view is made: read at every use, they were a
    third of what the compiler had to work through."""

    def __init__(self, state: object, packing: ArrayPacking, names: Iterable[str]):
        self._state, self._members = state, {}
        for name in names:
            if name in packing.places:
                array, slot, is_array = packing.places[name]
                own = getattr(state, packing.prefix + array)
                front = getattr(state, packing.prefix + "integers") if is_array else own
                number = make_kernel_variable(subscript_expression(front, slot))
                self._members[name] = _ArraySlice(own, number) if is_array else number

    def __getattr__(self, name: str) -> object:
        return self._members[name] if name in self._members else getattr(self._state, name)


class _PrefixView:
    """View of a state's attributes whose names begin with a prefix, by the rest of their names."""

    def __init__(self, state: object, prefix: str):
        self._state, self._prefix = state, prefix

    def __getattr__(self, name: str) -> object:
        return getattr(self._state, self._prefix + name)


class _ArraySlice:
    """Part of a packed array in a kernel, whose index counts from the entry ``begin``."""

    def __init__(self, array: object, begin: Any):
        self._array, self._begin = array, begin

    def __getitem__(self, index: object) -> object:
        return subscript_expression(self._array, self._begin + index)


@mark_untranslated_by_taichi
def prefix_view(state: object, prefix: str) -> _PrefixView:
    """Returns for kernels a view of members whose names begin with ``prefix``, as attributes by the rest of these."""
    return _PrefixView(state, prefix)


def _dtype(array: str) -> type:
    return np.int32 if array == "integers" else np.float64
