"""The vibrating bar by newton, as ``listed.py`` says:  newton_bar.py PROBLEM_DIR OUT.npz"""

import importlib.metadata
import sys

import newton
import numpy as np
import warp as wp
from handout import FreeBar
from newton.solvers import SolverImplicitMPM

TOLERANCE, LINES = 1e-7, 4


def main(problem, out):
    bar = FreeBar(problem, cfl=0.05)
    h, P = bar.h, bar.particles
    wp.init()
    across = [np.tile(np.array(places) * h, P) for places in ([0.25, 0.25, 0.75, 0.75], [0.25, 0.75, 0.25, 0.75])]
    line = np.stack([np.repeat(bar.X, LINES), *across], axis=1)
    builder = newton.ModelBuilder()
    SolverImplicitMPM.register_custom_attributes(builder)
    volume = h**3 / bar.ppc / LINES
    for point, speed in zip(line, np.repeat(bar.v, LINES)):  # noqa: B905
        builder.add_particle(pos=tuple(point), vel=(speed, 0.0, 0.0), mass=bar.density * volume,
                             radius=0.5 * volume ** (1 / 3))
    model = builder.finalize(device="cpu")
    model.set_gravity((0.0, 0.0, 0.0))
    for name, value in (("young_modulus", bar.modulus), ("poisson_ratio", 0.0), ("damping", 0.0),
                        ("tensile_yield_ratio", 1.0)):
        getattr(model.mpm, name).fill_(value)
    config = SolverImplicitMPM.Config()
    config.voxel_size, config.tolerance, config.transfer_scheme, config.air_drag = h, TOLERANCE, "apic", 0.0
    config.warmstart_mode = "particles"
    solver, state, other = SolverImplicitMPM(model, config=config), model.state(), model.state()
    for step in range(bar.steps + 1):
        x, v = state.particle_q.numpy(), state.particle_qd.numpy()
        if bar.looks(step):
            bar.keep(step, x[::LINES, 0].astype(float), v[::LINES, 0])
        v[:, 0] += bar.dt * np.repeat(bar.push(step), LINES)
        state.particle_qd.assign(v)
        solver.step(state, other, None, None, bar.dt)
        state, other = other, state
    bar.finish(out, warp=wp.config.version, version=importlib.metadata.version("newton"))


if __name__ == "__main__":
    main(*sys.argv[1:])
