"""The phases of a step in slow motion: what each is called, in words, and the solver's numbers that belong to it."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from app.words import PREFIXES
from solvers.scene.remedies import PIECES
from solvers.scene.scene import Scene
from solvers.solver.step_breakdown import StepBreakdown

#: What a node's weight is, by method.
WEIGHT = {"mpm": "the node's hat function at the particle", "bspline": "the node's quadratic B-spline at the particle",
          "cpdi": "the node's hat function, mean of the particle's four corners"}
AVERAGED = "the node's hat function, averaged over the particle's domain"


@dataclass(frozen=True)
class Column:
    """A number of each node (n,) or a vector (n, D), with the unit that it has after ``scale``."""

    name: str
    unit: str
    values: Callable[[StepBreakdown], np.ndarray]
    scale: float = 1.0


WEIGHTS = Column("weight S", "", lambda a: a.links.weight[0])
SLOPES = Column("slope of S", "1/m", lambda a: a.links.slope[0])
MASS = Column("mass", "g", lambda a: a.node_mass, 1000.0)
MOMENTUM = Column("momentum", "N s", lambda a: a.momentum)
INTERNAL = Column("force of stress", "N", lambda a: a.internal_force)
BODY = Column("body force", "N", lambda a: a.body_force)
OLD = Column("old v", "m/s", lambda a: a.before_velocity)
NEW = Column("new v", "m/s", lambda a: a.velocity)
ACCELERATION = Column("acceleration a", "m/s²", lambda a: a.acceleration)


@dataclass(frozen=True)
class Phase:
    """``words`` is the equation, ``columns`` the nodes' numbers, the first ``drawn`` of them beside the nodes too;
    ``front`` has the lines about the particle in front."""

    title: str
    words: Callable[[Scene], str]
    columns: tuple[Column, ...]
    drawn: int
    front: Callable[[Scene, StepBreakdown], list[str]]


def _of_force(scene: Scene) -> str:
    body = {"none": "; no body force", "node": " + body force at the node, × its mass"}
    corrected = ", corrected to be exact for linear stress" * scene.linearity_preserving
    volume = "volume at rest" if scene.frozen else "volume"
    if PIECES in scene.remedies:
        return (f"force of a node = sum over the corners between pieces of its function there × jump of the stress"
                f"{corrected}" + body.get(scene.body_force, " + sum of weight × body force"))
    return (f"force of a node = − sum of slope × {volume} × stress of the particles{corrected}"
            + body.get(scene.body_force, " + sum of weight × body force"))


def _of_motion(scene: Scene) -> str:
    moved = {"particle": "its new v", "corners": "the nodes' new v at the ends of its domain (mean)"}
    return ("the particle's v grows by time step × sum of weight × a of the nodes, x by time step × "
            + moved.get(scene.velocity, "sum of weight × new v of the nodes"))


def _of_stress(scene: Scene) -> str:
    if PIECES in scene.remedies:
        return ("F grows by time step × difference of the nodes' new v at the corners of the piece / its length × F; "
                "stress follows from the new F")
    gradient = "sum of slope × new v of the nodes"
    return f"F grows by time step × {gradient}{'' if scene.frozen else ' × F'}; stress follows from the new F"


def _carried(_: Scene, a: StepBreakdown) -> list[str]:
    here = a.before
    return [f"x = {amount(here.position[0], 'm')}, v = {amount(here.velocity[0], 'm/s')}",
            f"mass {amount(1000 * a.mass[:1], 'g')}, stress {_tensor(here.stress[0])}"]


def _given(_: Scene, a: StepBreakdown) -> list[str]:
    momentum = a.mass[0] * a.before.velocity[0]
    return [f"each node gets its weight × mass {amount(1000 * a.mass[:1], 'g')}, and × momentum "
            f"{amount(momentum, 'N s')}"]


def _pulled(scene: Scene, a: StepBreakdown) -> list[str]:
    if PIECES in scene.remedies:
        return [f"stress {_tensor(a.before.stress[0])}, the same in the whole piece"]
    if scene.frozen:
        return [f"volume × stress at rest {_tensor(a.tension[0], 'N m', True)}",
                "the weights stay those of the particle at rest"]
    return [f"volume × stress {_tensor(a.tension[0], 'N m')}"]


def _moved(_: Scene, a: StepBreakdown) -> list[str]:
    before, after = a.before, a.after
    lines = [f"v = {change(before.velocity[0], after.velocity[0], 'm/s')}",
             f"x = {change(before.position[0], after.position[0], 'm')}"]
    if np.abs(a.left_over).max() > 1e-9 * np.abs(after.velocity[0]).max():  # far above round-off
        lines.append(f"of this v, the remedies have added {amount(a.left_over, 'm/s')}")
    return lines


def _strained(_: Scene, a: StepBreakdown) -> list[str]:
    before, after = a.before, a.after
    return [f"F {_tensor(before.deformation_gradient[0], '', True, after.deformation_gradient[0])}",
            f"stress {_tensor(before.stress[0], 'Pa', False, after.stress[0])}"]


PHASES = (
    Phase("A particle and its nodes", lambda scene: f"weight S = {WEIGHT.get(scene.method, AVERAGED)}",
          (WEIGHTS, SLOPES), 1, _carried),
    Phase("Mass and momentum go to the nodes",
          lambda _: "mass of a node = sum of weight × mass of the particles; its momentum likewise",
          (MASS, MOMENTUM, WEIGHTS), 2, _given),
    Phase("Forces at the nodes", _of_force, (INTERNAL, BODY, SLOPES), 2, _pulled),
    Phase("New velocities of the nodes",
          lambda _: "new v of a node = momentum / mass + time step × a, with a = force / mass",
          (OLD, NEW, ACCELERATION), 2, lambda scene, a: [f"time step {amount(np.array([a.time_step]), 's')}"]),
    Phase("Velocities come back, the particles move", _of_motion, (NEW, ACCELERATION, WEIGHTS), 1, _moved),
    Phase("Stress last", _of_stress, (NEW, SLOPES), 1, _strained))


def scaled(values: np.ndarray, unit: str, digits: int) -> tuple[list[str], str]:
    """Texts of numbers (n,) or vectors (n, D) that share a power of ten, and the unit with its prefix."""
    largest = np.abs(values[np.isfinite(values)]).max(initial=0.0)
    power = math.floor(math.log10(largest) / 3) if largest > 0 and unit not in ("", "1/m") else 0
    power = power if power in PREFIXES else 0
    rows = values.reshape(len(values), -1) / 1000.0**power
    least = 1e-12 * largest / 1000.0**power  # what is smaller beside the largest is round-off, and reads as 0
    texts = [", ".join(f"{0.0 if abs(x) < least else x:.{digits}g}" for x in row).replace("-", "−") for row in rows]
    return texts, PREFIXES[power] + unit


def amount(values: np.ndarray, unit: str, digits: int = 4) -> str:
    """A number or the components (D,) of a vector, with its unit."""
    return change(values, None, unit, digits)


def change(before: np.ndarray, after: np.ndarray | None, unit: str, digits: int = 6) -> str:
    """The same before and after, with an arrow between."""
    both = before[None] if after is None else np.stack([before, after])
    texts, unit = scaled(both, unit, digits)
    return " → ".join(f"({text})" if len(before) > 1 else text for text in texts) + f" {unit}".rstrip()


def _tensor(values: np.ndarray, unit: str = "Pa", full: bool = False, after: np.ndarray | None = None) -> str:
    """A number, or the components of a tensor (D, D), all if it is not symmetric; perhaps before and after."""
    which = [0] if values.size == 1 else [0, 1, 2, 3] if full else [0, 1, 3]
    name = {1: "", 3: "(xx, xy, yy) ", 4: "(xx, xy, yx, yy) "}[len(which)]
    parts = values.ravel()[which]
    return name + (amount(parts, unit) if after is None else change(parts, after.ravel()[which], unit))
