"""The margin of the bar's step: dt over the bound of ``solvers.scene.step_bound``, from the stencils and masses of the
last step."""

import taichi as ti

from solvers.problems.bar.method.nodes import EMPTY, fold, stencil_of


@ti.func
def step_margin(bar: ti.template()):
    """Write dt over the bound; NaN before the first step."""
    for i in range(bar.node_stiffness.shape[0]):
        bar.node_stiffness[i] = 0.0
    for p in range(bar.particles):
        _, dS = stencil_of(bar, p)
        i = bar.first_node[p]
        scaled = ti.Vector([0.0, 0.0, 0.0])  # |dS_i|/sqrt(m_i)
        for k in ti.static(range(3)):
            # The sum of S; images hold what fell on them, so look at the node.
            weight = bar.node_sums[(i + k + bar.cells - 1) % bar.cells + 1][0]
            if weight > EMPTY:
                scaled[k] = abs(dS[k]) / ti.sqrt(weight * bar.density * bar.volume)
        F = bar.deformation_gradient[p]
        stiffness = bar.modulus * F * F * bar.volume * scaled.sum()
        for k in ti.static(range(3)):
            bar.node_stiffness[i + k] += stiffness * scaled[k]
    fold(bar.node_stiffness, bar.cells)
    largest = 0.0
    for i in range(1, bar.cells + 1):
        largest = ti.max(largest, bar.node_stiffness[i])
    bar.step_margin[0] = 0.5 * bar.dt * ti.sqrt(largest) if largest > 0 else ti.math.nan
