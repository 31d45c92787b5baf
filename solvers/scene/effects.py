"""Every effect there is, known once: what a scene may ask for beside the bare method, and what it needs.

An effect is compiled in only where a scene has it (``solvers.scene.switches``), so that one that is off costs nothing.
A new one is a line here and its code, under ``ti.static("name" in on.effects)`` or, for short, ``on.name``.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Effect:
    """One effect. ``needs`` names effects of which it needs one or the other; ``needs_solution`` says that there is
    none without a built-in exact solution; ``timed_alone`` that a study can time it by itself."""

    name: str
    label: str
    explanation: str
    needs: tuple[str, ...] = ()
    needs_solution: bool = False
    timed_alone: bool = True


EFFECTS: dict[str, Effect] = {effect.name: effect for effect in (
    Effect("truth", "true error", "compare every particle with the exact solution", needs_solution=True),
    Effect("estimate", "estimate", "run the estimators that are chosen", timed_alone=False),
    Effect("crossings", "grid crossings", "count and mark particles that cross a cell boundary"),
    Effect("energy", "energy", "follow kinetic and strain energy and the work of the body force"),
    Effect("acceleration", "acceleration error", "keep each particle's acceleration, to compare and to estimate it",
           needs=("truth", "estimate")),
    Effect("soundness", "contradictions", "look for contradictions in the motion itself that show a run to be lost"),
    Effect("margin", "step margin", "compare the time step with the bound of what the present configuration bears"),
)}
#: Effects that only some problems have: a scene's ``OWN_EFFECTS`` names them.
OWN: dict[str, Effect] = {effect.name: effect for effect in (
    Effect("spin", "angular momentum", "follow the angular momentum and the torque of the body force"),
    Effect("budget", "error budget", "divide the error between its causes: crossings, the coarse grid, the body force "
           "and the time step; against the exact solution, or without it against the estimator companion",
           needs=("truth", "estimate")),
)}
ALL = {**EFFECTS, **OWN}
