"""What one visitor may ask of the server. The sliders reach no further; a browser of one's own making might.

Steps a second need no limit of their own: an engine gives every session turns of the same length, and a run that cannot
keep up with its clock falls behind (``solvers.engine.stepper``). Memory goes with particles; that of frames to look
back at has a bound of its own (``app.page.visit.recent``).
"""

from app.language.spoken import tr
from solvers.scene.scene import Scene

MOST_WATCHED = 40_000  # particles; browsers show not much more
FASTEST = 1000.0  # periods a second; nobody sees anything of one run at such a speed


def too_many(scene: Scene) -> str:
    """Why the stage cannot show a scene, or nothing."""
    return tr("{particles:,} particles are too many to watch; at most {most:,} go on the stage",
              particles=scene.particles, most=MOST_WATCHED) if scene.particles > MOST_WATCHED else ""
