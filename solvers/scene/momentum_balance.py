"""What the balance of momentum makes of a body, kept as a few sums over its particles.

Loads, law and start of a scene fix its motion, whether or not that is written down as an exact solution: of the bar's
modes, of which each swings for itself, and of a ring's circles, each of which moves as a whole. That motion is found
without particles and without a grid. A run writes the same sums of its own displacements whenever it looks for
contradictions (``solvers.solver.soundness``), and :meth:`Moments.distance` says how far the two are apart at least.
"""

from typing import NamedTuple

import numpy as np

MODES = 10  # that a sample has room for


class Moments(NamedTuple):
    """Of displacements u at T times: sums over P particles with M functions phi_m of the material position.

    ``sums`` (T, M) are sum_p u . phi_m in m and ``squares`` (T,) sum_p |u|^2 in m^2; ``inverse`` (M, M) is the
    (pseudo-)inverse of sum_p phi_m . phi_n. ``trusted`` (T,) is False from where the motion is no longer resolved.
    """

    sums: np.ndarray
    squares: np.ndarray
    inverse: np.ndarray
    particles: int
    trusted: np.ndarray

    def distance(self, sums: np.ndarray, squares: np.ndarray) -> np.ndarray:
        """A lower bound (T,) in m of the RMS over particles of the difference from displacements with such ``sums``
        (T, M) and ``squares`` (T,); NaN where these moments are not to be trusted.

        Both parts are strict: what lies in the span of the phi_m is compared as it is, of the rest the sizes.
        """
        within = self._size(sums - self.sums)
        outside = np.sqrt(np.maximum(0.0, squares - self._size(sums))) \
            - np.sqrt(np.maximum(0.0, self.squares - self._size(self.sums)))
        return np.where(self.trusted, np.sqrt((within + outside**2) / self.particles), np.nan)

    def _size(self, sums: np.ndarray) -> np.ndarray:
        """sum_p |u|^2 (T,) of the part within the span."""
        return np.maximum(0.0, np.einsum("tm,mn,tn->t", sums, self.inverse, sums))
