"""The error budget of the bar: the part of the error by each cause.

With the weights w of a step given, at the run's own positions, a step is linear but for two products: with y = (x, v,
F) the run takes y^{n+1} = M_w y^n, and the reference, put through the same map, misses itself by M_w y0^n - y0^{n+1} =
tau. So the error of each cause c goes on by the run's own step and is fed by its part of tau,

    e_c^{n+1} = M'_w e_c^n + tau_c^n,  e_c^0 = 0,  sum_c e_c = y - y0 to round-off.

Both products, of F with the stress and of F with the gradient of the velocity, are divided by their exact product
rules, so that nothing is linearised. The four causes are the four lanes of a vector, which a processor moves at once.

``memory`` has the arrays, ``reference`` what the reference does in a step, ``sources`` what each cause does to the
nodes, ``push`` the map, with its remedies, and the norms.
"""
