"""An estimator of your own: hat functions miss a curved u by about h^2/8 u_XX, so let that be the estimated error of x.

It is registered before anything runs, works inside the solver's kernels, and sees the particles but never the exact
solution. Its index, estimate over truth, says how good it is: right in order if it stays the same when h is halved.

Change it and run it again, from the root of the repository:    uv run python lessons/scripts/own_estimator.py
"""

import taichi as ti

from solvers import BarScene, run
from solvers.scene.estimator_hooks import EstimatorHooks
from solvers.scene.estimator_registry import Estimator, register


@ti.func
def displacement(bar: ti.template(), p):
    q = p % bar.particles  # the bar is periodic, its particles are in the order of X
    return bar.position[q] - bar.material_position[q]


@ti.func
def report(bar: ti.template(), base, step, on: ti.template()):
    for p in range(bar.particles):  # they are volume / 1 m2 apart
        bend = displacement(bar, p - 1) - 2 * displacement(bar, p) + displacement(bar, p + 1)
        error_of_x = bar.spacing**2 / 8 * bend / bar.volume**2
        bar.estimate[base + p] = ti.Vector([error_of_x, 0.0, 0.0, 0.0])  # and nothing of v, sigma and a


register(Estimator("bend", "takes the interpolation error of hat functions", colour="#606060", hooks={
    "bar": EstimatorHooks(memory={}, allocate=lambda scene: {}, interval=lambda scene: 1, report=report)}))

for cells in (20, 40, 80):
    scene = BarScene(method="mpm", cells=cells, amplitude=1e-5, periods=0.5, estimators=("bend",))
    print(f"{cells} cells: index of bend in x {run(scene).index['bend']['x']:.2f}")
