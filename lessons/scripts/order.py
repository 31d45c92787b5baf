"""Order of accuracy: by how much does the error fall when the cells are halved?

An error that goes as h^p falls 2^p times, so p = log2(error on 2h / error on h). B-splines at a small amplitude, where
no particle crosses a cell, are of order 2.

Change a number and run it again, from the root of the repository:    uv run python lessons/scripts/order.py
"""

import math

from solvers import BarScene, run

method = "bspline"  # mpm (hat functions), ugimp, cpgimp or bspline
amplitude = 2.5e-4  # A in m; try 0.025, where hat functions and GIMP lose their order
grids = (20, 40, 80)  # cells of h = 1 m / cells

before = None
print("cells  largest RMS error of x (m)  order")
for cells in grids:
    result = run(BarScene(method=method, cells=cells, amplitude=amplitude, periods=1, estimators=()))
    h, error = 1 / cells, result.error["x"]["max"]
    order = math.log(before[1] / error) / math.log(before[0] / h) if before else math.nan
    before = h, error
    print(f"{cells:5}  {error:26.3g}  {order:5.2f}")
