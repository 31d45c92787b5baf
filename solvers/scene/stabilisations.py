"""Registry of all remedies: stabilisations of long and large motions that a scene can request.

An effect only observes, a remedy changes the method. It is compiled in only where a scene requests it
(``solvers.scene.kernel_options``). A problem's scene lists the remedies that it supports.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Remedy:
    """Registry entry of a remedy: its name on the command line, the attribute that kernels test (``on.frozen``), its
    label, and an explanation of what it does and costs."""

    name: str
    switch: str
    label: str
    explanation: str


FILTER, COUPLED, CENTRED, FROZEN = "null-space-filter", "coupled-deformation", "zero-drift", "frozen-weights"
PIECES = "pieces"

REMEDIES: dict[str, Remedy] = {remedy.name: remedy for remedy in (
    Remedy(FILTER, "filtered", "null-space filter",
           "gradually removes the part of the particles' velocity that is invisible to the grid and never corrected"),
    Remedy(COUPLED, "coupled", "displacement-coupled F",
           "gradually draws the deformation gradient towards the gradient of the particles' displacements, so that "
           "both stay consistent"),
    Remedy(CENTRED, "centred", "zero drift",
           "removes the mean velocity after every step: with linearity preservation forces do not quite cancel, and "
           "the whole body drifts"),
    Remedy(FROZEN, "frozen", "frozen weights",
           "computes the weights once, in the undeformed body (total Lagrangian): no particle ever crosses a cell; "
           "also cheaper, but numerical fracture is impossible"),
    Remedy(PIECES, "pieces", "forces of pieces",
           "cuts the material into pieces without gaps, one for each particle, with corners halfway between "
           "neighbours; a piece in two cells acts on the nodes of both, so that nothing is counted in the wrong cell"),
)}
SWITCHES = {remedy.switch: name for name, remedy in REMEDIES.items()}
