"""A state as kernels see it, with every number read once.

A number in an argument pack is read anew wherever it is named, hundreds of times in a kernel, and the compiler then
merges the readings one by one, each with a look through the whole kernel.
"""

from typing import Any

import taichi as ti


class _Members:
    """The members of a state as attributes."""

    def __init__(self, members: dict[str, object]):
        vars(self).update(members)


def untranslated(function: Any) -> Any:
    """The compiler warns of a call that it does not translate unless told so; here nothing is to be."""
    function.__dict__["_is_taichi_function"] = False
    return function


def variable(value: object) -> object:
    """A new variable with this value, in the kernel that is being compiled, where it has come to."""
    return ti.lang.impl.expr_init(value)


def subscript(array: object, index: object) -> object:
    """An entry of an array or a vector, in the kernel that is being compiled."""
    return ti.lang.impl.subscript(None, array, index)


@untranslated
def hoist_scalars(state: Any) -> _Members:
    """For kernels: the state, an argument pack, with its numbers read here."""
    return _Members({name: variable(value) if isinstance(value, ti.lang.expr.Expr) else value
                     for name, value in state.items})
