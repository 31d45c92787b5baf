"""Limits of estimators: rows of a table that say, before a run, where an estimator is known not to hold.

The first row that is violated gives the reason. What only a run can show is checked by the estimator's ``verdict``.
"""

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import KW_ONLY, dataclass, field
from typing import Any

from solvers.translatable_message import Message, join_messages

Quantity = str | Callable[[Any], Any]  # an attribute of the scene, or a function of it


@dataclass(frozen=True)
class Limit:
    """Row of a problem's ``LIMITS``: an ``estimator`` holds only while a ``quantity`` of the scene stays within them.

    A limit is a value, or a quantity as well: ``least`` and ``most`` may be reached, ``below`` may not, all in units
    ``of`` another quantity. If some values are ``allowed``, the quantity must be one of them, or consist of them. The
    row applies to scenes ``where`` quantities have a value, or one of several, and one is ``above`` a number.
    ``impossible`` is whether the estimator cannot run at all beyond the limit. ``why`` is the end of a sentence with
    places for attributes of the ``scene``, the ``value``, ``least``, ``most``, ``above``, the ``names`` that are not
    allowed, and suggestions ``give``: functions of the scene and the value.
    """

    estimator: str
    quantity: Quantity
    _: KW_ONLY
    least: float | Quantity = -math.inf
    most: float | Quantity = math.inf
    below: float | Quantity = math.inf
    of: float | Quantity = 1
    allowed: tuple | Quantity = ()
    where: Mapping[Any, Any] = field(default_factory=dict)
    above: tuple[Quantity, float] = ("cells", -math.inf)
    impossible: bool = False
    give: Mapping[str, Callable[[Any, Any], Any]] = field(default_factory=dict)
    why: str

    def reason(self, scene: Any) -> str | None:
        """Returns why the estimator does not hold in a scene, the end of a sentence; None where it meets this limit."""
        def at(what: Any) -> Any:
            return what(scene) if callable(what) else getattr(scene, what) if isinstance(what, str) else what

        if any(at(quantity) not in _as_tuple(wanted) for quantity, wanted in self.where.items()) \
                or not at(self.above[0]) > self.above[1]:
            return None
        value, least, most, unit, allowed = map(at, (self.quantity, self.least, self.most, self.of, self.allowed))
        others = [name for name in _as_tuple(value) if name not in allowed] if allowed else []
        if not others and (allowed or (least * unit <= value <= most * unit and value < at(self.below) * unit)):
            return None
        return Message(self.why, scene=scene, value=value if self.of == 1 else value / unit, least=least, most=most,
                       above=self.above[1], names=join_messages(" and ", map(str, others)),
                       **{name: enough(scene, value) for name, enough in self.give.items()})


def reason(limits: Iterable[Limit], estimator: str, scene: Any) -> str | None:
    """Returns why an estimator does not hold in a scene, by the first violated of the ``limits``; None if none."""
    return next(filter(None, (limit.reason(scene) for limit in limits if limit.estimator == estimator)), None)


def _as_tuple(value: Any) -> tuple:
    return value if isinstance(value, tuple) else (value,)
