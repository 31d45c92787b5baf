"""The vibrating bar by geotaichi, as ``listed.py`` says:  geotaichi_bar.py PROBLEM_DIR OUT.npz"""

import importlib.metadata
import os
import sys
import tempfile

import numpy as np
import taichi as ti
from handout import FreeBar

ti.init(arch=ti.cpu, cpu_max_num_threads=1, default_fp=ti.f64, offline_cache=False)
from src.mpm.mainMPM import MPM

MARGIN, LINES = 4, 4  # cells beyond each end; lines of particles along the bar


def main(problem, out):
    bar = FreeBar(problem, cfl=0.05)
    h, P = bar.h, bar.particles
    shift = 0.25 / h + MARGIN  # lengths are in cells, whose corners it finds by rounding
    os.chdir(tempfile.mkdtemp())
    lab = MPM(log=False)
    lab.set_configuration(log=False, domain=[bar.cells + 2 * MARGIN, 6, 6], gravity=[0.0, 0.0, 0.0],
                          shape_function="GIMP")
    lab.set_solver({"Timestep": bar.dt, "SimulationTime": (bar.steps - 0.5) * bar.dt, "SaveInterval": 1e9}, log=False)
    lab.memory_allocate({"max_material_number": 2, "max_particle_number": P * LINES}, log=False)
    lab.add_material("LinearElastic", {"MaterialID": 1, "Density": bar.density, "YoungModulus": bar.modulus / h**2,
                                       "PossionRatio": 0.0})
    lab.add_element({"ElementType": "R8N3D", "ElementSize": [1.0, 1.0, 1.0]})
    lab.add_region({"Name": "bar", "Type": "Rectangle", "BoundingBoxPoint": ti.Vector([MARGIN, 2.0, 2.0]),
                    "BoundingBoxSize": ti.Vector([bar.cells, 1.0, 1.0])})
    lab.add_body({"Template": {"RegionName": "bar", "nParticlesPerCell": 2, "BodyID": 0, "MaterialID": 1}})
    points, step, along = lab.scene.particle, 0, np.array([1.0, 0.0, 0.0])
    places = points.x.to_numpy()
    rows = np.lexsort((places[:, 2].round(9), places[:, 1].round(9), places[:, 0].round(9)))  # LINES of each X together
    order = np.argsort(bar.X)
    assert abs(places[rows, 0] - shift - np.repeat(bar.X[order] / h, LINES)).max() < 1e-9, "not the handout's particles"

    def spread(values):
        """A value of each of the handout's particles, along the bar, at all lines of particles."""
        every = np.zeros((P * LINES, 3))
        every[rows] = np.outer(np.repeat(values[order], LINES), along)
        return every

    def line(field):
        """The first component at one line of particles, in the handout's order."""
        values = np.empty(P)
        values[order] = field.to_numpy()[rows[::LINES], 0]
        return values

    def look_and_push():
        nonlocal step
        if bar.looks(step):
            bar.keep(step, h * (line(points.x) - shift), h * line(points.v), sigma=h**2 * line(points.stress))
        points.v.from_numpy(points.v.to_numpy() + bar.dt * spread(bar.push(step) / h))
        step += 1

    points.v.from_numpy(spread(bar.v / h))
    look_and_push()
    lab.run(function=look_and_push)
    bar.finish(out, version=importlib.metadata.version("geotaichi"))


if __name__ == "__main__":
    main(os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2]))
