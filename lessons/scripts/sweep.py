"""A sweep of your own: what happens to the error when particles begin to cross cells?

Hat functions have a kink at each node, so a particle that crosses one feels the force jump; B-splines have none. A
particle next to a node crosses it once A exceeds its distance, h/8 with four particles per cell.

Change a number and run it again, from the root of the repository:    uv run python lessons/scripts/sweep.py
"""

from matplotlib.figure import Figure

from solvers import sweep

methods = ["mpm", "bspline"]
amplitudes = [2.5e-4, 1e-3, 4e-3, 0.016, 0.064]  # A in m
cells = 40  # h = 1 m / cells, so that h/8 = 0.003 m
picture = "sweep.png"  # where the picture goes

rows = sweep("bar", method=methods, amplitude=amplitudes, cells=cells, periods=0.25, estimators=(), repeats=0,
             on_progress=lambda part, row: print(f"{100 * part:3.0f} %  {row['status']}"))
figure = Figure()
axes = figure.add_subplot(xscale="log", yscale="log", xlabel="A (m)", ylabel="largest RMS error of x over A")
for method in methods:
    relative = (rows["error.x.max"] / rows["scene.amplitude"])[rows["scene.method"] == method]
    axes.plot(amplitudes, relative, "o-", label=method)
    print(f"{method:8} largest RMS error of x over A:", "  ".join(f"{value:.2g}" for value in relative))
axes.axvline(1 / cells / 8, color="grey", label="h/8: the first crossing")
axes.legend()
figure.savefig(picture)
