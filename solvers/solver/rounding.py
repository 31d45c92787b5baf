"""Size of errors by rounding alone, beside which there is nothing to estimate.

A step adds numbers of which each is rounded to eps/2 of itself; what is lost so adds up over n steps like a random
walk, to some eps sqrt(n) times the size of the numbers. Of 150 patch tests and motions of 1e-12 m, those in which
rounding was all stayed below 15 times that in x and v, and below 70 in sigma and a. An error index of an error that
never exceeds ``ROUNDINGS`` times it is no number, and is not given.
"""

from typing import Any

import numpy as np

from solvers.scene.scene import Scene
from solvers.translatable_message import Message

ROUNDINGS = 100.0
EPS = float(np.finfo(float).eps)
LARGEST_COORDINATE = 1.0  # m: no coordinate is much larger while a body does not drift


def largest_rounding_error(scene: Scene, quantity: str, steps: Any) -> Any:
    """Returns the largest RMS error of "x", "v", "sigma" or "a", in SI, that rounding alone may cause in ``steps``
    steps, a number or an array, in the form of ``steps``."""
    # Numbers that a step adds up: for x coordinates; for v speeds of waves and drift; for sigma E, and the effect
    # of rounded velocities on F; for a the forces at a node before they cancel.
    drift, stretch = scene.drift_speed, max(1.0, scene.initial_stretch)
    stress = scene.modulus * stretch * (1 + drift * scene.time_step / scene.spacing)
    largest = {"x": LARGEST_COORDINATE + drift * scene.end_time, "v": scene.wave_speed + drift, "sigma": stress,
               "a": stress / (scene.density * scene.spacing)}[quantity]
    return ROUNDINGS * EPS * np.sqrt(np.maximum(1.0, steps)) * largest


def rounding_sentence(limit: float) -> str:
    """Returns a sentence why there is no error index, where rounding may cause errors up to ``limit`` in SI."""
    return Message("nothing but rounding: the true error never exceeds {max:.2g}, which rounding alone may make", limit)
