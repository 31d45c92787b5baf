"""How kernels fill the columns of effects: a loop over those of a scene that is unrolled when a kernel is compiled."""

import taichi as ti


@ti.func
def sample_effects(state: ti.template(), row, step, samplers: ti.template(), on: ti.template()):
    """What each effect has found, by ``solvers.scene.effects.samplers``."""
    for e in ti.static(range(len(on.effects))):
        if ti.static(on.effects[e] in samplers):
            samplers[on.effects[e]](state, row, step, on)
