"""Cures of a broken run: scenes with one or two changes that may hold where it was lost or went unstable.

The scene and what was found decide which they are, the same for the same run; whether one holds only a run can say
(``solvers.running.cure_trials``). The cheapest come first; what changes the question comes last.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

from solvers.scene.kernel_options import kernel_key
from solvers.scene.scene import AUTO, Scene
from solvers.scene.stabilisations import CENTRED, COUPLED, FILTER, FROZEN, PIECES
from solvers.scene.step_bound import SAFE
from solvers.scene.validation import SceneError
from solvers.translatable_message import Message, join_messages

Change = dict[str, Any]  # a scene's fields and their new values, as in JSON

MOST_COST = 16.0  # particle-steps of a cure, over those of the broken run
ENOUGH = 3  # particles per cell and direction, with which most methods hold
KERNEL_COST = 3e6  # particle-steps in the time that other kernels take to load; they are worth it where a vice goes
VICES = {"velocity", "layout", "linearity_preserving"}  # fields whose unusual values break many runs
MOST_NAMED = 3  # cures that a sentence names without a trial
AUTO_STEP: Change = {"dt": AUTO, "cfl": None}
#: What corrects what was found, first: F that contradicts the displacements, or a body that drifts as a whole.
REMEDIES = {"neighbour_gap": ([FILTER, COUPLED], [PIECES]), "displacement_mismatch": ([FILTER, COUPLED], [COUPLED]),
            "mean_drift": ([CENTRED], [FROZEN])}
OTHER_REMEDIES = ([PIECES], [FROZEN], [FILTER, COUPLED], [FILTER])
METHODS = ("cpdi", "bspline", "ugimp", "cpgimp")  # the more robust first


@dataclass(frozen=True)
class Cure:
    """Change of a broken run's scene that may make it hold: the fields that differ with their new values, the same in
    words, whether it was ``tried``, and whether the run then ``held``, ok to its end."""

    change: Change
    text: str
    tried: bool = False
    held: bool = False


def candidate_cures(scene: Scene, found: str, broken_at: float) -> tuple[Cure, ...]:
    """Returns what may help a scene whose run broke at a time in s, the cheapest first. ``found`` is the rule by which
    it is lost (``solvers.solver.soundness``), or "" for an unstable run. Where the scene's own step is too long,
    nothing helps without a shorter one."""
    step = AUTO_STEP if scene.time_step > scene.step_bound else {}
    more_steps = scene.time_step / (SAFE * scene.step_bound) if step else 1.0
    own, costs = scene.particles * scene.steps, dict[Scene, tuple[float, Change]]()
    for change in ({}, *_single_changes(scene, found)) if step else _changes(scene, found):
        try:
            cured = replace(scene, **change)  # without that step: each scene's own takes long to find
        except SceneError:
            continue
        cost = more_steps * cured.particles * cured.steps
        if (step or cured != scene) and cost <= MOST_COST * own:
            loads = kernel_key(cured) != kernel_key(scene) and not change.keys() <= VICES
            costs.setdefault(cured, (cost + KERNEL_COST * loads, change))
    ordered = [change for _, change in sorted(costs.values(), key=lambda one: one[0])]
    smaller = [{"amplitude": scene.amplitude / 2}] if scene.swings else []
    shorter = [{"periods": float(f"{0.8 * broken_at / scene.period:.2g}"), "t_end": None}] if broken_at > 0 else []
    changes = [dict(sorted((change | step).items())) for change in (*ordered, *smaller)]
    return tuple(Cure(change, _words(scene, change)) for change in (*changes, *shorter))


def _changes(scene: Scene, found: str) -> Iterator[Change]:
    """Yields changes of one or two fields of a scene, the likeliest first; not every one makes a valid scene."""
    single = list(_single_changes(scene, found))
    firm = [change for change in single if change.keys() <= VICES or change.get("ppc") == ENOUGH]
    yield from single
    yield from (one | other for one in firm for other in single if not one.keys() & other.keys())


def _single_changes(scene: Scene, found: str) -> Iterator[Change]:
    """Yields changes of one field of a scene, the likeliest first."""
    if scene.velocity != "grid":
        yield {"velocity": "grid"}
    if getattr(scene, "layout", "") == "cartesian":
        yield {"layout": "polar"}
    if scene.linearity_preserving:
        yield {"linearity_preserving": False}
    few = int(scene.ppc)
    yield from ({"ppc": more} for more in sorted({few + 1, few + 2, 2 * few, 2 * few + 2}))
    for names in (*REMEDIES.get(found, ()), *OTHER_REMEDIES, []):
        if set(names) <= set(scene.REMEDIES):
            yield {"remedies": names}
    yield from ({"method": name} for name in METHODS if name in scene.choices("method"))
    yield from ({"cells": round(finer * scene.cells)} for finer in (1.5, 2))


def _words(scene: Scene, change: Change) -> str:
    """Returns a change in words: "6 particles per cell and the grid velocity"."""
    across = Message(" and direction") if scene.DIMENSIONS > 1 else ""
    words = {
        "method": lambda name: Message("the method {name}", name),
        "cells": lambda cells: Message("{cells} cells", cells),
        "ppc": lambda ppc: Message("{ppc} particles per cell{across}", ppc, across),
        "velocity": lambda _: Message("the grid velocity"), "layout": lambda _: Message("the polar layout"),
        "linearity_preserving": lambda _: Message("no linearity preservation"),
        "remedies": lambda names: Message("the remedies {names}", ",".join(names)) if len(names) > 1 else
        Message("the remedy {name}", *names) if names else Message("no remedy"),
        "amplitude": lambda A: Message("the amplitude {A:.3g}", A), "dt": lambda _: Message("the automatic step"),
        "periods": lambda count: Message("an end after {count:g} periods", count)}
    return join_messages(" and ", (say(change[name]) for name, say in words.items() if name in change))


def advice_sentence(cures: Sequence[Cure]) -> str:
    """Returns which cures help, by their trials, or else which may, as part of a sentence."""
    held, failed, untried = ([cure.text for cure in cures if (cure.tried, cure.held) == kind]
                             for kind in ((True, True), (True, False), (False, False)))
    if held:
        return Message("with {change} it holds (tried)", join_messages(" or ", held))
    parts = [Message("no change that was tried holds: {changes}", join_messages(", ", failed))] if failed else []
    if untried:
        parts.append(Message("{changes} may help (not tried)", join_messages(" or ", untried[:MOST_NAMED])))
    return join_messages("; ", parts)
