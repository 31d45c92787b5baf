"""Taichi's front end without unused results, which are half the cost of a cached kernel.

The front end (Taichi 1.7.4, pinned in ``pyproject.toml``) translates a kernel at its first call in each process, even
if the machine code comes from the cache of compiled kernels. For every node of the syntax tree it formats the source
line with the node underlined, wrapped to 80 columns, in case of an error. For every call of a function it reads and
tokenizes the function's source again. And for every decorated function it searches all modules for the source around
it, to see whether it belongs to a class. Here an error message has file, line and function, source is read once, and
no function belongs to a class. The compiled code is the same to the bit.

The front end also emits a constant again at every use, a thousand times in a kernel. The compiler then merges equal
ones one by one, each with two passes over the whole kernel: that is most of its time. Here the most frequent constants
are variables that a kernel sets first; the compiler replaces these by their values in one pass, with the same result.

An argument pack is made with every solver, and twice. For each of its members Taichi counts anew which of those before
it are arrays, a step for every pair of members: nearly half of what a run costs before its first step.
"""

import functools
from ast import expr as syntax
from ast import mod, stmt
from itertools import accumulate

from taichi.lang import argpack, expr, impl, kernel_impl
from taichi.lang.ast import transform_tree
from taichi.lang.ast.ast_transformer_utils import ASTTransformerContext

COMMON_NUMBERS = (*range(-1, 9), 0.0, 1.0, -1.0, 0.5, 0.25, 2.0, True)  # numbers
#: Members that a pack keeps apart from its numbers, and its attribute for what was counted.
UNPACKED_TYPES = (argpack.sparse_matrix_builder, argpack.ndarray_type.NdarrayType, argpack.texture_type.TextureType,
                  argpack.texture_type.RWTextureType)
PLACES_ATTRIBUTE = "_places_of_members"

_constants: dict[tuple[type, object], expr.Expr] = {}  # the variables of the kernel that is being compiled
_make_constant = expr.make_constant_expr
_subscript = impl.subscript


def speed_up_front_end() -> None:
    """Makes Taichi's front end faster in this process: call before modules with kernels are imported."""
    ASTTransformerContext.get_pos_info = _source_location
    kernel_impl.getsourcelines = functools.cache(kernel_impl.getsourcelines)
    kernel_impl._inside_class = lambda level_of_class_stackframe: False  # Taichi passes it by this name
    kernel_impl.transform_tree = _translate_with_common_numbers
    expr.make_constant_expr = _common_number_expression
    impl.subscript = _subscript_expression
    argpack.ArgPack._calc_element_true_index = _member_index_in_pack


def _source_location(context: ASTTransformerContext, node: syntax | stmt) -> str:
    """Returns file, line and function of a node of the syntax tree, as in the first line of Taichi's own message."""
    line = node.lineno + context.lineno_offset
    return f'File "{context.file}", line {line}, in {context.func.func.__name__}:\n'


def _translate_with_common_numbers(tree: mod, context: ASTTransformerContext) -> object:
    """Returns Taichi's translation of a syntax tree; for a kernel, with variables for common numbers in front."""
    if not context.is_kernel:
        return transform_tree(tree, context)
    source = impl.get_runtime().src_info_stack
    source.append("")  # of what has none
    try:
        variables = {_number_key(number): impl.expr_init(number) for number in COMMON_NUMBERS}
    finally:
        source.pop()
    _constants.update(variables)
    try:
        return transform_tree(tree, context)
    finally:
        _constants.clear()


def _common_number_expression(value: object, kind: object) -> expr.Expr:
    """Returns an expression for a number: the kernel's variable of this value, if there is one and no type is given."""
    known = _constants.get(_number_key(value)) if _constants and kind is None else None
    return _make_constant(value, kind) if known is None else known


def _number_key(value: object) -> tuple[type, object]:
    """Returns a key that distinguishes numbers, including 1 from 1.0, and 0.0 from -0.0."""
    return type(value), repr(value)


def _subscript_expression(builder: object, value: object, *places: object, **how: object) -> expr.Expr:
    """Returns the expression of an entry, at ``places``, of an array or a vector, as Taichi makes it but with indices
    as plain numbers: those of a vector must be known at compile time."""
    if not isinstance(value, expr.Expr):
        return _subscript(builder, value, *places, **how)
    aside = dict(_constants)
    _constants.clear()
    try:
        return _subscript(builder, value, *places, **how)
    finally:
        _constants.update(aside)


def _member_index_in_pack(pack: argpack.ArgPack, member: int) -> int:
    """Returns the place of an argument pack's member, by its number, among those that are not arrays; the places are
    counted once for all members, and stored in the pack."""
    if not hasattr(pack, PLACES_ATTRIBUTE):
        apart = [isinstance(kind, UNPACKED_TYPES) for kind in pack._annotations]
        setattr(pack, PLACES_ATTRIBUTE, [k - before for k, before in enumerate(accumulate(apart, initial=0))])
    return getattr(pack, PLACES_ATTRIBUTE)[member]
