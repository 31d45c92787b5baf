"""Motion of a body by the balance of momentum, reduced to a few sums over its particles.

Loads, material law and initial state of a scene determine its motion, whether or not an exact solution is written down:
that of the bar's modes, which oscillate independently, and of a ring's circles, which move as a whole. It is computed
without particles and grid. A run stores the same sums of its own displacements whenever it looks for contradictions
(``solvers.solver.soundness``), and :meth:`Moments.rms_distance_bound` is a lower bound of the difference.
"""

from typing import NamedTuple

import numpy as np

MODES = 10  # sums that a sample can hold


class DisplacementMoments(NamedTuple):
    """Moments of displacements u at T times: sums over P ``particles`` with M functions phi_m of the material position.

    ``sums`` (T, M) are sum_p u . phi_m in m and ``squares`` (T,) sum_p |u|^2 in m^2; ``inverse`` (M, M) is the
    (pseudo-)inverse of sum_p phi_m . phi_n. ``trusted`` (T,) is False from where the motion is no longer resolved.
    """

    sums: np.ndarray
    squares: np.ndarray
    inverse: np.ndarray
    particles: int
    trusted: np.ndarray

    def rms_distance_bound(self, sums: np.ndarray, squares: np.ndarray) -> np.ndarray:
        """Returns a lower bound (T,) in m of the RMS over particles of the difference from displacements with these
        ``sums`` (T, M) and ``squares`` (T,); NaN where these moments are not to be trusted.

        Both parts are strict: what lies in the span of the phi_m is compared as it is, of the rest the sizes.
        """
        within = self._squared_norm_in_span(sums - self.sums)
        outside = np.sqrt(np.maximum(0.0, squares - self._squared_norm_in_span(sums))) \
            - np.sqrt(np.maximum(0.0, self.squares - self._squared_norm_in_span(self.sums)))
        return np.where(self.trusted, np.sqrt((within + outside**2) / self.particles), np.nan)

    def _squared_norm_in_span(self, sums: np.ndarray) -> np.ndarray:
        """Returns sum_p |u|^2 (T,) in m^2 of the part of u within the span of the phi_m, from its ``sums`` (T, M)."""
        return np.maximum(0.0, np.einsum("tm,mn,tn->t", sums, self.inverse, sums))
