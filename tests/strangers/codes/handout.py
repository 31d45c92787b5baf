"""What ``mpm-lab problem`` wrote, as the strangers' scripts need it; and the file that ``mpm-lab judge`` reads.

For environments with nothing of the lab in them: numpy alone, and any Python since 3.8.
"""

import json
from pathlib import Path

import numpy as np


class Handout:
    """Numbers of problem.json, columns of particles.csv (``start``), and the formulas of problem.md."""

    def __init__(self, folder, cfl):
        self.numbers = json.loads((Path(folder) / "problem.json").read_text())
        lines = (Path(folder) / "particles.csv").read_text().splitlines()
        self.start = np.genfromtxt([line for line in lines if not line.startswith("#")], delimiter=",", names=True)
        self.cells, self.h, self.ppc = self.numbers["cells"], self.numbers["h"], self.numbers["ppc"]
        self.modulus, self.density = self.numbers["modulus"], self.numbers["density"]
        self.amplitude, self.omega = self.numbers["amplitude"], self.numbers["angular_frequency"]
        self.particles = len(self.start)
        self.steps = int(np.ceil(self.numbers["t_end"] * self.numbers["wave_speed"] / self.h / cfl))
        self.dt = self.numbers["t_end"] / self.steps
        self.every = max(1, round(self.numbers["period"] / 40 / self.dt))
        self.kept = []

    def looks(self, step):
        """Whether this step is one of some forty a period, or the last, whose particles are kept."""
        return step % self.every == 0 or step == self.steps

    def keep(self, step, **columns):
        """Note x, v, and F or sigma of the particles, in SI units, before this step."""
        self.kept.append({"t": step * self.dt, **{name: np.array(values, float) for name, values in columns.items()}})

    def write(self, out, X, **about):
        """The particles kept, with material positions X (P, D), to a .npz; ``about`` is printed for the table."""
        columns = {name: np.array([one[name] for one in self.kept]) for name in self.kept[0]}
        np.savez(out, X=X, cells=self.cells, **columns)
        print(json.dumps({"cells": self.cells, "dt": self.dt, "steps": self.steps, **about}))


class FreeBar(Handout):
    """The bar with free ends at X = -1/4 and 3/4, between which it moves as the periodic one does."""

    def __init__(self, folder, cfl):
        super().__init__(folder, cfl)
        self.turned = np.where(self.start["X"] > 0.75, 1.0, 0.0)  # these are judged a period of the bar further on
        self.X, self.v = self.start["X"] - self.turned, self.start["vx"]

    def push(self, step):
        """The body force per mass along the bar before this step, m/s2."""
        amplitude = 3 * self.omega**2 * self.amplitude
        return amplitude * np.sin(2 * np.pi * self.X) * np.sin(self.omega * step * self.dt)

    def keep(self, step, x, v, **columns):
        super().keep(step, x=(x + self.turned)[:, None], v=v[:, None],
                     **{name: values[:, None, None] for name, values in columns.items()})

    def finish(self, out, **about):
        self.write(out, self.start["X"][:, None], **about)


class Vortex(Handout):
    """The generalized vortex: a full ring in plane strain, with nothing held."""

    def __init__(self, folder, cfl):
        super().__init__(folder, cfl)
        self.X = np.stack([self.start["X"], self.start["Y"]], axis=1)
        self.v = np.stack([self.start["vx"], self.start["vy"]], axis=1)
        self.ratio = self.numbers["poisson_ratio"]
        self.shear = self.modulus / (2 * (1 + self.ratio))
        self.first_lame = self.modulus * self.ratio / ((1 + self.ratio) * (1 - 2 * self.ratio))

    def push(self, step):
        """The body force per mass before this step, (P, 2) in m/s2."""
        R, w, t = np.hypot(*self.X.T), self.omega, step * self.dt
        r, soft = R - 1, self.shear / self.density
        shape, slope, bend = 1 - 32 * r**2 + 256 * r**4, -64 * r + 1024 * r**3, -64 + 3072 * r**2
        now, rate = self.amplitude * np.sin(w * t), self.amplitude * w * np.cos(w * t)
        along = -R * (rate * shape) ** 2 + soft * R * (now * slope) ** 2
        across = -R * w * w * now * shape - soft * now * (3 * slope + R * bend)
        angle = np.arctan2(self.X[:, 1], self.X[:, 0]) + now * shape
        c, s = np.cos(angle), np.sin(angle)
        return np.stack([along * c - across * s, along * s + across * c], axis=1)

    def finish(self, out, **about):
        self.write(out, self.X, **about)
