"""The error budget of a plane body, on demand: the share of each cause in the error of a run.

The run is stepped one step at a time by the usual solver, and beside it, in numpy, goes the error of each cause. With
the weights w of a step given, at the run's own positions, the run takes y^{n+1} = M_w y^n, y = (x, v, F), and the exact
solution put through the same map misses itself by M_w y0^n - y0^{n+1} = tau. So, for each cause c,

    e_c^{n+1} = M'_w e_c^n + tau_c^n,  sum_c e_c = y - y0 to round-off.

M_w has two products, of F in the stress and of F with the gradient of the velocity. Both are divided by exact product
rules, so that nothing is linearised.

A problem gives its exact solution at a time (``exact_state``); all else is the same for each: ``solvers.problems.
planar.weights`` has the maps of a step, ``body_pieces`` the parts of the body that particles stand for,
``cause_errors`` what each cause does in a step and how its errors go on, ``on_demand_budget`` steps and samples.
"""
