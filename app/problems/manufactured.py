"""How every problem with a manufactured solution on the square is shown: the square and its mirror images, estimate on
the left half, truth on the right, and beside them the field along a row of particles."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from app.frame.field import Plotted
from app.frame.marks import Mark
from app.frame.planar import MirroredStage
from app.frame.slow.planar import PlanarSlowStage
from app.language.spoken import later, tr
from app.problems.interface import ProblemView, Reach, Regions
from app.problems.spark import Answer, Offer, Ran, Spark, asked, breaking, halving
from app.state import State
from app.words import factor
from solvers.problems.manufactured.problem import ManufacturedProblem
from solvers.problems.manufactured.scene import ManufacturedScene
from solvers.problems.planar.layout import particle_layout

FORMULA = ("displacement", later("Displacement u_x, u_y"),
           later("formulas of X, Y, t, w and A in metres, with a comma between; empty for the built-in one"))
REGIONS = 4  # a side
HEIGHT = 0.3  # of the row of particles that is plotted, over that of the square
NO_BREAK = "\N{NO-BREAK SPACE}"
POINTS_PER_METRE = 240  # of the picture, roughly


def plotted_row(scene: ManufacturedScene) -> float:
    """The height Y in m of the row of particles that is plotted."""
    across = scene.cells * scene.ppc
    return (int(HEIGHT * across) + 0.5) / across * scene.SIDE


def _exact(scene: ManufacturedScene, quantity: str, X: np.ndarray, t: float) -> np.ndarray:
    return scene.exact_along_x(quantity, np.stack([X, np.full_like(X, plotted_row(scene))], axis=1), t)


class ManufacturedStage(MirroredStage[ManufacturedScene]):
    """Makes marks of frames of the square."""

    PLOT = Plotted(0.0, 1.0, ("X = 0", "1 m"), _exact)

    @staticmethod
    def outermost(scene: ManufacturedScene) -> float:
        return scene.SIDE

    @staticmethod
    def note(scene: ManufacturedScene) -> str:
        return tr("side {side}, h = {h}", side=f"{scene.SIDE:g}{NO_BREAK}m", h=f"{scene.spacing:.3g}{NO_BREAK}m")

    @staticmethod
    def stretched(scene: ManufacturedScene) -> float:
        return 1 + 0.5 * scene.STRAIN_PER_AMPLITUDE * scene.amplitude

    def _still(self, scene: ManufacturedScene, particles: int, at_rest: np.ndarray | None) -> Iterator[Mark]:
        yield from super()._still(scene, particles, at_rest)
        X = particle_layout(scene).position if at_rest is None else at_rest
        half = 0.5 * scene.spacing / scene.ppc
        self._radii = np.where(np.abs(X[:, 1] - plotted_row(scene)) < half, X[:, 0], np.nan)


def regions(X: np.ndarray) -> Regions:
    cell = np.clip((X * REGIONS).astype(int), 0, REGIONS - 1)
    names = tuple(tr("column {column}, row {row} from below", column=i + 1, row=j + 1)
                  for j in range(REGIONS) for i in range(REGIONS))
    return Regions(names, cell[:, 1] * REGIONS + cell[:, 0])


def draw(figure: Any, space: Any, particles: Any, result: Any) -> None:
    from app.renderers.plane import OVER_WIDTH, draw_halves, draw_profile

    draw_profile(space, result, ManufacturedStage, OVER_WIDTH)
    draw_halves(figure, particles, result, ManufacturedStage, 1.06 * result.scene.SIDE, [], "planes of symmetry",
                POINTS_PER_METRE)


def _untile(state: State) -> Offer:
    if state.scene.method == "ugimp":
        return Offer(tr("Domains that tile"), tr("CPDI's parallelograms"), asked(state, {"method": "cpdi"}))
    return Offer(tr("Boxes that do not tile"), tr("uGIMP: boxes keep their size"), asked(state, {"method": "ugimp"}))


def _untiled(ran: Ran) -> Answer:
    said = tr("It errs {factor} times as much.", factor=factor(ran.ratio))
    if ran.state.scene.method == "ugimp":
        return said, tr("Boxes that keep their size leave gaps where the material stretches. Would smaller cells help?")
    return said, tr("Parallelograms follow the material and leave no gap.")


def view_of(problem: ManufacturedProblem) -> ProblemView:
    """The view of a problem."""
    showing, typed = problem.showing, FORMULA[0] in problem.scene.__dataclass_fields__

    questions = (halving(showing.cells[1]), Spark("tile", "tile", later("Boxes that do not tile"), _untile, _untiled),
                 breaking(later("Break it"), later("hat functions"), {"method": "mpm"}, 1.0))

    return ProblemView(
        problem.scene.problem, ManufacturedStage, PlanarSlowStage, draw, regions, later("the square into 16 squares"),
        picture=(13.5, 0.85), speed=0.2,
        reach=Reach(showing.cells, showing.ppc, showing.amplitude, showing.modulus, (1e-2, 10.0)),
        amplitude_hint=showing.amplitude_hint,
        details={"body_force": later("whether the force acts"),
                 "velocity": later("the velocity that moves the particles")},
        material={"poisson_ratio": (later("Poisson's ratio ν"), -0.5, 0.49, 0.01,
                                    later("resistance to a change of volume"))},
        prices=showing.prices, formula=FORMULA if typed else None, estimators=("companion",),
        sparks=lambda _: questions)
