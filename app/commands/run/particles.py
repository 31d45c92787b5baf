"""The particles of a run, kept at every sample and written in the form that ``mpm-lab judge`` reads."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from app.commands.flags import BadInput
from app.commands.output import Target
from solvers.scene.scene import Scene

if TYPE_CHECKING:
    from solvers.judging.frames import Frame
    from solvers.solver.result import Snapshot

KINDS = (".npz", ".csv")
MOST_ROWS = 20_000_000  # of particles and times, which is what the judge reads at most


class ParticleWriter:
    """What ``--particles`` asks for; the file is tried now."""

    def __init__(self, text: str, scene: Scene):
        if Path(text).suffix.lower() not in KINDS:
            raise BadInput("particles", text, f"give a file that ends in {' or '.join(KINDS)}")
        rows = scene.particles * (scene.steps // scene.sample_interval + 2)
        if rows > MOST_ROWS:
            raise BadInput("particles", text, f"would hold {rows:,} particles of all samples; at most {MOST_ROWS:,} "
                                              "are allowed: sample more rarely with --sample-every")
        self._target, self._scene = Target("particles", text), scene
        self._frames: list[Frame] = []

    def keep(self, shot: Snapshot) -> None:
        """Keep a sample; one of a run gone bad, with what is no number, is left out."""
        from solvers.judging.ours import framed
        frame = framed(shot, self._scene)
        if all(np.isfinite(v).all() for v in (shot.position, shot.velocity, shot.deformation_gradient)):
            self._frames.append(frame)

    def write(self) -> None:
        from solvers.judging import writing
        if self._target.path.lower().endswith(".npz"):
            content = writing.npz(self._frames, self._scene)
        else:
            said = {"problem": self._scene.problem, "cells": self._scene.cells}
            content = writing.csv(writing.table(self._frames), said)
        self._target.write(content)
