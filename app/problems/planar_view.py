"""View of plane problems, from their kind of body and the settings in their file (``ViewSettings``)."""

from typing import Any

from app.frame.slow_motion.planar import PlanarSlowMotionStage
from app.language.translation import lazy
from app.problems import annulus, box
from app.problems.interface import ProblemView, SliderRanges
from app.problems.planar_suggestions import planar_suggestions
from solvers.problems.planar.problem import PlanarProblem

FORMULA = ("displacement", lazy("Displacement u_x, u_y"),
           lazy("formulas of X, Y, t, w and A in metres, with a comma between; empty for the built-in one"))


def planar_problem_view(problem: PlanarProblem) -> ProblemView:
    """Returns the view of a problem."""
    kind: type[Any] = problem.scene
    showing, fields = problem.showing, kind.__dataclass_fields__
    body = box.BODY if kind.layout == "box" else annulus.annulus_body_view(kind)
    lowest, speed, highest = showing.speed
    poisson = (lazy("Poisson's ratio ν"), -0.5, 0.49, 0.01, showing.poisson_hint)
    asks = planar_suggestions(showing)
    return ProblemView(
        kind.problem, body.stage, PlanarSlowMotionStage, body.draw_picture, body.regions, body.division, body.picture,
        speed=speed,
        slider_ranges=SliderRanges(showing.cells, showing.ppc, showing.amplitude, showing.modulus, (lowest, highest)),
        amplitude_hint=showing.amplitude_hint, modulus_hint=showing.modulus_hint, prices=showing.prices,
        details={**showing.details, "velocity": lazy("the velocity that moves the particles")},
        material={"poisson_ratio": poisson} if "poisson_ratio" in fields else {},
        formula=FORMULA if FORMULA[0] in fields else None, estimators=showing.estimators, suggestions=lambda _: asks)
