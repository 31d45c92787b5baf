"""One step of the ring in slow motion."""

from functools import partial

from app.problems.planar_slow import PlanarSlowStage

STAGE = partial(PlanarSlowStage, problem="ring")
