"""Formulas typed by users: arithmetic, five functions and a few names, parsed without evaluating any Python.

A formula becomes a function of any kind of number, of arrays or of jets (``solvers.motion.jets``), so that all its
derivatives follow. Invalid formulas are rejected with one sentence.
"""

import ast
import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from solvers.motion import jets
from solvers.translatable_message import Message

MOST_CHARACTERS, MOST_NODES, MOST_POWER = 400, 200, 12
FUNCTIONS: Mapping[str, Callable[[Any], Any]] = {
    "sin": jets.sin, "cos": jets.cos, "exp": jets.exp, "log": jets.log, "sqrt": jets.sqrt}
OPERATORS: Mapping[type, Callable[[Any, Any], Any]] = {
    ast.Add: lambda a, b: a + b, ast.Sub: lambda a, b: a - b, ast.Mult: lambda a, b: a * b, ast.Div: lambda a, b: a / b}
Formula = Callable[[Mapping[str, Any]], Any]  # of the values of its names


class FormulaError(ValueError):
    """Error for an invalid formula: a template and its ``values``, the end of a sentence that begins with its text."""

    def __init__(self, sentence: str, /, *values: object):
        super().__init__(Message(sentence, *values))


def parse_formula(text: str, names: Sequence[str]) -> tuple[str, Formula]:
    """Returns a formula's text without spaces, as in links, and its function from a mapping of ``names``, which with
    ``pi`` are all it may contain, to numbers, arrays or jets. Raises FormulaError."""
    if len(text) > MOST_CHARACTERS:
        raise FormulaError("has {text:,} characters; at most {most} are allowed", len(text), MOST_CHARACTERS)
    try:
        tree = ast.parse(text.strip(), mode="eval")
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise FormulaError("is no formula; give one such as 0.02*sin(2*pi*X)*sin(w*t)") from None
    if sum(1 for _ in ast.walk(tree)) > 3 * MOST_NODES:
        raise FormulaError("has too many parts; at most {most} are allowed", MOST_NODES)
    return "".join(ast.unparse(tree).split()), _compile(tree.body, frozenset(names))


def _compile(node: ast.AST, names: frozenset[str]) -> Formula:
    """Returns part of a syntax tree as a function of a mapping of ``names`` to values; raises FormulaError."""
    if isinstance(node, ast.Constant):
        return _constant(node.value)
    if isinstance(node, ast.Name):
        return _name(node.id, names)
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.UAdd, ast.USub)):
        inner, sign = _compile(node.operand, names), -1.0 if isinstance(node.op, ast.USub) else 1.0
        return lambda values: sign * inner(values)
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Pow):
        base, power = _compile(node.left, names), _power(node.right)
        return lambda values: base(values) ** power
    if isinstance(node, ast.BinOp) and type(node.op) in OPERATORS:
        operate, left, right = OPERATORS[type(node.op)], _compile(node.left, names), _compile(node.right, names)
        return lambda values: operate(left(values), right(values))
    if isinstance(node, ast.Call):
        return _call(node, names)
    raise FormulaError("has more than numbers, names, + - * / ** and functions; give a formula such as "
                       "0.02*sin(2*pi*X)*sin(w*t)")


def _constant(value: object) -> Formula:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise FormulaError("has something that is no real number")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise FormulaError("has a number that is too large")
    return lambda values: number


def _name(name: str, names: frozenset[str]) -> Formula:
    if name == "pi":
        return lambda values: math.pi
    if name not in names:
        raise FormulaError("has the name {name}, which is not known; give {names} or pi, and the functions {functions}",
                           name, ", ".join(sorted(names)), ", ".join(FUNCTIONS))
    return lambda values: values[name]


def _power(node: ast.AST) -> int:
    """Returns a power, written out as a whole number: others of negative numbers are not real. Raises FormulaError."""
    negative = isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub)
    value = getattr(node.operand if isinstance(node, ast.UnaryOp) and negative else node, "value", None)
    if isinstance(value, bool) or not isinstance(value, int) or value > MOST_POWER:
        raise FormulaError("has a power that is not a whole number up to {n}; for a root write sqrt(...)", MOST_POWER)
    return -value if negative else value


def _call(node: ast.Call, names: frozenset[str]) -> Formula:
    if not isinstance(node.func, ast.Name) or node.func.id not in FUNCTIONS:
        called = node.func.id if isinstance(node.func, ast.Name) else "..."
        raise FormulaError("calls {called}, which is no function here; give {functions}", called, ", ".join(FUNCTIONS))
    if len(node.args) != 1 or node.keywords or isinstance(node.args[0], ast.Starred):
        raise FormulaError("gives {name} something else than one number", node.func.id)
    function, argument = FUNCTIONS[node.func.id], _compile(node.args[0], names)
    return lambda values: function(argument(values))
