"""The error budget of the bar: the part of the error by each cause.

With the weights w of a step given, at the run's own positions, a step is linear except for two products: with
y = (x, v, F) the run takes y^{n+1} = M_w y^n, and the reference under the same map has the defect M_w y0^n - y0^{n+1} =
tau. So the error of each cause c is propagated by the run's own step, with its part of tau as source,

    e_c^{n+1} = M'_w e_c^n + tau_c^n,  e_c^0 = 0,  sum_c e_c = y - y0 to round-off.

Both products, of F with the stress and of F with the gradient of the velocity, are divided by their exact product
rules, so that nothing is linearised. The four causes are the four lanes of a vector, which a CPU handles at once.

``budget_arrays`` has the memory, ``reference`` the reference in a step, ``error_sources`` the causes' sources at the
nodes, ``error_propagation`` the map, with its remedies, and the norms.
"""
