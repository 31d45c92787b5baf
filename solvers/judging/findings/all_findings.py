"""All findings, in the order of the report: of a motion alone, and of a run against its problem."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from solvers.judging.findings import (
    amplitude_and_pace,
    body_coverage,
    constitutive_law,
    deformation,
    frame_times,
    frozen_values,
    intervals,
    outliers,
    position_and_interpretation,
    sizes_by_quantity,
    time_consistency,
)
from solvers.judging.findings.finding import HOLDS, OFF, Finding, unknown
from solvers.judging.findings.findings_input import FindingsInput, detect_precision, sample_numbers
from solvers.judging.findings.outliers import FrameOutliers
from solvers.judging.findings.recorded_motion_reader import RecordedMotion
from solvers.judging.findings.time_series_fitting import rms

FIGURES = "rounding of the positions in the files"
ROUNDED = 0.1  # of the error, from which on rounding is significant


@dataclass(frozen=True)
class ConsistencyCheck:
    """Group of findings, by name, that are computed together from the motion of any particles by ``check``, where the
    files have the quantity ``needs`` beside positions."""

    names: tuple[str, ...]
    check: Callable[[RecordedMotion], list[Finding]]
    needs: str = "x"

    def find_in(self, motion: RecordedMotion) -> list[Finding]:
        """Returns the findings in a motion; "cannot be told" for each where the files lack the quantity."""
        if motion.get(self.needs) is None:
            what = "F" if self.needs == "gradient" else self.needs
            return [unknown(name, f"no {what} in the files (or not always a number)") for name in self.names]
        return self.check(motion)


def _for_quantity(check: Callable[[RecordedMotion, str], Finding],
                  key: str) -> Callable[[RecordedMotion], list[Finding]]:
    return lambda motion: [check(motion, key)]


INSIDE_OUT = ConsistencyCheck((deformation.INSIDE_OUT,), lambda motion: [deformation.check_inverted(motion)], "F")
FROZEN = (ConsistencyCheck((frozen_values.REPEATED,), lambda motion: [frozen_values.check_repeated(motion)]),
          *(ConsistencyCheck((name,), _for_quantity(frozen_values.check_frozen, key), key) for key,
            name in frozen_values.NAMES.items()))
#: Checks of particles with neighbours.
MOTION_FINDINGS = (ConsistencyCheck((deformation.OVERTAKEN,), lambda motion: [deformation.check_overtaken(motion)]),
                   ConsistencyCheck(deformation.NAMES_OF_F, deformation.check_f, "gradient"),
                   ConsistencyCheck(time_consistency.NAMES_OF_V, time_consistency.check_velocity, "v"),
                   ConsistencyCheck((intervals.NAME,), lambda motion: [intervals.check_intervals(motion)], "v"),
                   *(ConsistencyCheck((name,), _for_quantity(outliers.check_outliers, key), key) for key,
                     name in outliers.NAMES_OF_MOTION.items()),
                   *(ConsistencyCheck((), _for_quantity(outliers.check_roughness, key)) for key in ("v", "sigma")),
                   *FROZEN)


def find_in_run(evidence: FindingsInput) -> tuple[list[Finding], FrameOutliers | None]:
    """Returns the findings of a run against its problem, and the frame in which most particles are not where their
    neighbours are, with these. Means over particles with many outliers are not evaluated."""
    with np.errstate(all="ignore"):  # files may have any numbers, and what is made of the largest may be none
        places, axes = (position_and_interpretation.check_initial_positions(evidence),
                        position_and_interpretation.check_alternative_readings(evidence))
        beside = outliers.position_outliers(evidence)
        order, drift, size, dates, sizes = (unknown(name, "particles are not where they belong") for name in (
            position_and_interpretation.ORDER, position_and_interpretation.DRIFT, amplitude_and_pace.AMPLITUDE,
            frame_times.NAME, sizes_by_quantity.NAME))
        fitted_size, clock = amplitude_and_pace.check_amplitude_and_clock(evidence)
        if OFF not in (axes.verdict, places.verdict):
            order = position_and_interpretation.check_order(evidence)
            dates, sizes = frame_times.check_frame_times(evidence), sizes_by_quantity.check_sizes(evidence)
            size = size if order.verdict == OFF else fitted_size
        if order.verdict == HOLDS and not (beside and beside.most):
            drift = position_and_interpretation.check_mean_error(evidence)
        fewest = min(evidence.frames, key=lambda frame: len(frame.number))
        found = [body_coverage.check_body_is_covered(evidence.scene, fewest), _check_precision(evidence), places,
                 position_and_interpretation.check_initial_velocities(evidence), axes, order, drift,
                 outliers.outliers_finding("x", beside),
                 *(outliers.outliers_finding(q, outliers.value_outliers(evidence, q)) for q in ("v", "sigma")),
                 *(outliers.check_weights(evidence.frames[0], key) for key in outliers.NAMES_OF_WEIGHTS),
                 size, clock, dates, sizes,
                 time_consistency.check_velocity_time(evidence), time_consistency.check_stress_time(evidence),
                 constitutive_law.check_constitutive_law(evidence),
                 *_find_frozen_values(evidence)]
        return found, beside.most if beside else None


def _find_frozen_values(evidence: FindingsInput) -> list[Finding]:
    """Returns the findings on repeated frames and frozen values, as of a motion alone."""
    motion = frozen_values.motion_of_run(evidence)
    if motion is None:
        return [unknown(name, "not the same particles at all times") for kind in FROZEN for name in kind.names]
    found = [one for kind in FROZEN for one in kind.find_in(motion)]
    return [replace(one, verdict=OFF) if one.is_contradiction else one for one in found]


def _check_precision(evidence: FindingsInput) -> Finding:
    """Compares rounding in the file with the error of x: errors below the stored precision cannot be seen."""
    places = sample_numbers([f.position for f in evidence.frames])
    figures = detect_precision(places)
    size = max(float(rms(error["x"])) for error in evidence.errors)
    rounding = rms(figures.rounding(places)) / np.sqrt(3)  # of rounding that may be anything up to half a unit
    if rounding <= ROUNDED * size:
        return Finding(FIGURES, HOLDS, rounding, ROUNDED * size, "m", figures.words)
    return unknown(FIGURES, f"{figures.words}: the error of x is little or nothing but rounding", rounding, "m")
