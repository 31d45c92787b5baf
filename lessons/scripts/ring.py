"""The expanding ring: how wrong is the run, and how wrong does an estimator say it is?

    rho0 u_tt = div P + rho0 b,    P = E/2 (F - F^-T),    F = 1 + grad u,    0.4 m <= R <= 0.6 m, no traction
    b is made such that exactly    u = A sin(w t) s(R) e_R,    w = pi sqrt(E/rho0) / 1 m,
    where s is the cubic with s(0) = 0, s(0.6 m) = 1 and no slope at both surfaces

Change a number and run it again, from the root of the repository:    uv run python lessons/scripts/ring.py
"""

from app.commands.run.text_summary import run_table
from app.pictures.run_errors import save_png
from solvers import RingScene, run

method = "cpdi"  # shape functions: mpm (hat functions), ugimp, cpgimp or cpdi
cells = 24  # cells along a side of the grid: h = 1.2 m / cells
ppc = 2  # particles per cell and direction
amplitude = 0.1  # A in m, below 0.386: there the exact ring turns inside out
modulus = 1e7  # E in Pa; Poisson's ratio is 0
density = 1000.0  # rho0 in kg/m3
cfl = 0.05  # time step dt = cfl h / c, c = sqrt(E/rho0)
periods = 1.0  # end of the run, in periods 2 pi / w
body_force = "material"  # "none" or "two-tone" have no exact solution: there the estimate stands alone
layout = "polar"  # where the particles begin; "cartesian": on the grid, with a staircase for a surface
estimator = "companion"  # who judges the run: transport, recovered, companion or two-grid
picture = "ring.png"  # where the picture goes

scene = RingScene(method=method, cells=cells, ppc=ppc, amplitude=amplitude, modulus=modulus, density=density, cfl=cfl,
                  periods=periods, body_force=body_force, layout=layout, estimators=(estimator,))
result = run(scene)
print(run_table(result.to_dict()))  # true errors, estimates, index (estimate over truth) and what the run cost
save_png(result, picture)
