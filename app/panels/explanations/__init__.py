"""What each estimator is, assumes, sees and misses, in words for a student: one html file each, equations in MathML.

A developer finds the same, with every formula, in the docstrings of ``solvers.estimators``.
"""

from __future__ import annotations

from pathlib import Path

from solvers.scene import ESTIMATORS

#: One line each, for hints.
SUMMARIES = {
    "transport": "the paper's: sends the error of the gradient mapping through the method's own equations",
    "recovered": "makes the particles' own motion smooth and holds it against the equation of motion",
    "companion": "a hidden solve of the same problem, of higher order, that the particles are measured against",
    "two-grid": "the same run on cells twice as wide beside it, and Richardson's extrapolation"}


def explanation(estimator: str) -> str:
    """The html that explains an estimator."""
    return (Path(__file__).parent / f"{estimator}.html").read_text(encoding="utf-8")


def all_explanations() -> dict[str, str]:
    """Every estimator's html, by name."""
    return {name: explanation(name) for name in ESTIMATORS}
