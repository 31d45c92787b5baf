"""newton (PyPI) runs the vibrating bar with its implicit MPM; its particles go to a file for ``mpm-lab judge bar``.

Needs a Python with newton in it, which is not ours:  python newton_bar.py PROBLEM_DIR OUT.npz

PROBLEM_DIR is what ``mpm-lab problem bar`` wrote. The code is three-dimensional, in single precision, implicit in
time. It has no periodic grid and needs no walls here: u_X is zero at X = -1/4 and 3/4, so that a bar with free ends
there moves as the periodic one does. Its cross-section is a cell with 2 x 2 lines of particles, Poisson's ratio 0.
Its body force is gravity alone: that of the problem is given to the particles' velocities before each step.
"""

import importlib.metadata
import json
import sys
from pathlib import Path

import newton
import numpy as np
import warp as wp
from newton.solvers import SolverImplicitMPM

CFL = 0.05
TOLERANCE = 1e-7


def main(problem: Path, out: Path) -> None:
    wp.init()
    numbers = json.loads((problem / "problem.json").read_text())
    N, h, ppc, period = numbers["cells"], numbers["h"], numbers["ppc"], numbers["period"]
    A, w = numbers["amplitude"], numbers["angular_frequency"]
    X = (np.arange(N * ppc) + 0.5) * h / ppc - 0.25
    line = np.stack([np.repeat(X, 4), np.tile([0.25, 0.25, 0.75, 0.75], N * ppc) * h,
                     np.tile([0.25, 0.75, 0.25, 0.75], N * ppc) * h], axis=1)
    wave = np.sin(2 * np.pi * line[:, 0])
    builder = newton.ModelBuilder()
    SolverImplicitMPM.register_custom_attributes(builder)
    mass, radius = numbers["density"] * h * h * h / ppc / 4, 0.5 * (h * h * h / ppc / 4) ** (1 / 3)
    for point, speed in zip(line, A * w * wave, strict=True):
        builder.add_particle(pos=tuple(point), vel=(speed, 0.0, 0.0), mass=mass, radius=radius)
    model = builder.finalize(device="cpu")
    model.set_gravity((0.0, 0.0, 0.0))
    for name, value in (("young_modulus", numbers["modulus"]), ("poisson_ratio", 0.0), ("damping", 0.0),
                        ("tensile_yield_ratio", 1.0)):
        getattr(model.mpm, name).fill_(value)
    config = SolverImplicitMPM.Config()
    config.voxel_size, config.tolerance, config.transfer_scheme, config.air_drag = h, TOLERANCE, "apic", 0.0
    config.warmstart_mode = "particles"
    solver, state, other = SolverImplicitMPM(model, config=config), model.state(), model.state()
    dt = CFL * h / numbers["wave_speed"]
    steps = round(numbers["periods"] * period / dt)
    every, kept = max(1, round(period / 40 / dt)), []
    for step in range(steps + 1):
        if step % every == 0 or step == steps:
            kept.append((step * dt, state.particle_q.numpy()[:, :1].copy(), state.particle_qd.numpy()[:, :1].copy()))
        v = state.particle_qd.numpy()
        v[:, 0] += dt * 3 * w * w * A * wave * np.sin(w * step * dt)
        state.particle_qd.assign(v)
        solver.step(state, other, None, None, dt)
        state, other = other, state
    t, x, v = (np.array(values, float) for values in zip(*kept, strict=True))
    turned = (line[:, 0] < 0)[:, None]  # the same particles a period of the bar further on
    # Four lines of particles move alike; one of them is judged, for each material point is there once.
    np.savez(out, t=t, x=(x + turned)[:, ::4], v=v[:, ::4], X=(line[:, :1] + turned)[::4], cells=N)
    print(json.dumps({"code": "newton", "version": importlib.metadata.version("newton"), "warp": wp.config.version,
                      "cells": N, "dt": dt, "steps": steps}))


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
