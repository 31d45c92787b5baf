"""How the bar is shown, beside its stage and its pictures: regions, the reach of its sliders, words about it."""

import numpy as np

from app.problems.interface import ProblemView, Reach, Regions

LENGTHS = 20  # regions of the bar, of 0.05 m


def regions(X: np.ndarray) -> Regions:
    number = np.clip((X[:, 0] * LENGTHS).astype(int), 0, LENGTHS - 1)
    return Regions(tuple(f"X = {k / LENGTHS:.2f}–{(k + 1) / LENGTHS:.2f} m" for k in range(LENGTHS)), number)


BAR = ProblemView(
    "bar", regions, f"the bar into {LENGTHS} lengths", picture=(10.0, 1.25 / 3), speed=0.5,
    reach=Reach((8, 160, 1), (1, 8), (1e-4, 0.2), (1.0, 1000.0), (1e-2, 10.0)),
    amplitude_hint="amplitude of the vibration; from 0.159 m on the exact bar turns inside out",
    details={"linearity_preserving": "correct the gradient so that linear stress gives the exact force",
             "body_force": "where the force is evaluated", "velocity": "the velocity that moves the particles"})
