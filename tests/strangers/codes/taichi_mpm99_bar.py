"""The vibrating bar by taichi's example mpm99, as ``listed.py`` says:  taichi_mpm99_bar.py PROBLEM_DIR OUT.npz"""

import importlib.metadata
import sys

import numpy as np
import taichi as ti
from handout import FreeBar
from taichi.examples.simulation import mpm99

MARGIN, SOFTER = 6, 0.3  # cells beyond each end; what the example multiplies the moduli of jelly with
GRAVITY = 50.0


def main(problem, out):
    bar = FreeBar(problem, cfl=0.05)
    P, box = bar.particles, bar.cells + 2 * MARGIN
    unit, shift = 1 / (box * bar.h), 0.25 + MARGIN * bar.h  # a metre in the example's box, which is 1 wide
    ti.init(arch=ti.cpu, default_fp=ti.f64, cpu_max_num_threads=1)
    mpm99.n_particles, mpm99.n_grid, mpm99.dx, mpm99.inv_dx, mpm99.dt = P, box, 1 / box, float(box), bar.dt
    mpm99.p_vol = mpm99.p_mass = 1 / box**2 / bar.ppc
    mpm99.mu_0, mpm99.lambda_0 = bar.modulus / bar.density * unit**2 / 2 / SOFTER, 0.0
    mpm99.x, mpm99.v = (ti.Vector.field(2, float, P) for _ in range(2))
    mpm99.C, mpm99.F = (ti.Matrix.field(2, 2, float, P) for _ in range(2))
    mpm99.material, mpm99.Jp = ti.field(int, P), ti.field(float, P)
    mpm99.grid_v, mpm99.grid_m = ti.Vector.field(2, float, (box, box)), ti.field(float, (box, box))
    mpm99.x.from_numpy(np.stack([(bar.X + shift) * unit, np.full(P, 0.5)], axis=1))
    mpm99.v.from_numpy(np.stack([bar.v * unit, np.zeros(P)], axis=1))
    mpm99.F.from_numpy(np.tile(np.eye(2), (P, 1, 1)))
    mpm99.material.fill(1)
    mpm99.Jp.fill(1.0)
    for step in range(bar.steps + 1):
        v = mpm99.v.to_numpy()
        if bar.looks(step):
            bar.keep(step, mpm99.x.to_numpy()[:, 0] / unit - shift, v[:, 0] / unit, F=mpm99.F.to_numpy()[:, 0, 0])
        mpm99.v.from_numpy(v + bar.dt * np.stack([bar.push(step) * unit, np.full(P, GRAVITY)], axis=1))
        mpm99.substep()
    bar.finish(out, version=importlib.metadata.version("taichi"))


if __name__ == "__main__":
    main(*sys.argv[1:])
