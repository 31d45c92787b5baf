"""The generalized vortex by genesis-world, as ``listed.py`` says:  genesis_vortex.py PROBLEM_DIR OUT.npz"""

import importlib.metadata
import sys

import genesis as gs
import numpy as np
from handout import Vortex


def main(problem, out):
    ring = Vortex(problem, cfl=0.05)
    P, h = ring.particles, ring.h
    gs.init(backend=gs.cpu, precision="64", logging_level="error")
    clock = gs.options.SimOptions(dt=ring.dt, substeps=1, gravity=(0.0, 0.0, 0.0))
    grid = gs.options.MPMOptions(grid_density=1 / h, particle_size=h / ring.ppc, lower_bound=(-2, -2, -5 * h),
                                 upper_bound=(2, 2, 5 * h))
    scene = gs.Scene(sim_options=clock, mpm_options=grid, show_viewer=False)
    material = gs.materials.MPM.Elastic(E=ring.modulus, nu=ring.ratio, rho=ring.density, model="neohooken")
    body = scene.add_entity(material=material, morph=gs.morphs.Nowhere(n_particles=P))
    scene.build()
    layer = np.zeros((P, 1))
    body.set_particles_pos(np.hstack([ring.X, layer]))
    body.set_particles_vel(np.hstack([ring.v, layer]))
    body.set_particles_active(np.ones(P, bool))
    for step in range(ring.steps + 1):
        v = body.get_particles_vel().numpy()
        if ring.looks(step):
            ring.keep(step, x=body.get_particles_pos().numpy()[:, :2], v=v[:, :2],
                      F=body.get_state().F[0, :, :2, :2].numpy())
        body.set_particles_vel(v + ring.dt * np.hstack([ring.push(step), layer]))
        scene.step()
    ring.finish(out, quadrants=importlib.metadata.version("quadrants"), torch=importlib.metadata.version("torch"),
                version=importlib.metadata.version("genesis-world"))


if __name__ == "__main__":
    main(*sys.argv[1:])
