"""Every remedy there is, known once: what a scene may call for against the diseases of long and large motions.

Where an effect only looks, a remedy changes the method. It is compiled in only where a scene calls for it
(``solvers.scene.kernel_options``). A problem names in its scene those that hold there.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Remedy:
    """One remedy: its name as typed, the word by which kernels ask for it (``on.frozen``), what it is called, and what
    it does and costs."""

    name: str
    switch: str
    label: str
    explanation: str


FILTER, COUPLED, CENTRED, FROZEN = "null-space-filter", "coupled-deformation", "zero-drift", "frozen-weights"
PIECES = "pieces"

REMEDIES: dict[str, Remedy] = {remedy.name: remedy for remedy in (
    Remedy(FILTER, "filtered", "null-space filter",
           "takes out of the particles' velocity, at a rate, what the grid cannot see and so never corrects"),
    Remedy(COUPLED, "coupled", "displacement-coupled F",
           "draws the deformation gradient, at a rate, towards that of the particles' own displacements, so that the "
           "two cannot part"),
    Remedy(CENTRED, "centred", "zero drift",
           "takes the mean velocity out after every step: linearity preservation makes forces that do not quite "
           "cancel, and the whole body wanders off"),
    Remedy(FROZEN, "frozen", "frozen weights",
           "computes the weights once, where the material was at rest (total Lagrangian): no particle ever crosses a "
           "cell; cheaper too, but numerical fracture is impossible"),
    Remedy(PIECES, "pieces", "forces of pieces",
           "cuts the material into pieces without gaps, a particle each, with corners half way between neighbours; a "
           "piece that lies in two cells pulls at the nodes of both, so that nobody is counted in the wrong cell"),
)}
SWITCHES = {remedy.switch: name for name, remedy in REMEDIES.items()}
