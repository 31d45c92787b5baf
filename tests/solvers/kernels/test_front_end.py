"""Taichi's front end, lightened: an error still says where, and every kernel is one that it suits."""

import ast
from pathlib import Path

import pytest
import taichi as ti

import solvers
from solvers.kernels import runtime

SOURCES = sorted(Path(solvers.__file__).parent.rglob("*.py"))


@ti.func
def without_a_name(x):
    return x + no_such_name  # noqa: F821


@ti.kernel
def wrong(x: float) -> float:
    return without_a_name(x)


def test_an_error_says_where_it_is():
    """File, line and function, of the function called and of the one that calls it."""
    runtime.start()
    with pytest.raises(ti.TaichiCompilationError) as caught:
        wrong(1.0)
    for function, name in ((without_a_name.func, "without_a_name"), (wrong._primal, "wrong")):
        line = function.func.__code__.co_firstlineno + 2
        assert f'File "{__file__}", line {line}, in {name}:' in str(caught.value)
    assert "no_such_name" in str(caught.value)


def test_no_kernel_is_a_method():
    """Taichi is told so: it would take ``self`` for an argument."""
    decorated = [f"{path}: {function.name}" for path in SOURCES
                 for kind in ast.walk(ast.parse(path.read_text(encoding="utf-8"))) if isinstance(kind, ast.ClassDef)
                 for function in kind.body if isinstance(function, ast.FunctionDef)
                 for decorator in function.decorator_list if ast.unparse(decorator).startswith("ti.")]
    assert decorated == []
