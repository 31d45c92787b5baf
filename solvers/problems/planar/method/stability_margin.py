"""The margin of the step: dt over the bound of ``solvers.scene.step_bound``, from the weights of the last step."""

import taichi as ti

from solvers.kernels import runtime
from solvers.problems.planar.method import cpdi
from solvers.problems.planar.method.material_laws import volume_and_stiffness_metric
from solvers.problems.planar.method.stored_weights import stored_weight_entries, stored_weight_entry


@ti.func
def store_step_margin(body: ti.template(), traits: ti.template(), on: ti.template()):
    """Writes dt over the stable step to ``step_margin``, or NaN before the first step. On a GPU it must be called from
    a kernel itself: particles run in parallel there, so that nodes cannot store values of one, which are recomputed."""
    for node in range(body.nodes):
        body.node_scratch[node] = ti.Vector([0.0, 0.0, 0.0, 0.0])
    if ti.static(on.method == "cpdi" and runtime.runs_on_cpu()):
        add_corner_gershgorin_sums(body, traits, on)
    else:
        for p in range(body.particles):
            stiffness, metric = volume_and_stiffness_metric(body, p, on)
            total = 0.0
            for k in range(ti.static(16 if on.method == "cpdi" else 9)):
                node, gradient = node_gradient(body, p, k, on)
                total += scaled_gradient_norm(body, traits, metric, gradient, node)
            for k in range(ti.static(16 if on.method == "cpdi" else 9)):
                node, gradient = node_gradient(body, p, k, on)
                circle = stiffness * total * scaled_gradient_norm(body, traits, metric, gradient, node)
                ti.atomic_add(body.node_scratch[traits.image(body, node)][3], circle)
    largest = 0.0
    for node in range(body.nodes):
        ti.atomic_max(largest, body.node_scratch[node][3])
    body.step_margin[0] = 0.5 * body.dt * ti.sqrt(largest) if largest > 0 else ti.math.nan


@ti.func
def add_corner_gershgorin_sums(body: ti.template(), traits: ti.template(), on: ti.template()):
    """Adds Gershgorin's sums of all nodes to ``node_scratch`` for CPDI on a CPU, where a search for corners that share
    a node would take several times as long.

    A node's record: grad S of the present particle (two numbers), |grad S|/sqrt(m), Gershgorin's sum. Loops are not
    unrolled: they run seldom, and would take longer to compile.
    """
    for p in range(body.particles):
        total, g = 0.0, cpdi.corner_gradients(body, p, on)
        for k in range(16):
            node, a = corner_stencil_node(body, p, k, on), 2 * (k // 4 % 2)
            gradient = corner_stencil_hat(body, p, k, on) * ti.Vector([g[a], g[a + 1], 0.0, 0.0])
            body.node_scratch[node] = body.node_scratch[node] + gradient
        stiffness, metric = volume_and_stiffness_metric(body, p, on)
        for k in range(16):
            total += scale_gradient(body, traits, metric, corner_stencil_node(body, p, k, on))
        stiffness *= total
        for k in range(16):
            add_gershgorin_sum(body, traits, corner_stencil_node(body, p, k, on), stiffness)


@ti.func
def scale_gradient(body: ti.template(), traits: ti.template(), metric, node):
    """Returns |grad S|/sqrt(m), in ``metric`` (xx, xy, yy), of the present particle at a node, and stores it there in
    place of the gradient, so that a second corner at the same node gets 0."""
    record = body.node_scratch[node]
    scaled = scaled_gradient_norm(body, traits, metric, ti.Vector([record[0], record[1]]), node)
    if scaled > 0:
        body.node_scratch[node] = ti.Vector([0.0, 0.0, scaled, record[3]])
    return scaled


@ti.func
def scaled_gradient_norm(body: ti.template(), traits: ti.template(), metric, gradient, node):
    """Returns |grad S|/sqrt(m) of a ``gradient`` (x, y) in a ``metric`` (xx, xy, yy) at a node; 0 without mass."""
    along, across = gradient[0] * gradient[0], gradient[1] * gradient[1]
    size = ti.sqrt(ti.max(0.0, metric[0] * along + metric[2] * across + 2 * metric[1] * gradient[0] * gradient[1]))
    mass = body.node_mass[traits.image(body, node)]
    scaled = 0.0
    if size > 0 and mass > 0:
        scaled = size / ti.sqrt(mass)
    return scaled


@ti.func
def add_gershgorin_sum(body: ti.template(), traits: ti.template(), node, stiffness):
    """Adds ``stiffness`` times the present particle's |grad S|/sqrt(m) to Gershgorin's sum of a node, once."""
    scaled = body.node_scratch[node][2]
    body.node_scratch[node][2] = 0.0
    body.node_scratch[traits.image(body, node)][3] += stiffness * scaled


@ti.func
def node_gradient(body: ti.template(), p, k, on: ti.template()):
    """Returns particle p's k-th node and the gradient (x, y) of its weight there, per m; for CPDI, where several
    corners may share a node, the whole gradient at its first occurrence and zero at others."""
    node, gradient = 0, ti.Vector([0.0, 0.0])
    if ti.static(on.method == "cpdi"):
        g = cpdi.corner_gradients(body, p, on)
        node = corner_stencil_node(body, p, k, on)
        for other in range(16):
            if corner_stencil_node(body, p, other, on) == node:
                pair = ti.Vector([g[0], g[1]]) if other // 4 % 2 == 0 else ti.Vector([g[2], g[3]])
                gradient += corner_stencil_hat(body, p, other, on) * pair
        for other in range(k):
            if corner_stencil_node(body, p, other, on) == node:
                gradient = ti.Vector([0.0, 0.0])
    else:
        w, = ti.static([stored_weight_entries(body, p, on)])
        i, j = k % 3, k // 3
        S, dS = three_node_weight(i, w[0], w[2]), three_node_slope(i, w[4], w[6])
        R, dR = three_node_weight(j, w[1], w[3]), three_node_slope(j, w[5], w[7])
        node, gradient = body.first_node[p] + j * body.row + i, ti.Vector([dS * R, S * dR])
    return node, gradient


@ti.func
def corner_stencil_node(body: ti.template(), p, k, on: ti.template()):
    """Returns the k-th of the sixteen nodes of the corners' cells of CPDI particle p."""
    return ti.cast(stored_weight_entry(body, p, cpdi.NODES + k // 4, on), ti.i32) + (k % 4 // 2) * body.row + k % 2


@ti.func
def corner_stencil_hat(body: ti.template(), p, k, on: ti.template()):
    """Returns the hat function at :func:`corner_stencil_node` number k, with the sign of the corner's gradient."""
    c = k // 4
    x, y = stored_weight_entry(body, p, c, on), stored_weight_entry(body, p, c + 4, on)
    return (x if k % 2 == 1 else 1 - x) * (y if k % 4 // 2 == 1 else 1 - y) * (1.0 if c < 2 else -1.0)


@ti.func
def three_node_weight(i, left, right):
    """Returns weight i (0 to 2) of three that sum to 1, given the outer two."""
    return left if i == 0 else (right if i == 2 else 1 - left - right)


@ti.func
def three_node_slope(i, left, right):
    """Returns slope i (0 to 2) of three that sum to 0, given the outer two."""
    return left if i == 0 else (right if i == 2 else -left - right)
