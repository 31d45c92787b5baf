"""Values that stay the same to the last bit where the body moves: a frame written twice, and F or the stress of
particles that is no longer updated, or written. Arithmetic changes the last bits of whatever goes on.

Positions say by how much: over an interval the mean velocity moves particles, and the gradient of x changes F by as
much and the stress in proportion, by the ratio that most particles have.
"""

import numpy as np

from solvers.judging.findings.deformation import neighbour_gradients
from solvers.judging.findings.finding import BROKEN, HOLDS, SUSPICIOUS, Finding, unknown
from solvers.judging.findings.findings_input import FindingsInput
from solvers.judging.findings.recorded_motion_reader import ROUNDED, RecordedMotion
from solvers.judging.findings.time_series_fitting import rms
from solvers.translatable_message import Message

REPEATED = "every moment is another one"
NAMES = {"F": "F changes where the body deforms", "sigma": "the stress changes where the body deforms"}
SURE = 3.0  # times the RMS by which neighbours miss the changes of particles that do change
TOO_FEW = "too few particles have neighbours, or nothing deforms"


def motion_of_run(evidence: FindingsInput) -> RecordedMotion | None:
    """Returns the trajectories of a run as a motion; None where particles differ between frames."""
    tracks = evidence.tracks
    if tracks is None:
        return None
    fields = {key: tracks.own[name] for key, name in (("x", "x"), ("v", "v"), ("F", "F"), ("sigma", "stress"))
              if name in tracks.own}
    return RecordedMotion(tracks.time, tracks.number, tracks.material_position, False, fields)


def check_repeated(motion: RecordedMotion) -> Finding:
    """Checks that no two moments one after the other have the same positions while v moves the particles, or while they
    move the same way before and after."""
    moves = np.diff(motion.x, axis=0)
    for k in np.flatnonzero(~moves.any(axis=(1, 2))).tolist():
        if "v" in motion.fields:
            way = 0.5 * (motion.fields["v"][k] + motion.fields["v"][k + 1]) * (motion.times[k + 1] - motion.times[k])
        else:
            before, after = moves[max(0, k - 1)], moves[min(len(moves) - 1, k + 1)]
            way = before if np.sum(before * after) > 0 else np.zeros_like(before)
        if rms(way) > motion.rounding:
            return Finding(REPEATED, BROKEN, 0.0, motion.rounding, "m",
                           Message("the positions at t = {first:.4g} and {second:.4g} s are the same to the last bit, "
                                   "though the particles move by {way:.2g} m meanwhile: one moment was written twice",
                                   motion.times[k], motion.times[k + 1], rms(way)), time=float(motion.times[k + 1]))
    return Finding(REPEATED, HOLDS)


def check_frozen(motion: RecordedMotion, key: str) -> Finding:
    """Checks that F or the stress, by its ``key``, of no particle stays the same where the gradient of x changes."""
    values, name = motion.fields[key], NAMES[key]
    if motion.neighbourhood is None or not motion.spacing > 0:
        return unknown(name, TOO_FEW)
    same = (values[1:] == values[:-1]).all(axis=(2, 3)) & values[1:].any(axis=(2, 3))  # without stress it may stay so
    least = ROUNDED * motion.stored_rounding[key]
    frozen = np.zeros_like(same)
    for k in np.flatnonzero(same.any(axis=1) & ~same.all(axis=1)).tolist():
        before, after = (neighbour_gradients(motion, motion.x[moment]) for moment in (k, k + 1))
        deformed = np.linalg.norm(after - before, axis=(1, 2))
        changed = np.linalg.norm(values[k + 1] - values[k], axis=(1, 2))[~same[k]]
        usual = float(np.median(deformed[~same[k]]))
        expected = deformed * np.median(changed) / max(usual, 1e-300)
        missed = SURE * rms((changed - expected[~same[k]])[:, None])  # where neighbours are too far apart to say more
        # with hats F of a whole cell stays where the velocity is largest: there x deforms less than elsewhere
        tells = (expected > max(least, missed)) & (deformed > max(usual, motion.rounding / motion.spacing))
        frozen[k] = same[k] & tells
    if not frozen.any():
        return Finding(name, HOLDS)
    who = np.flatnonzero(frozen.any(axis=0))
    p = int(who[np.argmax(frozen[:, who].sum(axis=0))])
    k = int(np.argmax(frozen[:, p]))
    stays = np.flatnonzero(~frozen[k:, p])
    last = k + (int(stays[0]) if len(stays) else len(frozen) - k)
    what = Message("F") if key == "F" else Message("the stress")
    return Finding(name, SUSPICIOUS, float(len(who)), 0.0, "particles",
                   Message("{what} of {count:,} of {every:,} particles stays the same to the last bit while the body "
                           "deforms there, that of particle {number} from t = {first:.4g} to {last:.4g} s: it is not "
                           "updated, or not written", what, len(who), len(motion.number), int(motion.number[p]),
                           motion.times[k], motion.times[last]), **motion.finding_location(k, p))
