"""The vibrating bar by genesis-world, as ``listed.py`` says:  genesis_bar.py PROBLEM_DIR OUT.npz"""

import importlib.metadata
import sys

import genesis as gs
import numpy as np
from handout import FreeBar


def main(problem, out):
    bar = FreeBar(problem, cfl=0.05)
    P, h = bar.particles, bar.h
    gs.init(backend=gs.cpu, precision="64", logging_level="error")
    clock = gs.options.SimOptions(dt=bar.dt, substeps=1, gravity=(0.0, 0.0, 0.0))
    grid = gs.options.MPMOptions(grid_density=bar.cells, particle_size=h / bar.ppc,
                                 lower_bound=(-0.25 - 8 * h, -6 * h, -6 * h), upper_bound=(0.75 + 8 * h, 6 * h, 6 * h))
    scene = gs.Scene(sim_options=clock, mpm_options=grid, show_viewer=False)
    material = gs.materials.MPM.Elastic(E=bar.modulus, nu=0.0, rho=bar.density)
    body = scene.add_entity(material=material, morph=gs.morphs.Nowhere(n_particles=P))
    scene.build()
    along = np.array([1.0, 0.0, 0.0])
    body.set_particles_pos(np.outer(bar.X, along))
    body.set_particles_vel(np.outer(bar.v, along))
    body.set_particles_active(np.ones(P, bool))
    for step in range(bar.steps + 1):
        v = body.get_particles_vel().numpy()
        if bar.looks(step):
            bar.keep(step, body.get_particles_pos().numpy()[:, 0], v[:, 0], F=body.get_state().F[0, :, 0, 0].numpy())
        body.set_particles_vel(v + bar.dt * np.outer(bar.push(step), along))
        scene.step()
    bar.finish(out, quadrants=importlib.metadata.version("quadrants"), torch=importlib.metadata.version("torch"),
               version=importlib.metadata.version("genesis-world"))


if __name__ == "__main__":
    main(*sys.argv[1:])
