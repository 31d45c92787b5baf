"""One step of the vortex in slow motion."""

from functools import partial

from app.problems.planar_slow import PlanarSlowStage

STAGE = partial(PlanarSlowStage, problem="vortex")
