"""The companion on the processor beside particles that are on a GPU: solved by itself, and read at their samples."""

import contextlib
import copy
from collections.abc import Mapping

import numpy as np

from solvers.estimators.companion import MOST_INTERVAL, NOW
from solvers.estimators.standalone import ElasticBody, Lost, NystromIntegrator

KEPT = 8  # instants to which it can go back, as for timings, which take some steps again and again; and the start


class BesideGpu:
    """A ``body`` whose nodes are those of the ``memory`` of a companion, and steps of ``dt`` seconds."""

    def __init__(self, body: ElasticBody, memory: Mapping[str, np.ndarray], dt: float):
        self._body, self._nodes, self._dt = body, memory["companion_nodes"], dt
        self._kept = [NystromIntegrator(body, MOST_INTERVAL * dt)]

    def bring_to(self, step: int) -> None:
        """Fill the layer ``NOW`` of ``companion_nodes``: u and v after so many steps, and a one step before; not a
        number where the companion itself is lost."""
        integrator = self._at(max(0, step - 1))
        a = integrator.a
        if step:
            integrator = self._at(step)
        N = len(integrator.u)
        self._nodes[NOW * N:(NOW + 1) * N, :6] = np.concatenate([integrator.u, integrator.v, a], axis=1)

    def _at(self, step: int) -> NystromIntegrator:
        """The body after so many steps, from the last instant before that it knows."""
        time = step * self._dt
        while self._kept[-1].time > time:
            self._kept.pop()
        integrator = copy.copy(self._kept[-1])
        with np.errstate(all="ignore"), contextlib.suppress(Lost):
            integrator.to(time)
        self._kept.append(integrator)
        if len(self._kept) > KEPT:
            del self._kept[1]
        return integrator
