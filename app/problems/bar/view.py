"""How the bar is shown, beside its stage and its pictures: regions, the reach of its sliders, words about it."""

from __future__ import annotations

import numpy as np

from app.problems.interface import ProblemView, Reach
from app.problems.regions import Regions

LENGTHS = 20  # regions of the bar, of 0.05 m
ABOUT = """<p>A bar of unit length, periodic, vibrates as
<math display='block'><mi>u</mi><mo>=</mo><mi>A</mi><mo>sin</mo><mo>(</mo><mn>2</mn><mi>π</mi><mi>X</mi><mo>)</mo>
<mo>sin</mo><mo>(</mo><mi>ω</mi><mi>t</mi><mo>)</mo><mo>,</mo><mspace width='0.6em'/><mi>ω</mi><mo>=</mo><mi>π</mi>
<msqrt><mrow><mi>E</mi><mo>/</mo><mi>ρ</mi></mrow></msqrt></math>
because a body force makes exactly that the solution. The Material Point Method knows only the force: it carries
mass, momentum and stress on particles and solves for the acceleration on a grid.</p>"""


def regions(X: np.ndarray) -> Regions:
    number = np.clip((X[:, 0] * LENGTHS).astype(int), 0, LENGTHS - 1)
    return Regions(tuple(f"X = {k / LENGTHS:.2f}–{(k + 1) / LENGTHS:.2f} m" for k in range(LENGTHS)), number)


BAR = ProblemView(
    "bar", regions, f"the bar into {LENGTHS} lengths", picture=(10.0, 1.25 / 3), speed=0.5, about=ABOUT,
    reach=Reach((8, 160, 1), (1, 8), (1e-4, 0.2), (1.0, 1000.0), (1e-3, 4.0)),
    amplitude_hint="amplitude of the vibration; from 0.159 m on the exact bar turns inside out",
    details={"linearity_preserving": "correct the gradient so that linear stress gives the exact force",
             "body_force": "where the force is evaluated", "velocity": "the velocity that moves the particles"})
