"""The ring, made to fit the stage: a quarter and its mirror images, estimate on the left half, truth on the right, and
the field plot below."""

from app.frame.field import Plotted
from app.frame.planar import MirroredStage
from app.language.spoken import tr
from solvers.problems.ring import exact
from solvers.problems.ring.exact import INNER, OUTER
from solvers.problems.ring.scene import RingScene

NO_BREAK = "\N{NO-BREAK SPACE}"


class RingStage(MirroredStage[RingScene]):
    """Makes marks of frames of the ring."""

    PLOT = Plotted(INNER, OUTER, (f"R = {INNER} m", f"{OUTER} m"), exact.field, "radial")

    @staticmethod
    def outermost(scene: RingScene) -> float:
        return OUTER + scene.amplitude

    @staticmethod
    def note(scene: RingScene) -> str:
        h = f"h{NO_BREAK}={NO_BREAK}{scene.spacing:.3g}{NO_BREAK}m"
        return tr("outer radius {radius} at rest, {h}", radius=f"{OUTER}{NO_BREAK}m", h=h)

    @staticmethod
    def stretched(scene: RingScene) -> float:
        return 1 + 0.5 * scene.amplitude / OUTER
