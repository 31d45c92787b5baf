"""The vibrating bar by taichi-elements, as ``listed.py`` says:  taichi_elements_bar.py PROBLEM_DIR OUT.npz"""

import importlib.metadata
import os
import sys

import numpy as np
import taichi as ti
from handout import FreeBar

ti.sqr = lambda x: x * x
from taichi_elements.mpm_solver import MPMSolver

MARGIN, SOFTER = 6, 0.3  # cells beyond each end; what the code multiplies the moduli of its elastic material with


def main(problem, out):
    bar = FreeBar(problem, cfl=0.05)
    P, h = bar.particles, bar.h
    box, shift = bar.cells + 2 * MARGIN, 0.25 + MARGIN * h
    ti.init(arch=ti.cpu, cpu_max_num_threads=1)
    given = ti.Vector.field(2, ti.f32, shape=P)
    asked = ti.Vector.field(3, ti.f32, shape=P)
    code = MPMSolver(res=(box, box), size=box * h, max_num_particles=8192)
    code.set_gravity((0.0, 0.0))
    code.default_dt = 1.0  # one step at a time
    code.p_vol, code.p_mass = h * h / bar.ppc, h * h / bar.ppc * bar.density
    code.mu_0, code.lambda_0 = bar.modulus / 2 / SOFTER, 0.0

    @ti.kernel
    def seed():
        for p in range(P):
            code.seed_particle(p, given[p], code.material_elastic, 0, ti.Vector([0.0, 0.0]))
            code.C[p] = ti.Matrix.zero(ti.f32, 2, 2)

    @ti.kernel
    def push():
        for p in range(P):
            code.v[p] += given[p]

    @ti.kernel
    def look():
        for p in range(P):
            asked[p] = ti.Vector([code.x[p][0], code.v[p][0], code.F[p][0, 0]])

    def give(along, across):
        given.from_numpy(np.stack([along, np.full(P, across)], axis=1).astype(np.float32))

    give(bar.X + shift, box * h / 2)
    seed()
    give(bar.v, 0.0)
    push()
    for step in range(bar.steps + 1):
        if bar.looks(step):
            look()
            x, v, F = asked.to_numpy().T
            bar.keep(step, x.astype(float) - shift, v, F=F)
        give(bar.dt * bar.push(step), 0.0)
        push()
        code.step(bar.dt)
    bar.finish(out, version=importlib.metadata.version("taichi-elements"), taichi=ti.core.get_version_string())


if __name__ == "__main__":
    main(os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2]))
