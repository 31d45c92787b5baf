"""The vibrating bar by mpm-pytorch, as ``listed.py`` says:  mpm_pytorch_bar.py PROBLEM_DIR OUT.npz"""

import importlib.metadata
import sys

import torch
from handout import FreeBar
from mpm_pytorch import MPMSolver

MARGIN = 5  # cells beyond each end, to the walls of the code's box


def main(problem, out):
    torch.set_default_dtype(torch.float64)  # the code leaves it to its user
    torch.set_num_threads(1)
    bar = FreeBar(problem, cfl=0.05)
    P, box = bar.particles, bar.cells + 2 * MARGIN
    unit, shift = 1 / (box * bar.h), 0.25 + MARGIN * bar.h  # a metre in the code's box, which is 1 wide
    x, v, C, F = torch.full((P, 3), 0.5), torch.zeros(P, 3), torch.zeros(P, 3, 3), torch.eye(3).repeat(P, 1, 1)
    x[:, 0], v[:, 0] = torch.tensor((bar.X + shift) * unit), torch.tensor(bar.v * unit)
    code = MPMSolver(x.clone(), rho=bar.density, num_grids=box, dt=bar.dt, gravity=[0.0, 0.0, 0.0], clip_bound=0.5,
                     device="cpu", size=[bar.cells / box, 1 / box, 1 / box])
    step = 0

    def push(model, x, v):
        v[:, 0] += bar.dt * unit * torch.tensor(bar.push(step))

    code.pre_particle_process.append(push)
    for step in range(bar.steps + 1):
        if bar.looks(step):
            bar.keep(step, x[:, 0].numpy() / unit - shift, v[:, 0].numpy() / unit, F=F[:, 0, 0].numpy())
        stress = torch.zeros(P, 3, 3)  # Kirchhoff's, which the code spreads by the volume at rest: J sigma, J = F
        stress[:, 0, 0] = bar.modulus * unit**2 * (F[:, 0, 0] - 1) * F[:, 0, 0]
        x, v, C, F = code(x, v, C, F, stress)
    bar.finish(out, torch=torch.__version__, version=importlib.metadata.version("mpm-pytorch"))


if __name__ == "__main__":
    main(*sys.argv[1:])
