"""The generalized vortex by genesis-world (MLS-MPM, quadratic B-splines), as VTU files for the judge.

    mpm-lab problem vortex --cells 24 --ppc 2 --layout cartesian --poisson-ratio 0 --amplitude 0.25 --out problem
    python genesis_vortex.py problem vortex    # with genesis-world==1.4.5, torch==2.15.0 and meshio; says the times
    mpm-lab judge vortex vortex-*.vtu --time TIMES --cells 24 --ppc 2 --layout cartesian --poisson-ratio 0 \
        --amplitude 0.25 --out verdict

Its `neohooken` elasticity is the problem's law; all its particles have one volume, hence the Cartesian layout, and with
Poisson's ratio 0 one layer of them is plane strain. The body force goes to the velocities before each step.
"""

import json
import sys
from pathlib import Path

import genesis as gs
import meshio
import numpy as np

CFL = 0.05


def body_force(X: np.ndarray, t: float, known: dict) -> np.ndarray:
    """Returns the force per mass (P, 2) in m/s2 at X (P, 2) in m and t in s, from the formulas in problem.md."""
    R, w, soft = np.hypot(*X.T), known["angular_frequency"], known["modulus"] / 2 / known["density"]
    r = R - 1
    shape, slope, bend = 1 - 32 * r**2 + 256 * r**4, -64 * r + 1024 * r**3, -64 + 3072 * r**2
    now, rate = known["amplitude"] * np.sin(w * t), known["amplitude"] * w * np.cos(w * t)
    along = -R * (rate * shape) ** 2 + soft * R * (now * slope) ** 2
    across = -R * w * w * now * shape - soft * now * (3 * slope + R * bend)
    angle = np.arctan2(X[:, 1], X[:, 0]) + now * shape
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([along * c - across * s, along * s + across * c], axis=1)


def main(problem: str, out: str) -> None:
    known = json.loads((Path(problem) / "problem.json").read_text())
    rows = [line for line in (Path(problem) / "particles.csv").read_text().splitlines() if line[0] != "#"]
    start = np.genfromtxt(rows, delimiter=",", names=True)
    X, P, h = np.stack([start["X"], start["Y"]], axis=1), len(start), known["h"]
    steps = int(np.ceil(known["t_end"] * known["wave_speed"] / h / CFL))
    dt, every = known["t_end"] / steps, max(1, round(steps * known["period"] / known["t_end"] / 40))
    gs.init(backend=gs.cpu, precision="64", logging_level="error")
    clock = gs.options.SimOptions(dt=dt, substeps=1, gravity=(0.0, 0.0, 0.0))
    grid = gs.options.MPMOptions(grid_density=1 / h, particle_size=h / known["ppc"], lower_bound=(-2, -2, -5 * h),
                                 upper_bound=(2, 2, 5 * h))
    scene = gs.Scene(sim_options=clock, mpm_options=grid, show_viewer=False)
    material = gs.materials.MPM.Elastic(E=known["modulus"], nu=0.0, rho=known["density"], model="neohooken")
    body = scene.add_entity(material=material, morph=gs.morphs.Nowhere(n_particles=P))
    scene.build()
    layer, times = np.zeros((P, 1)), []
    body.set_particles_pos(np.hstack([X, layer]))
    body.set_particles_vel(np.hstack([start["vx"][:, None], start["vy"][:, None], layer]))
    body.set_particles_active(np.ones(P, bool))
    for step in range(steps + 1):
        v = body.get_particles_vel().numpy()
        if step % every == 0 or step == steps:
            F = body.get_state().F[0, :, :2, :2].numpy()
            data = {"X": np.hstack([X, layer]), "v": v, "F": F.reshape(P, 4)}
            cells = [("vertex", np.arange(P)[:, None])]
            meshio.Mesh(body.get_particles_pos().numpy(), cells, data).write(f"{out}-{len(times):04d}.vtu")
            times.append(step * dt)
        body.set_particles_vel(v + dt * np.hstack([body_force(X, step * dt, known), layer]))
        scene.step()
    print(*times)


if __name__ == "__main__":
    main(*sys.argv[1:])
