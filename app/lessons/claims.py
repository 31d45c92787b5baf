"""Claims and expected values: expressions about the results of runs.

    error.x.max < 1e-5                      about the step's first run
    hat.index.recovered.x in 0.9..1.1       about the run named hat
    budget.v.crossings > 0.8                share of a cause in the error of v, with the effect budget
    hat.bet.gci.x.score > 2                 score of a judge's bet on a final error of hat; also its low and high
    predicted.v.crossings < 0.1 * rms.v     the budget's prediction without the cause, and the actual error
    order(grids.error.x.max) in 1.9..2.1    for a run on several grids
    node.error.x.max / material.error.x.max > 10
    status == lost
    beam.goals.lowest.bar < 0.01            a goal's value or error bar, in the run of a body

A path is one in the result's JSON object, with the estimator's name if several are possible."""

import ast
import functools
import math
import operator
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from app.lessons import body_runs, interval_bets
from app.names_and_units import EXTRA_NORMS, QUANTITIES
from solvers.scene.effects import ALL
from solvers.scene.error_causes import CAUSES, FIELDS
from solvers.scene.estimator_registry import ESTIMATORS
from solvers.scene.extension_modules import load_extensions
from solvers.study.coverage import random_runs
from solvers.untrusted.quoting import one_line, quote

WORDS = {word: word for word in ("ok", "unstable", "lost", "yes", "no")}
NORMS = ("final", "max", "mean")
Vocabulary = Mapping[str, tuple[tuple[str, ...], ...]]
_OPERATORS: dict[type, Callable[[Any, Any], Any]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv,
    ast.Pow: lambda base, power: float(base) ** power}  # integer powers could take forever
_COMPARISONS: dict[str, Callable[[Any, Any], bool]] = {
    "<=": operator.le, ">=": operator.ge, "==": operator.eq, "!=": operator.ne, "<": operator.lt, ">": operator.gt}
LONGEST = 1000  # letters of a claim
_COMPARED = re.compile(r"(.+?)(<=|>=|==|!=|<|>)(.+)", re.DOTALL)
_RANGE = re.compile(r"(.+?)\s+in\s+(.+?)\.\.(.+)", re.DOTALL)


@functools.cache
def result_paths() -> Vocabulary:
    """Returns the paths that claims may use: by first word the allowed words at each further level."""
    load_extensions()
    estimators = tuple(name.replace("-", "_") for name in ESTIMATORS)
    found = {effect.json_key: tuple(filter(None, [tuple(number.key for number in effect.numbers if number.key)]))
             for effect in ALL.values() if effect.numbers}
    return {"error": ((*QUANTITIES, *EXTRA_NORMS), NORMS), "estimate": (estimators, tuple(QUANTITIES), NORMS),
            "index": (estimators, tuple(QUANTITIES)), "distance": (estimators, tuple(QUANTITIES)),
            "corrected": (estimators, tuple(QUANTITIES), NORMS),
            "budget": (FIELDS, tuple(CAUSES)), "rms": (FIELDS,), "predicted": (FIELDS, tuple(CAUSES)),
            "bet": (tuple(map(interval_bets.judge_name_in_claims, interval_bets.JUDGES)), random_runs.QUANTITIES,
                    ("low", "high", "score")), "valid": (estimators,), "status": (), "steps": (), "particles": (),
            "t": (), "goals": (body_runs.goal_names(), ("value", "bar")), **found,
            "step": (("dt", "bound", "margin"),), "life": (("accurate", "sound", "first_period"),),
            "scene": (("amplitude", "cells", "ppc", "modulus", "density", "dt", "cfl", "periods", "t_end", "method"),)}


class ClaimError(ValueError):
    """Raised for an expression that is invalid or has no value; the message gives the reason and what is expected."""

    def __init__(self, why: str):
        super().__init__(one_line(why))


@dataclass(frozen=True)
class RunOutcome:
    """Outcome of a lesson's run: the JSON objects of its results, several if they differ in the field ``varied``."""

    results: Sequence[Mapping[str, Any]]
    varied: str = ""


@dataclass(frozen=True)
class ClaimNamespace:
    """Outcomes by name of the run, that of the ``main`` run, which paths without a name mean, and the allowed paths."""

    outcomes: Mapping[str, RunOutcome]
    main: str = ""
    vocabulary: Vocabulary | None = None

    @property
    def paths(self) -> Vocabulary:
        return self.vocabulary or result_paths()


@dataclass(frozen=True)
class ClaimResult:
    """Whether a claim holds, and the values of its left side, as text."""

    holds: bool
    text: str


def evaluate_expression(text: str, scope: ClaimNamespace) -> float | str:
    """Returns the number or word that an expression such as "error.x.max / 2" gives; raises :class:`ClaimError`."""
    found = _evaluate_node(_parse_expression(text), scope)
    if isinstance(found, list):
        raise ClaimError(f"{text} has {len(found)} values; take order(), first(), last(), min() or max() of them")
    if isinstance(found, float) and not math.isfinite(found):
        raise ClaimError(f"{text} is not finite")
    return found


def decide_claim(claim: str, scope: ClaimNamespace) -> ClaimResult:
    """Decides a claim such as "error.x.max < 1e-5"; if its left side has several values, it must hold for each."""
    parts = _split_claim(claim)
    found = _evaluate_node(_parse_expression(parts[0]), scope)
    each = found if isinstance(found, list) else [evaluate_expression(parts[0], scope)]
    results = [_decide_for_value(claim, parts, one, scope) for one in each]
    return ClaimResult(all(one.holds for one in results), ", ".join(one.text for one in results))


def _decide_for_value(claim: str, parts: tuple[str, ...], found: float | str, scope: ClaimNamespace) -> ClaimResult:
    """Decides a claim, split into ``parts`` by :func:`_split_claim`, for one value of its left side."""
    if parts[1] in _COMPARISONS:
        other = evaluate_expression(parts[2], scope)
        if isinstance(found, str) != isinstance(other, str):
            raise ClaimError(f"{claim} compares a word with a number")
        told = format_value(found) if _is_number(parts[2]) else f"{format_value(found)} and {format_value(other)}"
        return ClaimResult(_COMPARISONS[parts[1]](found, other), told)
    low, high = evaluate_expression(parts[1], scope), evaluate_expression(parts[2], scope)
    if isinstance(found, str) or isinstance(low, str) or isinstance(high, str):
        raise ClaimError(f"{claim}: a range is one of numbers")
    return ClaimResult(low <= found <= high, format_value(found))


def check_claim(claim: str, runs: Mapping[str, Any], main: str, vocabulary: Vocabulary | None = None) -> None:
    """Raises :class:`ClaimError` for a claim that no result can decide. Other arguments: :func:`check_expression`."""
    parts = _split_claim(claim)
    for part in (parts[0], *(part for part in parts[1:] if part not in _COMPARISONS)):
        check_expression(part, runs, main, vocabulary)


def check_expression(text: str, runs: Mapping[str, Any], main: str, vocabulary: Vocabulary | None = None) -> None:
    """Raises :class:`ClaimError` for an expression that no results can give a value. ``runs`` has the runs' names as
    keys, ``main`` is the run meant by paths without a name ("" for none), ``vocabulary`` as :func:`result_paths`."""
    for node in ast.walk(_parse_expression(text)):
        if isinstance(node, ast.Call) and (not isinstance(node.func, ast.Name) or node.func.id not in FUNCTIONS
                                           or len(node.args) != 1 or node.keywords):
            raise ClaimError(f"{ast.unparse(node)}: give {', '.join(f'{name}(…)' for name in FUNCTIONS)}")
    known = vocabulary or result_paths()
    for path in _dotted_paths(_parse_expression(text)):
        name, rest = _split_run_from_path(path, runs, main, known)
        _check_path(rest, known)
        if not name:
            raise ClaimError(f"{'.'.join(path)}: no run comes before this; name one of {', '.join(runs) or 'a run'}")


def runs_needed(text: str, runs: Mapping[str, Any], main: str) -> set[str]:
    """Returns the names of the runs in a claim or an expression; paths without a name mean the run ``main``."""
    found = _split_claim(text) if any(sign in text for sign in (" in ", "<", ">", "=")) else (text,)
    parts = [part for part in found if part not in _COMPARISONS]
    return {_split_run_from_path(path, runs, main, result_paths())[0]
            for part in parts for path in _dotted_paths(_parse_expression(part))}


def format_value(value: float | str) -> str:
    """Formats a number with four significant digits; words stay."""
    return value if isinstance(value, str) else f"{value:.4g}"


def _split_claim(claim: str) -> tuple[str, ...]:
    """Splits a claim into (left, operator, right) or, if it has "in low..high", (value, low, high)."""
    for pattern in (_RANGE, _COMPARED) if len(claim) <= LONGEST else ():
        if found := pattern.fullmatch(claim.strip()):
            return tuple(part.strip() for part in found.groups())
    raise ClaimError(f"'{quote(claim)}' claims nothing; give something like error.x.max < 1e-5 or "
                     "order(x) in 1.9..2.1")


def _parse_expression(text: str) -> ast.expr:
    try:
        tree = ast.parse(text.strip() if len(text) <= LONGEST else "", mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):  # of what is nested too deep, the last two
        raise ClaimError(f"'{quote(text)}' cannot be read; give numbers, paths such as error.x.max, + - * / ** and "
                         f"{', '.join(f'{name}(…)' for name in FUNCTIONS)}") from None
    allowed = (ast.BinOp, ast.UnaryOp, ast.USub, ast.Constant, ast.Attribute, ast.Name, ast.Call, ast.Load, *_OPERATORS)
    for node in ast.walk(tree):
        if not isinstance(node, allowed) or (isinstance(node, ast.Constant) and not _is_real(node.value)):
            part = quote(ast.unparse(node)) if isinstance(node, ast.expr) else "this"
            raise ClaimError(f"'{quote(text)}': {part} means nothing here; give numbers, paths such as error.x.max, "
                             "+ - * / ** and functions")
    return tree


def _dotted_paths(tree: ast.expr) -> list[tuple[str, ...]]:
    """Returns the paths in a parsed expression, split at dots, without words such as "lost" and names of functions."""
    if isinstance(tree, (ast.Attribute, ast.Name)):
        path = _dotted_path(tree)
        return [] if len(path) == 1 and path[0] in WORDS else [path]
    if isinstance(tree, ast.Call):
        return _dotted_paths(tree.args[0]) if tree.args else []
    return [path for child in ast.iter_child_nodes(tree) if isinstance(child, ast.expr)
            for path in _dotted_paths(child)]


def _dotted_path(node: ast.expr) -> tuple[str, ...]:
    if isinstance(node, ast.Name):
        return (node.id,)
    if isinstance(node, ast.Attribute):
        return (*_dotted_path(node.value), node.attr)
    raise ClaimError(f"{ast.unparse(node)} is no path; give one such as error.x.max")


def _split_run_from_path(path: tuple[str, ...], runs: Mapping[str, Any], main: str,
                         vocabulary: Vocabulary) -> tuple[str, tuple[str, ...]]:
    """Returns the run of a split path (``main`` if it names none), and the path within that run's result."""
    if path[0] in runs:
        return path[0], path[1:]
    if path[0] not in vocabulary:
        known = ", ".join((*runs, *vocabulary))
        raise ClaimError(f"{'.'.join(path)}: {path[0]} is neither a run nor part of a result; give one of {known}")
    return main, path


def _check_path(path: tuple[str, ...], vocabulary: Vocabulary) -> None:
    if not path or path[0] not in vocabulary:
        raise ClaimError(f"{'.'.join(path) or 'a run alone'} is no part of a result; begin with one of "
                         f"{', '.join(vocabulary)}")
    levels = vocabulary[path[0]]
    for level, allowed in enumerate(levels, 1):
        if level >= len(path) or path[level] not in allowed:
            raise ClaimError(f"{'.'.join(path)}: after {'.'.join(path[:level])} give one of {', '.join(allowed)}")
    if len(path) > len(levels) + 1:
        raise ClaimError(f"{'.'.join(path)}: nothing comes after {'.'.join(path[:len(levels) + 1])}")


def _evaluate_node(node: ast.expr, scope: ClaimNamespace) -> Any:
    if isinstance(node, ast.Constant):
        return node.value
    if isinstance(node, ast.UnaryOp):
        return -_require_number(_evaluate_node(node.operand, scope), node.operand)
    if isinstance(node, ast.BinOp):
        left, right = (_require_number(_evaluate_node(side, scope), side) for side in (node.left, node.right))
        try:
            return _OPERATORS[type(node.op)](left, right)
        except (ArithmeticError, ValueError):
            raise ClaimError(f"{ast.unparse(node)} has no value") from None
    if isinstance(node, ast.Call):
        return _evaluate_call(node, scope)
    path = _dotted_path(node)
    if len(path) == 1 and path[0] in WORDS and path[0] not in scope.outcomes:
        return WORDS[path[0]]
    name, rest = _split_run_from_path(path, scope.outcomes, scope.main, scope.paths)
    outcome = scope.outcomes[name]
    values = [_value_at_path(result, rest) for result in outcome.results]
    return values if outcome.varied else values[0]


def _evaluate_call(node: ast.Call, scope: ClaimNamespace) -> float:
    name, argument = node.func.id, node.args[0]  # type: ignore[attr-defined]  # has been checked
    values = _evaluate_node(argument, scope)
    if name == "order":
        names = [_split_run_from_path(path, scope.outcomes, scope.main, scope.paths)[0]
                 for path in _dotted_paths(argument)]
        varied = [scope.outcomes[run] for run in names if scope.outcomes[run].varied]
        if not varied or not isinstance(values, list) or len(values) < 2:
            raise ClaimError(f"{ast.unparse(node)}: needs a run with several values of one field, such as "
                             "cells=20,40,80")
        sizes = [float(result["scene"][varied[0].varied]) for result in varied[0].results]
        if min(values) <= 0:
            raise ClaimError("an order needs values above 0")
        # The slope of the logarithms over those of h, or of the varied field.
        return float(np.polyfit(np.log(sizes) * (-1 if varied[0].varied == "cells" else 1), np.log(values), 1)[0])
    return FUNCTIONS[name](values if isinstance(values, list) else [values])


def _value_at_path(result: Mapping[str, Any], path: tuple[str, ...]) -> float | str:
    """Returns the number or word at a split path of a result's JSON object; raises :class:`ClaimError` without one."""
    found: Any = result
    names = list(path)
    if path[0] in ("estimate", "index", "distance", "corrected", "valid"):
        estimator, running = path[1].replace("_", "-"), result["scene"]["estimator"] if "scene" in result else ()
        if estimator not in running:
            raise ClaimError(f"{'.'.join(path)}: {estimator} does not run in this scene")
        if path[0] == "valid":
            return "no" if estimator in result["not_valid"] else "yes"
        names = [path[0], *([estimator] if len(running) > 1 or path[0] == "corrected" else []), *path[2:]]
        if estimator in result.get("refused", ()) and path[0] != "corrected":
            names = ["refused", estimator, path[0], *path[2:]]
    if path[0] in ("rms", "predicted"):
        names = ["budget", *path]
    for name in names:
        found = None if found is None else found.get(name)
    if found is None:
        raise ClaimError(f"{'.'.join(path)} is not known of this run")
    return found


def _require_number(found: Any, node: ast.expr) -> float:
    if not _is_real(found):
        raise ClaimError(f"{ast.unparse(node)} is no number; give one, or first(…), last(…) of several")
    return float(found)


def _is_real(found: Any) -> bool:
    return isinstance(found, (int, float)) and not isinstance(found, bool)


def _is_number(text: str) -> bool:
    try:
        return math.isfinite(float(text))
    except ValueError:
        return False


FUNCTIONS: dict[str, Callable[[list], float]] = {"order": lambda values: math.nan, "first": lambda values: values[0],
                                                 "last": lambda values: values[-1], "min": min, "max": max}
