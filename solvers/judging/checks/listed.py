"""All that is compared of a run in files, in the order in which it is told."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

from solvers.judging.checks import alone, body, law, moments, placement, start
from solvers.judging.checks.alone import Alone
from solvers.judging.checks.check import HOLDS, OFF, Check, unknown
from solvers.judging.checks.evidence import Evidence
from solvers.judging.checks.figures import kept, some
from solvers.judging.checks.over_time import rms

FIGURES = "rounding of the positions in the files"
ROUNDED = 0.1  # of the error, from where on rounding is part of what is judged


@dataclass(frozen=True)
class Checks:
    """What was compared of a run, worked out when it is asked for."""

    evidence: Evidence

    @functools.cached_property
    def alone(self) -> Alone | None:
        """Particles that are not where their neighbours are."""
        with np.errstate(all="ignore"):
            return alone.of_places(self.evidence)

    @functools.cached_property
    def listed(self) -> list[Check]:
        with np.errstate(all="ignore"):  # files may have any numbers, and what is made of the largest may be none
            return self._compared()

    @functools.cached_property
    def _places(self) -> Check:
        return start.places(self.evidence)

    def _compared(self) -> list[Check]:
        evidence = self.evidence
        fewest = min(evidence.frames, key=lambda frame: len(frame.number))
        return [body.check(evidence.scene, fewest), _figures(evidence), self._places, start.speeds(evidence),
                *self._together(),
                alone.check("x", self.alone), *(alone.check(q, alone.of_values(evidence, q)) for q in ("v", "sigma")),
                alone.masses(evidence.frames[0]),
                moments.clock(evidence), moments.velocity(evidence), moments.stress(evidence), law.check(evidence)]

    def _together(self) -> list[Check]:
        """What holds of the particles as a whole; a mean over particles that are lost among the others says nothing."""
        axes, elsewhere = placement.axes(self.evidence), "particles are not where they belong"
        otherwise = OFF in (axes.verdict, self._places.verdict)
        order = unknown(placement.ORDER, elsewhere) if otherwise else placement.order(self.evidence)
        if order.verdict != HOLDS or (self.alone and self.alone.most):
            return [axes, order, unknown(placement.DRIFT, elsewhere)]
        return [axes, order, placement.drift(self.evidence)]

    def notes(self) -> list[str]:
        """What does not hold, a sentence each, but for the neighbours of x, which have their own place."""
        return [check.says for check in self.listed if check.verdict == OFF and check.name != alone.NAMES["x"]]


def _figures(evidence: Evidence) -> Check:
    """Rounding beside the error of x: errors that are smaller than what the file keeps cannot be seen in it."""
    places = some([f.position for f in evidence.frames])
    figures = kept(places)
    size = max(float(rms(error["x"])) for error in evidence.errors)
    rounding = rms(figures.rounding(places)) / np.sqrt(3)  # of rounding that may be anything up to half a unit
    if rounding <= ROUNDED * size:
        return Check(FIGURES, rounding, ROUNDED * size, "m", HOLDS, figures.words)
    return unknown(FIGURES, f"{figures.words}: the error of x is little or nothing but rounding", rounding, "m")
