"""A field of time and place as data: sum_k T_k(t) M_k(X), so that no formula is compiled into a kernel.

A smooth field with a period is a trigonometric polynomial in time to rounding, for its Fourier coefficients fall
geometrically; and few of its values at different places are independent. So values at some hundred places and 16, 32,
64, ... times, until the spectrum ends in rounding, have the T_k as their singular vectors; the M_k of all places follow
from about twice as many times as there are T_k.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

#: (X (n, 2), t (n,)) -> (n, C) components.
Field = Callable[[np.ndarray, np.ndarray], np.ndarray]

SAMPLE_PLACES = 300  # from which the functions of time are found
FEWEST_TIMES, MOST_TIMES = 16, 4096  # of a period
SPECTRUM_END = 3e-15  # of the largest Fourier coefficient: rounding
NOISY_FROM, NOISE = 128, 1e-12  # times from which on so much passes for rounding, too: of a formula that cancels
RANK_TOLERANCE = 2e-16  # of the largest singular value, times the root of the number of values
BETWEEN, ALIASED = np.array([0.1234567, 0.4142136, 0.8284271]), 1e-9  # of a period; and of the largest value
VALUES_PER_CALL = 100_000  # places and times of one call
LEAST_COEFFICIENT = 1e-15  # of a harmonic that is kept, over the largest


class NotPeriodicError(ArithmeticError):
    """Error for a field that is not a smooth function of time with the period given."""


@dataclass(frozen=True)
class SeparableField:
    """Field sum_k T_k(t) M_k(X) of C components at P places, of r terms: ``modes`` are M_k (P, r, C), ``series`` the
    coefficients (r, 1 + 2 H) of T_k, which are the mean, then cos and sin of the harmonics 1 to H;
    ``angular_frequency`` is that of the first harmonic, in 1/s."""

    modes: np.ndarray
    series: np.ndarray
    angular_frequency: float

    @property
    def rank(self) -> int:
        return len(self.series)

    @property
    def harmonics(self) -> int:
        return self.series.shape[1] // 2

    def time_functions(self, t: float, derivative: int = 0) -> np.ndarray:
        """Returns the functions T_k (r,) at time ``t`` in s, or their first or second ``derivative``, per s or s^2."""
        w = np.arange(1, self.harmonics + 1) * self.angular_frequency
        turn = w * t + 0.5 * np.pi * derivative
        waves = np.stack([np.cos(turn), np.sin(turn)], axis=1) * (w**derivative)[:, None]
        return self.series[:, 1:] @ waves.ravel() + self.series[:, 0] * (derivative == 0)

    def __call__(self, t: float, derivative: int = 0) -> np.ndarray:
        """Returns the field (P, C) at time ``t`` in s, or its first or second ``derivative`` by time, per s or s^2."""
        return np.einsum("k,pkc->pc", self.time_functions(t, derivative), self.modes)


def separate(field: Field, places: np.ndarray, period: float) -> SeparableField:
    """Returns a ``field`` (places (n, D) in m, times (n,) in s) -> (n, C) of a ``period`` in s at ``places`` (P, D) in
    separated form, to rounding. Raises NotPeriodic where it is not finite, or its spectrum does not end."""
    some = places[np.unique(np.linspace(0, len(places) - 1, min(SAMPLE_PLACES, len(places))).astype(int))]
    values, times = _sample_resolved(field, some, period)
    _, size, V = np.linalg.svd(np.linalg.qr(values, mode="r"))  # functions of time that span the values, largest first
    T = V[:max(1, int(np.count_nonzero(size > RANK_TOLERANCE * np.sqrt(values.size) * size[0])))]
    chosen = _pivot_times(T, min(len(times), 2 * len(T)))
    modes = _evaluate(field, places, times[chosen]) @ np.linalg.pinv(T[:, chosen])  # (P C, r)
    return SeparableField(modes.reshape(len(places), -1, len(T)).swapaxes(1, 2).copy(),
                          _fourier_series(T, np.abs(modes).max(axis=0)), 2 * np.pi / period)


def _sample_resolved(field: Field, places: np.ndarray, period: float) -> tuple[np.ndarray, np.ndarray]:
    """Returns values (n C, M) at M times (M,) in s of a ``period``, enough to resolve the spectrum, and the times;
    raises NotPeriodic where too many are needed or values are not finite."""
    M = FEWEST_TIMES
    while True:
        times = period * np.arange(M) / M
        values = _evaluate(field, places, times)
        spectrum = np.abs(np.fft.rfft(values, axis=1)).max(axis=0)
        if not np.isfinite(spectrum).all():
            raise NotPeriodicError("it is not finite at some time")
        largest, end = spectrum.max(), spectrum[-max(2, M // 8):].max()
        if (end <= SPECTRUM_END * largest or (M >= NOISY_FROM and end <= NOISE * largest)) \
                and _interpolates(field, places, period, values):
            return values, times
        if M >= MOST_TIMES:
            raise NotPeriodicError(f"{period:g} s is not its period, or it changes too fast")
        M *= 2


def _interpolates(field: Field, places: np.ndarray, period: float, values: np.ndarray) -> bool:
    """Returns whether trigonometric interpolation of ``values`` (n C, M), sampled over a ``period`` in s, agrees with
    the field at other times, because changes faster than the samples would look slow."""
    M = values.shape[1]
    coefficients = np.fft.rfft(values, axis=1) / M
    coefficients[:, 1:(M + 1) // 2] *= 2
    waves = np.exp(2j * np.pi * np.outer(np.arange(coefficients.shape[1]), BETWEEN))
    missed = np.abs((coefficients @ waves).real - _evaluate(field, places, period * BETWEEN)).max()
    return bool(missed <= ALIASED * np.abs(values).max())


def _evaluate(field: Field, places: np.ndarray, times: np.ndarray) -> np.ndarray:
    """Returns the field as values (n C, M) at n ``places`` (n, D) and M ``times`` in s, evaluated for many at once."""
    together = max(1, VALUES_PER_CALL // len(places))
    found = [field(np.tile(places, (len(some), 1)), np.repeat(some, len(places))).reshape(len(some), -1)
             for some in np.split(times, range(together, len(times), together))]
    return np.concatenate(found).T


def _pivot_times(T: np.ndarray, count: int) -> np.ndarray:
    """Returns the indices of the ``count`` of M times that distinguish the functions ``T`` (r, M) best, in order: by
    pivoted elimination, repeated among the remaining times."""
    chosen: list[int] = []
    while len(chosen) < count:
        left = T.copy()
        left[:, chosen] = 0.0
        for _ in range(min(len(T), count - len(chosen))):
            pivot = int(np.argmax((left**2).sum(axis=0)))
            if not left[:, pivot].any():
                return np.array(sorted(chosen))
            chosen.append(pivot)
            direction = left[:, pivot] / np.linalg.norm(left[:, pivot])
            left -= np.outer(direction, direction @ left)
            left[:, chosen] = 0.0
    return np.array(sorted(chosen))


def _fourier_series(T: np.ndarray, sizes: np.ndarray) -> np.ndarray:
    """Returns mean, cos and sin coefficients (r, 1 + 2 H) of functions ``T`` (r, M) sampled over a period, up to the
    last harmonic whose part in the field, whose modes have these ``sizes`` (r,), exceeds rounding."""
    M = T.shape[1]
    coefficients = np.fft.rfft(T, axis=1) / M
    told = (sizes[:, None] * np.abs(coefficients[:, :M // 2])).max(axis=0)
    H = max(1, int(np.flatnonzero(told > LEAST_COEFFICIENT * told.max())[-1]))
    series = np.empty((len(T), 1 + 2 * H))
    series[:, 0] = coefficients[:, 0].real
    series[:, 1::2], series[:, 2::2] = 2 * coefficients[:, 1:H + 1].real, -2 * coefficients[:, 1:H + 1].imag
    return series
