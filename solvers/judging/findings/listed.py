"""All that is looked at, in the order in which it is told: of a motion alone, and of a run against its problem."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from solvers.judging.findings import alone, body, deformation, law, moments, placement
from solvers.judging.findings.alone import Alone
from solvers.judging.findings.evidence import Evidence, kept, some
from solvers.judging.findings.finding import HOLDS, OFF, Finding, unknown
from solvers.judging.findings.motion import Motion
from solvers.judging.findings.over_time import rms

FIGURES = "rounding of the positions in the files"
ROUNDED = 0.1  # of the error, from where on rounding is part of what is judged


@dataclass(frozen=True)
class Kind:
    """Findings by their names that are looked for together in the motion of any particles, where the files have what
    it ``needs`` beside positions."""

    names: tuple[str, ...]
    look: Callable[[Motion], list[Finding]]
    needs: str = "x"

    def found(self, motion: Motion) -> list[Finding]:
        if motion.get(self.needs) is None:
            what = "F" if self.needs == "gradient" else self.needs
            return [unknown(name, f"no {what} in the files (or not always a number)") for name in self.names]
        return self.look(motion)


def _of_each(look: Callable[[Motion, str], Finding], key: str) -> Callable[[Motion], list[Finding]]:
    return lambda motion: [look(motion, key)]


INSIDE_OUT = Kind((deformation.INSIDE_OUT,), lambda motion: [deformation.inside_out(motion)], "F")
#: What is looked at of particles that have neighbours.
OF_A_MOTION = (
    Kind((deformation.OVERTAKEN,), lambda motion: [deformation.overtaken(motion)]),
    Kind(deformation.NAMES_OF_F, deformation.of_f, "gradient"),
    Kind(moments.NAMES_OF_V, moments.of_v, "v"),
    *(Kind((name,), _of_each(alone.beside_others, key), key) for key, name in alone.NAMES_OF_MOTION.items()),
    *(Kind((), _of_each(alone.rough, key)) for key in ("v", "sigma")))


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
    def listed(self) -> list[Finding]:
        with np.errstate(all="ignore"):  # files may have any numbers, and what is made of the largest may be none
            return self._compared()

    @functools.cached_property
    def _places(self) -> Finding:
        return placement.places(self.evidence)

    def _compared(self) -> list[Finding]:
        evidence = self.evidence
        fewest = min(evidence.frames, key=lambda frame: len(frame.number))
        return [body.check(evidence.scene, fewest), _figures(evidence), self._places, placement.speeds(evidence),
                *self._together(),
                alone.told("x", self.alone), *(alone.told(q, alone.of_values(evidence, q)) for q in ("v", "sigma")),
                alone.masses(evidence.frames[0]),
                moments.clock(evidence), moments.velocity(evidence), moments.stress(evidence), law.check(evidence)]

    def _together(self) -> list[Finding]:
        """What holds of the particles as a whole; a mean over particles that are lost among the others says nothing."""
        axes, elsewhere = placement.axes(self.evidence), "particles are not where they belong"
        otherwise = OFF in (axes.verdict, self._places.verdict)
        order = unknown(placement.ORDER, elsewhere) if otherwise else placement.order(self.evidence)
        if order.verdict != HOLDS or (self.alone and self.alone.most):
            return [axes, order, unknown(placement.DRIFT, elsewhere)]
        return [axes, order, placement.drift(self.evidence)]

    def notes(self) -> list[str]:
        """What does not hold, a sentence each, but for the neighbours of x, which have their own place."""
        return [one.says for one in self.listed if one.verdict == OFF and one.name != alone.NAMES["x"]]


def _figures(evidence: Evidence) -> Finding:
    """Rounding beside the error of x: errors that are smaller than what the file keeps cannot be seen in it."""
    places = some([f.position for f in evidence.frames])
    figures = kept(places)
    size = max(float(rms(error["x"])) for error in evidence.errors)
    rounding = rms(figures.rounding(places)) / np.sqrt(3)  # of rounding that may be anything up to half a unit
    if rounding <= ROUNDED * size:
        return Finding(FIGURES, HOLDS, rounding, ROUNDED * size, "m", figures.words)
    return unknown(FIGURES, f"{figures.words}: the error of x is little or nothing but rounding", rounding, "m")
