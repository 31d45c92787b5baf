"""View of plane problems, from their kind of body and the settings in their file (``ViewSettings``)."""

from typing import Any

from app.frame.slow_motion.planar import PlanarSlowMotionStage
from app.language.translation import lazy
from app.problems import annulus, box
from app.problems.interface import ProblemView, SliderRanges
from app.problems.planar_suggested_experiments import planar_suggestions
from solvers.problems.planar.problem import PlanarProblem

FORMULA = ("displacement", lazy("Displacement u_x, u_y"),
           lazy("formulas of X, Y, t, w and A in metres, with a comma between; empty for the built-in one"))


def planar_problem_view(problem: PlanarProblem) -> ProblemView:
    """Returns the view of a plane problem: that of its kind of body, with the settings in the problem's file."""
    kind: type[Any] = problem.scene
    settings, fields = problem.showing, kind.__dataclass_fields__
    body = box.BODY if kind.layout == "box" else annulus.annulus_body_view(kind)
    poisson = (lazy("Poisson's ratio ν"), -0.5, 0.49, 0.01, settings.poisson_hint)
    asks = planar_suggestions(settings)
    return ProblemView(
        kind.problem, body.stage, PlanarSlowMotionStage, body.draw_picture, body.regions, body.division, body.picture,
        SliderRanges(settings.cells, settings.ppc, settings.amplitude, settings.modulus), speed=settings.speed,
        amplitude_hint=settings.amplitude_hint, modulus_hint=settings.modulus_hint, prices=settings.prices,
        details={**settings.details, "velocity": lazy("the velocity that moves the particles")},
        material={"poisson_ratio": poisson} if "poisson_ratio" in fields else {},
        formula=FORMULA if FORMULA[0] in fields else None, suggestions=lambda _: asks)
