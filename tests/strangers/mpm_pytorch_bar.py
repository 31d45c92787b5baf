"""mpm-pytorch (PyPI) runs the vibrating bar; its particles go to a file that ``mpm-lab judge bar`` reads.

Needs a Python with mpm-pytorch in it, which is not ours:  python mpm_pytorch_bar.py PROBLEM_DIR OUT.npz

PROBLEM_DIR is what ``mpm-lab problem bar`` wrote. The code is three-dimensional in a unit box, with quadratic
B-splines and APIC transfers. A line of particles along x is the bar: the weights across it are factors that cancel in
the velocity. It takes a stress and hooks from its user, so that the problem's own law, its body force at material
points, and walls that mirror the velocity (a hook on the grid) are what it would be given by whoever uses it for this.
"""

import importlib.metadata
import json
import sys
from pathlib import Path

import numpy as np
import torch
from mpm_pytorch import MPMSolver

MARGIN = 4  # cells beyond each wall: the box of the code is longer than the bar
CFL = 0.05


def main(problem: Path, out: Path) -> None:
    torch.set_default_dtype(torch.float64)  # the code leaves it to its user
    torch.set_num_threads(1)
    numbers = json.loads((problem / "problem.json").read_text())
    lines = [line for line in (problem / "particles.csv").read_text().splitlines() if not line.startswith("#")]
    names = lines[0].split(",")
    rows = np.loadtxt(lines[1:], delimiter=",")
    X, v0 = rows[:, names.index("X")], rows[:, names.index("vx")]
    N, P, h = numbers["cells"], len(X), numbers["h"]
    box = N + 2 * MARGIN  # cells of the code's box, which is 1 wide: a metre is 1/(box h) of it
    unit = 1 / (box * h)
    E, A, w = numbers["modulus"] * unit**2, numbers["amplitude"] * unit, numbers["angular_frequency"]  # density 1
    dt = CFL * h / numbers["wave_speed"]
    period = numbers["period"]
    steps = round(numbers["periods"] * period / dt)
    every = max(1, round(period / 40 / dt))
    x = torch.full((P, 3), 0.5)
    x[:, 0] = torch.tensor((X + MARGIN * h) * unit)
    v, C, F = torch.zeros(P, 3), torch.zeros(P, 3, 3), torch.eye(3).repeat(P, 1, 1)
    v[:, 0] = torch.tensor(v0 * unit)
    solver = MPMSolver(x.clone(), rho=1.0, num_grids=box, dt=dt, gravity=[0.0, 0.0, 0.0], clip_bound=0.5, device="cpu",
                       size=[N / box, 1 / box, 1 / box])
    wave = torch.tensor(np.sin(2 * np.pi * X))

    def push(model, x, v):
        """b = 3 w^2 A sin(2 pi X) sin(wt) of each material point, as the impulse of a step."""
        v[:, 0] += model.dt * 3 * w * w * A * wave * np.sin(w * model.time)

    def mirror(model):
        """Walls at both ends: a node and its image beyond the wall move alike and against each other."""
        mass = model.grid_m.reshape(box, -1)
        velocity = model.grid_mv.reshape(box, -1, 3)
        velocity[:, :, 1:] = 0.0
        for wall, inward in ((MARGIN, 1), (box - MARGIN, -1)):
            velocity[wall, :, 0] = 0.0
            for k in (1, 2):
                inside, image = wall + inward * k, wall - inward * k
                m = mass[inside] + mass[image]
                p = mass[inside] * velocity[inside, :, 0] - mass[image] * velocity[image, :, 0]
                velocity[inside, :, 0] = torch.where(m > 0, p / torch.where(m > 0, m, 1.0), 0.0)
                velocity[image, :, 0] = -velocity[inside, :, 0]

    solver.pre_particle_process.append(push)
    solver.post_grid_process.append(mirror)
    kept = []
    for step in range(steps + 1):
        if step % every == 0 or step == steps:
            kept.append((step * dt, x[:, 0].numpy() / unit - MARGIN * h, v[:, 0].numpy() / unit,
                         F[:, 0, 0].numpy().copy()))
        stress = torch.zeros(P, 3, 3)  # Kirchhoff's, which the code spreads by the volume at rest: J sigma, J = F
        stress[:, 0, 0] = E * (F[:, 0, 0] - 1) * F[:, 0, 0]
        x, v, C, F = solver(x, v, C, F, stress)
    t, position, velocity, stretch = (np.array(values) for values in zip(*kept, strict=True))
    np.savez(out, t=t, x=position[:, :, None], v=velocity[:, :, None], F=stretch[:, :, None, None], X=X,
             id=np.arange(P), cells=N)
    print(json.dumps({"code": "mpm-pytorch", "version": importlib.metadata.version("mpm-pytorch"),
                      "torch": torch.__version__, "cells": N, "dt": dt, "steps": steps}))


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
