"""Remedies: how long does a run stay right, with and without what mends it?

Large motions feed velocities that the grid cannot see, and F drifts away from the particles' own displacements, until
the motion is lost. A filter, a coupling of F and transfers that are exact for linear fields keep it.

Change a number and run it again, from the root of the repository:    uv run python lessons/scripts/remedies.py
"""

from solvers import BarScene, run

amplitude = 0.025  # A in m
cells, cfl = 40, 0.1  # h = 1 m / cells, time step dt = cfl h / c
periods = 5.0  # the longest life that is looked for
treatments = {"plain": {}, "mended": {"linearity_preserving": True,
                                      "remedies": ("null-space-filter", "coupled-deformation")}}

for name, treatment in treatments.items():
    result = run(BarScene(method="mpm", cells=cells, amplitude=amplitude, cfl=cfl, periods=periods, estimators=(),
                          **treatment))
    life = result.life["accurate"]  # periods until the error of x exceeds A/10; None: it never does
    print(f"{name}: {f'right for {life:.2g} periods' if life else f'right for all {periods:g} periods'}, largest RMS "
          f"error of x {result.error['x']['max'] / amplitude:.2g} A")
