"""The vibrating bar by Taichi's example mpm99 (MLS-MPM, quadratic B-splines), as a CSV file for the judge.

    mpm-lab problem bar --cells 20 --periods 1 --out problem
    python taichi_mpm99_bar.py problem mpm99.csv          # in any Python with taichi==1.7.4 and numpy
    mpm-lab judge bar mpm99.csv --cells 20 --periods 1 --out verdict

The example's globals are set and its substep called; nothing of it is copied. Its jelly is fixed corotated, along a bar
with Poisson's ratio 0 just E (F - 1). The bar is one line of particles with free ends at X = -1/4 m and 3/4 m, between
which it moves as the periodic one does; the body force, and what cancels gravity, go to the velocities before a step.
"""

import json
import sys
from pathlib import Path

import numpy as np
import taichi as ti
from taichi.examples.simulation import mpm99

MARGIN, SOFTER = 6, 0.3  # cells beyond each end; what the example multiplies the moduli of jelly with
GRAVITY, CFL = 50.0, 0.05


def main(problem: str, out: str) -> None:
    known = json.loads((Path(problem) / "problem.json").read_text())
    rows = [line for line in (Path(problem) / "particles.csv").read_text().splitlines() if line[0] != "#"]
    start = np.genfromtxt(rows, delimiter=",", names=True)
    turned = np.where(start["X"] > 0.75, 1.0, 0.0)  # these are judged a period of the bar further on
    X, P, h, w = start["X"] - turned, len(start), known["h"], known["angular_frequency"]
    steps = int(np.ceil(known["t_end"] * known["wave_speed"] / h / CFL))
    dt, every = known["t_end"] / steps, max(1, round(steps * known["period"] / known["t_end"] / 40))
    box = known["cells"] + 2 * MARGIN
    unit, shift = 1 / (box * h), 0.25 + MARGIN * h  # a metre in the example's box, which is 1 wide
    ti.init(arch=ti.cpu, default_fp=ti.f64, cpu_max_num_threads=1)
    mpm99.n_particles, mpm99.n_grid, mpm99.dx, mpm99.inv_dx, mpm99.dt = P, box, 1 / box, float(box), dt
    mpm99.p_vol = mpm99.p_mass = 1 / box**2 / known["ppc"]
    mpm99.mu_0, mpm99.lambda_0 = known["modulus"] / known["density"] * unit**2 / 2 / SOFTER, 0.0
    mpm99.x, mpm99.v = (ti.Vector.field(2, float, P) for _ in range(2))
    mpm99.C, mpm99.F = (ti.Matrix.field(2, 2, float, P) for _ in range(2))
    mpm99.material, mpm99.Jp = ti.field(int, P), ti.field(float, P)
    mpm99.grid_v, mpm99.grid_m = ti.Vector.field(2, float, (box, box)), ti.field(float, (box, box))
    mpm99.x.from_numpy(np.stack([(X + shift) * unit, np.full(P, 0.5)], axis=1))
    mpm99.v.from_numpy(np.stack([start["vx"] * unit, np.zeros(P)], axis=1))
    mpm99.F.from_numpy(np.tile(np.eye(2), (P, 1, 1)))
    mpm99.material.fill(1)
    mpm99.Jp.fill(1.0)
    table = []
    for step in range(steps + 1):
        v = mpm99.v.to_numpy()
        if step % every == 0 or step == steps:
            x = mpm99.x.to_numpy()[:, 0] / unit - shift + turned
            table.append([np.full(P, step * dt), start["X"], x, v[:, 0] / unit, mpm99.F.to_numpy()[:, 0, 0]])
        push = 3 * w**2 * known["amplitude"] * np.sin(2 * np.pi * X) * np.sin(w * step * dt)
        mpm99.v.from_numpy(v + dt * np.stack([push * unit, np.full(P, GRAVITY)], axis=1))
        mpm99.substep()
    np.savetxt(out, np.hstack(table).T, delimiter=",", header="t,X,x,vx,F", comments="")


if __name__ == "__main__":
    main(*sys.argv[1:])
