"""The motion that the balance of momentum makes of the bar (see ``solvers.scene.balance``).

P = E(F - 1) is linear, so that the modes sin(2 pi X) and sin(4 pi X), which start and body force feed, swing each for
itself: q'' = -(n w0)^2 q + b_n(t), w0 = 2 pi c, n = 1 and 2. With w the frequency of the force,

    b_1 = 3 w^2 A sin(wt):  q_1 = A sin(wt), or A/2 sin(2wt) without force (both start at the velocity A w);
    b_2 = S sin(nu t), the second tone:  q_2 = S/((2 w0)^2 - nu^2) (sin(nu t) - nu/(2 w0) sin(2 w0 t)).

All other modes rest, and so does a patch test, seen from where it should be. A force that a method puts at its nodes is
meant for the material points too.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from solvers.scene.balance import Moments

SECOND_SIZE = 0.5  # of the force's second tone, of the first
SECOND_FREQUENCY = 1.7  # of the second tone, over that of the first


def moments(scene: Any, times: np.ndarray) -> Moments:
    """The moments (see ``solvers.problems.bar.method.soundness``) of the exact modes at the times (T,)."""
    P, w, A = scene.particles, scene.angular_frequency, scene.motion_amplitude
    X = (np.arange(P) + 0.5) / P
    shapes = np.sin(2 * np.pi * np.outer((1, 2), X))  # (2, P)
    size = np.zeros((len(times), 2))
    if not scene.is_patch:
        size[:, 0] = A * np.sin(w * times)
    if scene.body_force == "two-tone":
        own, tone = 4 * math.pi * scene.wave_speed, SECOND_FREQUENCY * w
        force = SECOND_SIZE * 3 * w * w * scene.amplitude
        size[:, 1] = force / (own * own - tone * tone) * (np.sin(tone * times) - tone / own * np.sin(own * times))
    gram = shapes @ shapes.T
    return Moments(size @ gram, np.einsum("tm,mn,tn->t", size, gram, size), np.linalg.pinv(gram, hermitian=True), P,
                   np.ones(len(times), bool))
