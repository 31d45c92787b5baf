"""Contradictions within the motion of particles, as an object and as JSON."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from solvers.judging.findings.all_findings import INSIDE_OUT, MOTION_FINDINGS
from solvers.judging.findings.finding import BROKEN, SUSPICIOUS, UNKNOWN, Finding, unknown
from solvers.judging.findings.prestress import count_from_first_moment
from solvers.judging.findings.recorded_motion_reader import RecordedMotion, read_motion
from solvers.judging.moment_joining import join_moments
from solvers.judging.particle_data_types import unread_columns
from solvers.judging.particle_readers import Particles, as_list, check_one_table_each, read_all
from solvers.untrusted.quoting import FileError

SCHEMA = "mpm-lab/check/1"
CONSISTENT = "consistent"
UNKNOWN_ROWS = "nothing says which particles the rows are"
Progress = Callable[[float, str], None]
#: What cannot be seen in a motion alone, whatever the files contain.
NOT_CHECKABLE = ("whether the motion is that of your problem: forces, material and boundary are not known here",
                 "the balance of energy and of momentum with the forces: body forces and walls may do any work",
                 "the order of accuracy, and how large the error is: `mpm-lab judge` measures them on a problem whose "
                 "solution is known")


@dataclass(frozen=True)
class MotionCheckResult:
    """A ``motion`` read from ``files`` with its findings, in the order of the report, and the columns ``not_read``."""

    files: tuple[str, ...]
    motion: RecordedMotion
    findings: list[Finding]
    not_read: tuple[str, ...]

    @property
    def verdict(self) -> str:
        verdicts = {finding.verdict for finding in self.findings}
        return next((one for one in (BROKEN, SUSPICIOUS) if one in verdicts), CONSISTENT)

    @property
    def contradictions(self) -> list[Finding]:
        """Findings that contradict the motion, with those of the verdict "broken" first."""
        return sorted((one for one in self.findings if one.is_contradiction), key=lambda one: one.verdict != BROKEN)

    def to_dict(self) -> dict[str, Any]:
        motion = self.motion
        return {"schema": SCHEMA, "verdict": self.verdict, "files": list(self.files), "particles": len(motion.number),
                "dimensions": motion.dimensions, "times": motion.times.tolist(),
                "quantities": [key for key in ("x", "v", "F", "sigma", "mass", "volume") if key in motion.fields],
                "reference": "the first moment" if motion.from_start else "X", "notes": motion.notes,
                "not_read": list(self.not_read),
                "spacing": None if np.isnan(motion.spacing) else motion.spacing, "motion": motion.amplitude,
                "findings": [one.to_dict() for one in self.findings], "contradictions": len(self.contradictions),
                "not_told": [f"{one.name}: {one.says}" for one in self.findings if one.verdict == UNKNOWN],
                "never_told": list(NOT_CHECKABLE)}


def check(files: Particles | Sequence[Particles], *, times: Sequence[float] = (),
          on_progress: Progress = lambda part, what: None) -> MotionCheckResult:
    """Looks for contradictions within the motion of particles, of any code and problem, without a solution.

    ``files`` is a path (text, .npz or one of VTK's), a mapping from names to arrays, or several of these, of one run.
    Arrays are those of :func:`solvers.judge`; ``x`` at two or more times is needed, ``X`` or ``id``, ``v``, ``F``,
    ``sigma``, ``mass`` and ``volume`` are used where they exist. ``times`` has the time of each file in s, where files
    do not contain it; ``on_progress`` is called now and then with the part done (0 to 1) and the present stage's name.

    The result's ``to_dict()`` is the object of ``mpm-lab check --json``; an empty result proves nothing. Raises
    :class:`FileError` for files, or arrays, whose particles cannot be followed.
    """
    raws = read_all(files)
    not_read = unread_columns(raws)
    check_one_table_each(as_list(files), raws, times)
    if times and len(times) != len(raws):
        raise FileError(raws[0].file, f"is one of {len(raws)} files, and there are {len(times)} times; give one time "
                                      "for each")
    on_progress(0.1, "following the particles")
    with np.errstate(all="ignore"):  # files may have any numbers, and what is made of the largest may be none
        parts, _, times = join_moments(raws, (), times)
        motion, findings = read_motion(parts, times)
        findings += INSIDE_OUT.find_in(motion)
        part = count_from_first_moment(motion.representative_part)
        lost = part.doubt_about_rows(not_read)
        for k, kind in enumerate(MOTION_FINDINGS):
            on_progress(0.2 + 0.8 * k / len(MOTION_FINDINGS), "looking for contradictions")
            findings += [unknown(name, lost if k == 0 else UNKNOWN_ROWS) for name in kind.names] if lost else \
                kind.find_in(part)
        if len(part.number) < len(motion.number):
            motion.notes.append(f"{len(part.number):,} of the {len(motion.number):,} particles, in boxes spread over "
                                "the body, were held against their neighbours")
        else:
            motion = part
    return MotionCheckResult(tuple(dict.fromkeys(raw.file for raw in raws)), motion, findings, not_read)
