"""Frozen dataclasses that are sent again and again, a scene with every frame, and mostly the same ones."""

import functools
from collections.abc import Callable
from typing import Any


class Remembered:
    """A frozen dataclass with this base is pickled as its values, which come out as the same object every time: it is
    checked, and what follows from it is worked out, once for each process."""

    def __reduce__(self) -> tuple[Callable[..., Any], tuple]:
        kind: Any = type(self)
        return _known, (kind, *(getattr(self, name) for name in kind.__match_args__))


@functools.lru_cache(maxsize=256, typed=True)  # 1, 1.0 and True are not said alike
def _known(kind: type, *values: Any) -> Any:
    return kind(*values)
