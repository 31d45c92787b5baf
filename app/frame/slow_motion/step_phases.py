"""The phases of a step in slow motion: titles, equations in words, and the solver's numbers for each."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from app.language.translation import lazy, tr
from app.names_and_units import PREFIXES
from solvers.scene.scene import Scene
from solvers.scene.stabilisations import PIECES
from solvers.solver.particle_step_breakdown import ParticleStepBreakdown

#: Explanation of a node's weight, by method.
WEIGHT = {"mpm": lazy("weight S = the node's hat function at the particle"),
          "bspline": lazy("weight S = the node's quadratic B-spline at the particle"),
          "cpdi": lazy("weight S = the node's hat function, mean of the particle's four corners")}
AVERAGED = lazy("weight S = the node's hat function, averaged over the particle's domain")
#: The equations of some phases, by settings.
FORCE = {
    "none": lazy("force of a node = − sum of slope × {volume} × stress of the particles{corrected}; no body force"),
    "node": lazy("force of a node = − sum of slope × {volume} × stress of the particles{corrected} + body force at "
                 "the node, × its mass"),
    "": lazy("force of a node = − sum of slope × {volume} × stress of the particles{corrected} + sum of weight × body "
             "force")}
FORCE_OF_PIECES = {
    "none": lazy("force of a node = sum over the corners between pieces of its function there × jump of the "
                 "stress{corrected}; no body force"),
    "node": lazy("force of a node = sum over the corners between pieces of its function there × jump of the "
                 "stress{corrected} + body force at the node, × its mass"),
    "": lazy("force of a node = sum over the corners between pieces of its function there × jump of the "
             "stress{corrected} + sum of weight × body force")}
MOTION = {
    "particle": lazy("the particle's v grows by time step × sum of weight × a of the nodes, x by time step × its "
                     "new v"),
    "corners": lazy("the particle's v grows by time step × sum of weight × a of the nodes, x by time step × the "
                    "nodes' new v at the ends of its domain (mean)"),
    "": lazy("the particle's v grows by time step × sum of weight × a of the nodes, x by time step × sum of weight × "
             "new v of the nodes")}


@dataclass(frozen=True)
class NodalQuantity:
    """Quantity of the n nodes around a particle: its translatable ``name``, a function that returns its ``values``
    (n,) or (n, D) from a step's breakdown, and the ``unit`` of these values times ``scale``."""

    name: str
    unit: str
    values: Callable[[ParticleStepBreakdown], np.ndarray]
    scale: float = 1.0


WEIGHTS = NodalQuantity(lazy("weight S"), "", lambda a: a.links.weight[0])
SLOPES = NodalQuantity(lazy("slope of S"), "1/m", lambda a: a.links.slope[0])
MASS = NodalQuantity(lazy("mass"), "g", lambda a: a.node_mass, 1000.0)
MOMENTUM = NodalQuantity(lazy("momentum"), "N s", lambda a: a.momentum)
INTERNAL = NodalQuantity(lazy("force of stress"), "N", lambda a: a.internal_force)
BODY = NodalQuantity(lazy("body force"), "N", lambda a: a.body_force)
OLD = NodalQuantity(lazy("old v"), "m/s", lambda a: a.before_velocity)
NEW = NodalQuantity(lazy("new v"), "m/s", lambda a: a.velocity)
ACCELERATION = NodalQuantity(lazy("acceleration a"), "m/s²", lambda a: a.acceleration)


@dataclass(frozen=True)
class Phase:
    """One phase of a step: a translatable ``title``; ``words`` returns its equation in words for a scene; ``columns``
    are the nodes' quantities, of which the first ``drawn`` are written beside the nodes; ``front`` returns lines of
    text about the selected particle for a scene and a step's breakdown."""

    title: str
    words: Callable[[Scene], str]
    columns: tuple[NodalQuantity, ...]
    drawn: int
    front: Callable[[Scene, ParticleStepBreakdown], list[str]]


def _force_equation(scene: Scene) -> str:
    forces = FORCE_OF_PIECES if PIECES in scene.remedies else FORCE
    words = forces.get(scene.body_force, forces[""])
    corrected = tr(", corrected to be exact for linear stress") if scene.linearity_preserving else ""
    return tr(words, volume=tr("volume at rest") if scene.frozen else tr("volume"), corrected=corrected)


def _stress_equation(scene: Scene) -> str:
    if PIECES in scene.remedies:
        return tr("F grows by time step × difference of the nodes' new v at the corners of the piece / its length × F; "
                  "stress follows from the new F")
    if scene.frozen:
        return tr("F grows by time step × sum of slope × new v of the nodes; stress follows from the new F")
    return tr("F grows by time step × sum of slope × new v of the nodes × F; stress follows from the new F")


def _state_lines(_: Scene, a: ParticleStepBreakdown) -> list[str]:
    here = a.before
    return [f"x = {format_amount(here.position[0], 'm')}, v = {format_amount(here.velocity[0], 'm/s')}",
            tr("mass {mass}, stress {stress}", mass=format_amount(1000 * a.mass[:1], "g"),
               stress=_format_tensor(here.stress[0]))]


def _to_nodes_lines(_: Scene, a: ParticleStepBreakdown) -> list[str]:
    momentum = a.mass[0] * a.before.velocity[0]
    return [tr("each node gets its weight × mass {mass}, and × momentum {momentum}",
               mass=format_amount(1000 * a.mass[:1], "g"), momentum=format_amount(momentum, "N s"))]


def _force_lines(scene: Scene, a: ParticleStepBreakdown) -> list[str]:
    if PIECES in scene.remedies:
        return [tr("stress {stress}, the same in the whole piece", stress=_format_tensor(a.before.stress[0]))]
    if scene.frozen:
        return [tr("volume × stress at rest {tension}", tension=_format_tensor(a.tension[0], "N m", True)),
                tr("the weights stay those of the particle at rest")]
    return [tr("volume × stress {tension}", tension=_format_tensor(a.tension[0], "N m"))]


def _to_particles_lines(_: Scene, a: ParticleStepBreakdown) -> list[str]:
    before, after = a.before, a.after
    lines = [f"v = {format_change(before.velocity[0], after.velocity[0], 'm/s')}",
             f"x = {format_change(before.position[0], after.position[0], 'm')}"]
    if np.abs(a.velocity_change_by_remedies).max() > 1e-9 * np.abs(after.velocity[0]).max():  # far above round-off
        lines.append(tr("the remedies changed v by {amount}",
                        amount=format_amount(a.velocity_change_by_remedies, "m/s")))
    return lines


def _strain_lines(_: Scene, a: ParticleStepBreakdown) -> list[str]:
    before, after = a.before, a.after
    return [f"F {_format_tensor(before.deformation_gradient[0], '', True, after.deformation_gradient[0])}",
            tr("stress {stress}", stress=_format_tensor(before.stress[0], "Pa", False, after.stress[0]))]


PHASES = (
    Phase(lazy("A particle and its nodes"), lambda scene: tr(WEIGHT.get(scene.method, AVERAGED)),
          (WEIGHTS, SLOPES), 1, _state_lines),
    Phase(lazy("Mass and momentum go to the nodes"),
          lambda _: tr("mass of a node = sum of weight × mass of the particles; its momentum likewise"),
          (MASS, MOMENTUM, WEIGHTS), 2, _to_nodes_lines),
    Phase(lazy("Forces at the nodes"), _force_equation, (INTERNAL, BODY, SLOPES), 2, _force_lines),
    Phase(lazy("New velocities of the nodes"),
          lambda _: tr("new v of a node = momentum / mass + time step × a, with a = force / mass"),
          (OLD, NEW, ACCELERATION), 2,
          lambda scene, a: [tr("time step {size}", size=format_amount(np.array([a.time_step]), "s"))]),
    Phase(lazy("Velocities come back, the particles move"),
          lambda scene: tr(MOTION.get(scene.velocity, MOTION[""])), (NEW, ACCELERATION, WEIGHTS), 1,
          _to_particles_lines),
    Phase(lazy("Stress last"), _stress_equation, (NEW, SLOPES), 1, _strain_lines))


def format_scaled(values: np.ndarray, unit: str, digits: int) -> tuple[list[str], str]:
    """Formats numbers (n,) or vectors (n, D) in ``unit`` (without prefix: "Pa") with so many significant digits and a
    common prefix; returns the n texts, components with commas between, and the unit with its prefix."""
    largest = np.abs(values[np.isfinite(values)]).max(initial=0.0)
    power = math.floor(math.log10(largest) / 3) if largest > 0 and unit not in ("", "1/m") else 0
    power = power if power in PREFIXES else 0
    rows = values.reshape(len(values), -1) / 1000.0**power
    least = 1e-12 * largest / 1000.0**power  # smaller values are round-off, and become 0
    texts = [", ".join(f"{0.0 if abs(x) < least else x:.{digits}g}" for x in row).replace("-", "−") for row in rows]
    return texts, PREFIXES[power] + unit


def format_amount(values: np.ndarray, unit: str) -> str:
    """Formats a number (1,) or the components (D,) of a vector in ``unit``, with prefix and four significant digits."""
    return format_change(values, None, unit, 4)


def format_change(before: np.ndarray, after: np.ndarray | None, unit: str, digits: int = 6) -> str:
    """Formats a number (1,) or vector (D,) in ``unit`` before a step and, unless None, after it, an arrow between."""
    texts, unit = format_scaled(before[None] if after is None else np.stack([before, after]), unit, digits)
    return " → ".join(f"({text})" if len(before) > 1 else text for text in texts) + f" {unit}".rstrip()


def _format_tensor(values: np.ndarray, unit: str = "Pa", full: bool = False, after: np.ndarray | None = None) -> str:
    """Formats a number or a tensor (D, D) in ``unit``, a symmetric one by three components unless ``full``; with
    ``after``, as a change to it."""
    which = [0] if values.size == 1 else [0, 1, 2, 3] if full else [0, 1, 3]
    name = {1: "", 3: "(xx, xy, yy) ", 4: "(xx, xy, yx, yy) "}[len(which)]
    parts = values.ravel()[which]
    return name + (format_amount(parts, unit) if after is None else format_change(parts, after.ravel()[which], unit))
