"""Values by quantity in the form of the JSON object: of one estimator as they are, of several keyed by estimator."""

from collections.abc import Mapping
from typing import Any

from solvers.scene.rules import SceneError


class ByQuantity(dict[str, Any]):
    """Values by the name of a quantity.

    Raises
    ------
    SceneError
        For a name that is not there, with those that are.
    """

    def __missing__(self, name: object) -> Any:
        raise SceneError("quantity", name, f"is none of this run's; give one of {', '.join(self)}")


class ByEstimator(dict[str, Any]):
    """Values of each quantity, of a run's only estimator; of several, a mapping from estimator to that.

    Either may be asked by name: ``index["companion"]["x"]`` is ``index["x"]`` where the companion is alone.

    Raises
    ------
    SceneError
        For a name that is not there, with those that are.
    """

    def __init__(self, values: Mapping[str, dict], nothing: dict):
        self.estimators = tuple(values)
        super().__init__(values if len(values) > 1 else next(iter(values.values()), nothing))

    def __missing__(self, name: object) -> dict:
        if (name,) == self.estimators:
            return dict(self)
        run = ", ".join(self.estimators) or "none"
        if len(self.estimators) > 1:
            raise SceneError("estimator", name, f"is none of this run's; give one of {run}, and then the quantity")
        raise SceneError("estimator", name, f"is not this run's, which has {run}; give that or one of "
                                            f"{', '.join(self)}")
