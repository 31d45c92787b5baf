"""Jets: numbers with their derivatives with respect to X, Y and t, exact to rounding (forward differentiation).

From a displacement that is written once, as a formula of jets, follow the velocity, the acceleration, the deformation
gradient and its slopes, without finite differences and without symbols. What is zero by structure is ``None`` and
costs nothing. Source: Griewank & Walther, Evaluating Derivatives, 2nd ed., SIAM 2008, chapter 13.
"""

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

Component = Any  # an array, a float, or None for a structural zero

VARIABLES = 3  # X, Y, t
PAIRS = tuple((i, j) for i in range(VARIABLES) for j in range(i, VARIABLES))
PAIR_NUMBER = {pair: k for k, pair in enumerate(PAIRS)} | {(j, i): k for k, (i, j) in enumerate(PAIRS)}


class Jet:
    """A value, a float or an array (P,), with its ``first`` derivatives by X, Y and t and its six ``second`` ones by
    the pairs of :data:`PAIRS`; ``second`` is an empty tuple for a jet of first order."""

    __slots__ = ("first", "second", "value")
    __array_ufunc__ = None  # numpy leaves products of an array and a jet to this class

    def __init__(self, value: Any, first: Iterable[Component] = (None,) * VARIABLES,
                 second: Iterable[Component] = (None,) * len(PAIRS)):
        self.value, self.first, self.second = value, tuple(first), tuple(second)

    def compose(self, value: Any, slope: Any, curvature: Any) -> "Jet":
        """Returns f of this jet by the chain rule; value, slope, curvature are f, f', f'' at this jet's value."""
        d = self.first
        return Jet(value, (_product(slope, one) for one in d),
                   (_sum(_product(slope, one), _product(curvature, _product(d[i], d[j])))
                    for one, (i, j) in zip(self.second, PAIRS, strict=False)))

    def derivative(self, i: int, j: int | None = None) -> Any:
        """Returns the derivative by variable ``i`` (0 X, 1 Y, 2 t), or ``i`` and ``j``; 0.0 if None is stored."""
        found = self.first[i] if j is None else self.second[PAIR_NUMBER[i, j]]
        return 0.0 if found is None else found

    def __add__(self, other: Any) -> "Jet":
        if not isinstance(other, Jet):
            return Jet(self.value + other, self.first, self.second)
        return Jet(self.value + other.value, map(_sum, self.first, other.first), map(_sum, self.second, other.second))

    __radd__ = __add__

    def __mul__(self, other: Any) -> "Jet":
        if not isinstance(other, Jet):
            return Jet(self.value * other, (_product(d, other) for d in self.first),
                       (_product(d, other) for d in self.second))
        a, b = self, other
        return Jet(a.value * b.value,
                   (_sum(_product(x, b.value), _product(a.value, y)) for x, y in zip(a.first, b.first, strict=True)),
                   (_sum(_sum(_product(x, b.value), _product(a.value, y)),
                         _sum(_product(a.first[i], b.first[j]), _product(a.first[j], b.first[i])))
                    for x, y, (i, j) in zip(a.second, b.second, PAIRS, strict=False)))

    __rmul__ = __mul__

    def __neg__(self) -> "Jet":
        return self * -1.0

    def __sub__(self, other: Any) -> "Jet":
        return self + (-other)

    def __rsub__(self, other: Any) -> "Jet":
        return -self + other

    def __truediv__(self, other: Any) -> "Jet":
        return self * (other ** -1 if isinstance(other, Jet) else 1.0 / other)

    def __rtruediv__(self, other: Any) -> "Jet":
        return self ** -1 * other

    def __pow__(self, n: float) -> "Jet":
        """Returns this jet to a constant power ``n``; whole powers of 0 have derivatives, too."""
        x = self.value
        slope = n * x ** (n - 1) if n != 0 else 0.0 * x
        curvature = n * (n - 1) * x ** (n - 2) if n not in (0, 1) else 0.0 * x
        return self.compose(x ** n, slope, curvature)


def _sum(a: Component, b: Component) -> Component:
    return b if a is None else a if b is None else a + b


def _product(a: Component, b: Component) -> Component:
    return None if a is None or b is None else a * b


def _elementary(function: Callable[[Any], Any], slopes: Callable[[Any, Any], tuple[Any, Any]]) -> Callable[[Any], Any]:
    """Returns ``function`` for numbers and jets; ``slopes(x, function(x))`` returns first and second derivative."""
    def extended(x: Any) -> Any:
        if not isinstance(x, Jet):
            return function(x)
        value = function(x.value)
        return x.compose(value, *slopes(x.value, value))

    return extended


sin = _elementary(np.sin, lambda x, value: (np.cos(x), -value))
cos = _elementary(np.cos, lambda x, value: (-np.sin(x), -value))
exp = _elementary(np.exp, lambda x, value: (value, value))
log = _elementary(np.log, lambda x, value: (1.0 / x, -1.0 / (x * x)))
sqrt = _elementary(np.sqrt, lambda x, value: (0.5 / value, -0.25 / (value * x)))


def variables(X: Any, Y: Any, t: Any) -> tuple[Jet, Jet, Jet]:
    """Returns X, Y and t, each a number or an array (P,), as jets of second order with the slope 1 along themselves."""
    return tuple(Jet(value, (1.0 if i == k else None for i in range(VARIABLES)))
                 for k, value in enumerate((X, Y, t)))  # type: ignore[return-value]
