"""The material of a problem divided into regions that have names."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Regions:
    """``names`` of the regions, and for each of P particles the ``number`` of the one where it was at rest."""

    names: tuple[str, ...]
    number: np.ndarray

    def errors(self, sizes: np.ndarray) -> np.ndarray:
        """The root of the mean square of sizes (P,) in each region; NaN where there is no particle."""
        with np.errstate(all="ignore"):  # a region may be empty, and a run gone bad holds anything
            squares = np.bincount(self.number, sizes.astype(float) ** 2, len(self.names))
            return np.sqrt(squares / np.bincount(self.number, minlength=len(self.names)))
