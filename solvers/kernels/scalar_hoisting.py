"""Scalar hoisting: a state for kernels whose numbers are all read once.

A number in an argument pack is read again at every use, hundreds of times in a kernel, and the compiler then merges
these reads one by one, each with a pass over the whole kernel.
"""

from typing import Any

import taichi as ti


class _HoistedMembers:
    """Namespace of a state's members, by name, as attributes."""

    def __init__(self, members: dict[str, object]):
        vars(self).update(members)


def mark_untranslated_by_taichi(function: Any) -> Any:
    """Marks a function, which is returned, as one that runs while a kernel is compiled instead of being translated."""
    function.__dict__["_is_taichi_function"] = False
    return function


def make_kernel_variable(value: object) -> object:
    """Returns a new variable, set to a number or expression at the present place in the kernel being compiled."""
    return ti.lang.impl.expr_init(value)


def subscript_expression(array: object, index: object) -> object:
    """Returns the expression of an entry of an array or a vector, in the kernel being compiled."""
    return ti.lang.impl.subscript(None, array, index)


@mark_untranslated_by_taichi
def hoist_scalars(state: Any) -> _HoistedMembers:
    """Returns, in a kernel, the members of its ``state``, an argument pack, as attributes, with numbers read here."""
    return _HoistedMembers({name: make_kernel_variable(value) if isinstance(value, ti.lang.expr.Expr) else value
                            for name, value in state.items})
