# ---
# jupyter:
#   jupytext:
#     text_representation:
#       extension: .py
#       format_name: percent
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---

# %% [markdown]
# # Grid crossing: what leaves the line, and when
#
# A notebook beside lesson 4. A bar of length 1 m vibrates; where each of its points is at each time is known,
# so that every error can be seen. In the Material Point Method particles move through a grid of cells. *Hat
# functions*, the oldest weights between particles and nodes, have a kink at each node: a particle that enters
# another cell meets it.
#
# **Before you run anything:** the bar stands at rest at first, and its particles then swing by at most A. With
# 40 cells of h = 25 mm and four particles in each, the particles next to a node are h/8 = 3.125 mm away from
# it. At which A does the error of the stress change its character? Write your guess down.

# %%
from dataclasses import replace

import matplotlib.pyplot as plt
from mpm_lab import BarScene, run, show, sweep

cells = 40
h = 1 / cells

# %% [markdown]
# ## One run, judged while it runs
#
# `run` returns a result: its table has the largest true error of each quantity and what the estimator, who does
# not know the exact solution, says of it. The index is estimated over true: 1 is perfect.

# %%
hats = BarScene(method="mpm", cells=cells, amplitude=0.0034, periods=0.25, estimators=("recovered",))
run(hats)

# %% [markdown]
# ## Look at it
#
# Hat functions, and B-splines beside them, which have no kink. What crosses a cell boundary turns magenta. Let
# it play, or drag the time: what happens at the first magenta particle?

# %%
splines = BarScene(method="bspline", cells=cells, amplitude=0.0034, periods=0.25, estimators=("recovered",))
show(hats, beside=splines, error_of="sigma")

# %% [markdown]
# ## How it depends on A
#
# The same two, from amplitudes at which nobody crosses to one at which every particle does. `sweep` measures
# every combination, and a name gives a column.

# %%
amplitudes = [0.5e-3, 1e-3, 2e-3, 2.8e-3, 3.1e-3, 3.4e-3, 4e-3, 6e-3, 10e-3]
rows = sweep("bar", method=["mpm", "bspline"], amplitude=amplitudes, cells=cells, periods=0.25, estimators=(),
             repeats=0)

figure, axes = plt.subplots(figsize=(7, 4))
for method, label in (("mpm", "hat functions"), ("bspline", "B-splines")):
    of = rows["scene.method"] == method
    crossed = of & (rows["grid_crossings"] > 0)
    relative = rows["error.sigma.max"] / rows["scene.amplitude"]
    line, = axes.loglog(rows["scene.amplitude"][of], relative[of], "-", label=label)
    axes.loglog(rows["scene.amplitude"][crossed], relative[crossed], "o", color=line.get_color())
axes.axvline(h / 8, color="grey", linestyle=":", label="A = h/8")
axes.set(xlabel="A in m", ylabel="largest RMS error of the stress over A, in Pa/m", title="dots: particles crossed")
axes.legend()
plt.show()

# %% [markdown]
# Before A = h/8 nobody crosses, and the error of both grows no faster than A itself: a test with a small
# amplitude sees nothing of the defect. Beyond it the hat functions' error jumps. Compare with your guess; and
# look at the left end of the jump: pieces of material are counted in the wrong cell a little before their
# particle's centre gets there.
#
# ## Who made it?
#
# The effect `budget` divides the error by cause, exactly: the parts add up to the error.

# %%
for scene in (hats, splines):
    made = run(replace(scene, effects=(*scene.effects, "budget"))).budget
    shares = {cause: round(share, 3) for cause, share in made["v"].items() if not isinstance(share, dict)}
    print(f"{scene.method:8} shares of the error of v: {shares}")

# %% [markdown]
# ## On your own
#
# 1. Does a finer grid cure it? Put `cells=80` and look at the same A, then at A = h/7 of the new grid.
# 2. Switch a remedy on: `BarScene(..., remedies=("pieces",))`. What is left of the crossings' share?
# 3. Take the cause away and run again: `mpm-lab budget bar --method mpm --amplitude 0.0034 --periods 0.25
#    --take-away crossings`.
