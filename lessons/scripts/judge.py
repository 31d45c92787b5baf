"""Another code's particles, judged: twenty lines of finite differences that know nothing of this repository.

    u_tt = c^2 u_XX + 3 w^2 A sin(2 pi X) sin(w t),    0 <= X <= 1 m, periodic,    c = 2 m/s,    w = pi c / 1 m

Central differences are of order 2: the judge, who knows the exact solution, should find just that.

Change a number and run it again, from the root of the repository:    uv run python lessons/scripts/judge.py
"""

import numpy as np

from solvers import BarScene, judge

A, c, end = 0.025, 2.0, 0.2  # m, m/s, s
w, grids, files = np.pi * c, (20, 40, 80), []
for n in grids:
    X = (np.arange(n) + 0.5) / n
    dt = end / round(end * c * n / 0.5)  # half of what is stable
    shape, u, v = np.sin(2 * np.pi * X), np.zeros(n), A * w * np.sin(2 * np.pi * X)
    for step in range(round(end / dt)):
        bend = (np.roll(u, 1) - 2 * u + np.roll(u, -1)) * n**2
        v = v + dt * (c**2 * bend + 3 * w**2 * A * shape * np.sin(w * step * dt)) * (0.5 if step == 0 else 1.0)
        u = u + dt * v  # v is that of the middle of the step
    files.append(f"differences-{n}.csv")
    np.savetxt(files[-1], np.column_stack([X, X + u]), delimiter=",", header=f"# t = {end}\nX,x", comments="")

verdict = judge(BarScene(amplitude=A), files, cells=grids).to_dict()
for grid in verdict["grids"]:
    print(f"{grid['cells']} points: RMS error of x {grid['error']['x']['max']:.3g} m, "
          f"by the companion, who does not know the solution, {grid['estimate']['companion']['x']['max']:.3g} m")
order = verdict["order"]["x"]
print("order of x:", order["reason"] or f"{order['order']:.2f}")
