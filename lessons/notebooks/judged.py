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
# # Another code, judged
#
# Your code has run the vibrating bar. How wrong is it, of which order, and is everything in the file what it
# says it is? Here the code is a toy of a dozen lines: central differences in space, leapfrog in time, for
#
# $$u_{tt} = c^2 u_{XX} + 3 w^2 A \sin(2\pi X) \sin(w t), \qquad c = 2\ \mathrm{m/s},\quad w = \pi c / 1\ \mathrm{m},$$
#
# on 0 ≤ X ≤ 1 m, periodic.
#
# The judge takes arrays, or files (.csv, .npz, .vtk, .vtu, .vtp) by their names. What a code needs to set the
# problem up, `mpm-lab problem bar --out DIR` writes.

# %%
import matplotlib.pyplot as plt
import numpy as np
from mpm_lab import BarScene, judge, show

A, c = 0.025, 2.0  # m, m/s
w = np.pi * c


def differences(n, times):
    """Places and velocities of n points at some times: the particles of the toy code."""
    X = (np.arange(n) + 0.5) / n
    shape, u, dt = np.sin(2 * np.pi * X), np.zeros(n), 0.5 / (c * n)
    half = A * w * shape  # the velocity half a step on; at t = 0 there is no force, so it is that of the start
    kept, step = [], 0
    for time in times:
        while step < round(time / dt):
            if step:
                bend = (np.roll(u, 1) - 2 * u + np.roll(u, -1)) * n**2
                half = half + dt * (c**2 * bend + 3 * w**2 * A * shape * np.sin(w * step * dt))
            u, step = u + dt * half, step + 1
        kept.append(X + u)
    return {"X": X, "x": np.array(kept), "t": times, "cells": n}


grids = [20, 40, 80]
times = 0.025 * np.arange(1, 9)  # s
verdict = judge(BarScene(amplitude=A), [differences(n, times) for n in grids])

# %% [markdown]
# ## How wrong, and of which order

# %%
report = verdict.to_dict()
for grid in report["grids"]:
    true, estimated = grid["error"]["x"]["max"], grid["estimate"]["companion"]["x"]["max"]
    print(f"{grid['cells']} points: RMS error of x {true:.3g} m; "
          f"by the companion, who does not know the solution, {estimated:.3g} m")
order = report["order"]["x"]["order"]
print(f"order of x: {order:.2f}")
assert 1.8 < order < 2.2  # central differences are of second order; in a test of your own code this line is the test

# %% [markdown]
# ## What else was compared
#
# A small error is not all: is the whole body there, are all moments what they say, does the stress keep to its
# law? Each line says what was compared, and what came of it; what these files do not hold cannot be told.

# %%
for check in report["grids"][-1]["checks"]:
    print(f"{check['verdict']:14} {check['check']}: {check['says']}")

# %% [markdown]
# ## A file that lies
#
# The clock of the last grid runs a twentieth too fast. Its error is large, and the judge says what would
# explain it:

# %%
late = differences(80, times)
late["t"] = 1.05 * late["t"]
for check in judge(BarScene(amplitude=A), late).to_dict()["grids"][0]["checks"]:
    if check["verdict"] not in ("holds", "cannot be told"):
        print(f"{check['verdict']:14} {check['check']}: {check['says']}")

# %% [markdown]
# ## The Material Point Method on the same problem
#
# Beside it, B-splines on 40 cells: the same error, coloured on the particles, live. What does your own code
# look like? On the page (`mpm-lab`) a file of its particles is dropped onto the stage and plays there.

# %%
show(BarScene(method="bspline", cells=40, amplitude=A, periods=0.2))

# %%
figure, axes = plt.subplots(figsize=(6, 4))
h = [1 / n for n in grids]
errors = [grid["error"]["x"]["max"] for grid in report["grids"]]
axes.loglog(h, errors, "o-", label=f"differences: order {order:.2f}")
axes.loglog(h, [errors[0] * (one / h[0]) ** 2 for one in h], ":", color="grey", label="order 2")
axes.set(xlabel="h in m", ylabel="largest RMS error of x in m")
axes.legend()
plt.show()
