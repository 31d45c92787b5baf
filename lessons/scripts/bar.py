"""The vibrating bar: how wrong is the run, and how wrong does an estimator say it is?

    rho0 u_tt = P_X + rho0 b,    P = E (F - 1),    F = 1 + u_X,    0 <= X <= 1 m, periodic
    b = 3 w^2 u,    w = pi sqrt(E/rho0) / 1 m,    so that exactly    u = A sin(2 pi X) sin(w t)

Change a number and run it again, from the root of the repository:    uv run python lessons/scripts/bar.py
"""

from app.commands.run.text_summary import run_table
from app.pictures.run_errors import save_png
from solvers import BarScene, run

method = "ugimp"  # shape functions: mpm (hat functions), ugimp, cpgimp or bspline
cells = 40  # the grid has cells of h = 1 m / cells
ppc = 4  # particles per cell
amplitude = 0.025  # A in m, below 0.159: there the exact bar turns inside out
modulus = 4.0  # E in Pa
density = 1.0  # rho0 in kg/m3
cfl = 0.05  # time step dt = cfl h / c, c = sqrt(E/rho0)
periods = 2.0  # end of the run, in periods 2 pi / w
body_force = "material"  # b at material points; "node": at the nodes of the grid; "none": a free vibration
linearity_preserving = False  # True: transfers between particles and grid are exact for linear fields
estimator = "companion"  # who judges the run: transport, recovered, companion or two-grid
picture = "bar.png"  # where the picture goes

scene = BarScene(method=method, cells=cells, ppc=ppc, amplitude=amplitude, modulus=modulus, density=density, cfl=cfl,
                 periods=periods, body_force=body_force, linearity_preserving=linearity_preserving,
                 estimators=(estimator,))
result = run(scene)
print(run_table(result.to_dict()))  # true errors, estimates, index (estimate over truth) and what the run cost
save_png(result, picture)
