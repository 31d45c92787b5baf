"""How the bar is shown, beside its stage and its pictures: regions, the reach of its sliders, words about it."""

from dataclasses import replace
from typing import Any

import numpy as np

from app.language.spoken import later
from app.problems.bar.slow import BarSlowStage
from app.problems.bar.sparks import sparks
from app.problems.bar.stage import BarStage
from app.problems.interface import Motion, ProblemView, Reach, Regions
from solvers.problems.bar.patch import PATCH
from solvers.problems.bar.scene import BarScene

#: With the usual modulus and step a patch test's particles come to stand on cell boundaries to the last digit, where
#: rounding says in which cell they are (``patch.edge_step``).
STIFF, STIFF_CFL = 1000.0, 0.2
LENGTHS = 20  # regions of the bar, of 0.05 m


def regions(X: np.ndarray) -> Regions:
    number = np.clip((X[:, 0] * LENGTHS).astype(int), 0, LENGTHS - 1)
    return Regions(tuple(f"X = {k / LENGTHS:.2f}–{(k + 1) / LENGTHS:.2f} m" for k in range(LENGTHS)), number)


def change(scene: BarScene, motion: str, usual: tuple[str, ...]) -> BarScene:
    """A scene like another one with this motion; what means nothing there is as usual."""
    plain = BarScene()
    if motion == PATCH:
        return replace(scene, motion=motion, amplitude=plain.amplitude, body_force=plain.body_force,
                       estimators=("companion",), modulus=STIFF, dt=None, cfl=STIFF_CFL)
    return replace(scene, motion=motion, stretch=plain.stretch, initial_velocity=plain.initial_velocity,
                   body_force=plain.body_force, ppc=max(1, round(scene.ppc)), estimators=usual, modulus=plain.modulus,
                   dt=None, cfl=None)


MOTION = Motion(
    later("vibrate, or be stretched evenly and move on at constant speed, so that exactly nothing should happen"),
    change,
    {"stretch": (later("Stretch F"), 0.8, 1.2, 0.01,
                 later("length of the bar over that at rest; at 1 it has no stress")),
     "initial_velocity": (later("Velocity v, m/s"), 0.0, 2.0, 0.05,
                          later("at which the whole bar moves through the grid"))},
    speed=1.0, quantity="sigma")


def draw(*places: Any) -> None:
    from app.problems.bar import pictures

    pictures.draw(*places)


BAR = ProblemView(
    "bar", BarStage, BarSlowStage, draw, regions, later("the bar into 20 lengths"), picture=(10.0, 1.25 / 3),
    speed=0.5, reach=Reach((8, 160, 1), (1, 8), (1e-4, 0.2), (1.0, 1000.0), (1e-2, 10.0)),
    amplitude_hint=later("amplitude of the vibration; from 0.159 m on the exact bar turns inside out"),
    prices={"transport": 0.09, "recovered": 0.09, "companion": 0.06, "two-grid": 0.18},  # two-grid: of 80 cells
    motion=MOTION, estimators=("recovered", "transport"), sparks=sparks,
    details={"linearity_preserving": later("correct the gradient so that linear stress gives the exact force"),
             "body_force": later("where the force is evaluated"),
             "velocity": later("the velocity that moves the particles")})
