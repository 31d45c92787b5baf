"""The picture of a body on the stage at one frame, in the colours of the estimate of a quantity."""

import math
from dataclasses import dataclass

import numpy as np

from app.frame.body_sentences import body_facts, body_name
from app.frame.body_stage import BodyPicture, BodyStage
from app.frame.colour_scale import ColourScale
from app.frame.layout import Rectangle
from app.frame.shown_body import ShownBody
from app.language.translation import lazy, tr
from solvers.bodies.estimate import QUANTITIES

ESTIMATE, NO_TRUTH = lazy("Estimate"), lazy("No truth: nobody knows it here")
NO_ESTIMATE = lazy("No estimate: the companions differ by as much as they find")
ENDED = lazy("No estimate any more: the text above says why")
NO_ACCELERATION = lazy("No estimate: that of the acceleration is not computed")


@dataclass(frozen=True)
class BodyDrawing:
    """Picture of a ``body`` in frame ``k``, for a quantity (x, v, sigma or a), on a ``stage`` with its ``scale``; the
    frame is the last for now unless it is ``playing``."""

    stage: BodyStage
    scale: ColourScale
    body: ShownBody
    k: int
    quantity: str
    playing: bool

    def draw(self) -> Rectangle:
        body, k, quantity = self.body, self.k, self.quantity
        sizes = body.believed_sizes(k, quantity)
        self.scale.whole = whole = unit_of_scale(body, quantity)
        if quantity in QUANTITIES:
            self.scale.update(np.array([body.largest[quantity] / whole]), None, (body, quantity),
                              settled=not self.playing)
        return self.stage.draw(BodyPicture(
            body.position(k), body.extent, body.width, body.spacing, quantity,
            None if sizes is None else sizes / whole, body_name(body), body_facts(body, k, quantity),
            (estimate_note(body, k, quantity), tr(NO_TRUTH))))


def unit_of_scale(body: ShownBody, quantity: str) -> float:
    """Returns the power of ten, in the quantity's unit, of which the colour scale counts shares."""
    return 10.0 ** math.ceil(math.log10(body.magnitude(quantity))) if quantity in QUANTITIES else 1.0


def estimate_note(body: ShownBody, k: int, quantity: str) -> str:
    """Returns what the colours in frame ``k`` show, or why they show nothing."""
    if quantity not in QUANTITIES:
        return tr(NO_ACCELERATION)
    if body.believed_sizes(k, quantity) is not None:
        return tr(ESTIMATE)
    return tr(ENDED if body.estimated_until < body.times[k] else NO_ESTIMATE)
