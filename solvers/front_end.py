"""Taichi's front end without work whose result nobody reads: half of what a kernel costs that the cache holds.

The front end (Taichi 1.7.4, which ``pyproject.toml`` pins) translates a kernel at its first call in each process, also
where the machine code comes from the cache of compiled kernels. For every node of the syntax tree it draws the line of
source with the node underlined, wrapped to 80 columns, in case of an error. For every call of a function it reads and
tokenizes the function's source again. And for every function decorated it looks through all modules for the source
around it, to see whether it belongs to a class. Here an error names file, line and function, source is read once, and
no function belongs to a class. What is compiled is the same to the bit, and so is its key in the cache.
"""

import functools
from ast import expr, stmt

from taichi.lang import kernel_impl
from taichi.lang.ast.ast_transformer_utils import ASTTransformerContext


def lighten() -> None:
    """Leave that work out from now on: before kernels are decorated, that is imported, and compiled."""
    ASTTransformerContext.get_pos_info = _place
    kernel_impl.getsourcelines = functools.cache(kernel_impl.getsourcelines)
    kernel_impl._inside_class = _in_no_class


def _place(context: ASTTransformerContext, node: expr | stmt) -> str:
    """Where a node stands in the source, as the first line of Taichi's own message says it."""
    line = node.lineno + context.lineno_offset
    return f'File "{context.file}", line {line}, in {context.func.func.__name__}:\n'


def _in_no_class(level_of_class_stackframe: int) -> bool:
    """Whether the function being decorated is a method; Taichi passes its argument by this name."""
    return False
