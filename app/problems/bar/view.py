"""View of the bar beside its stage and pictures: regions, ranges of sliders, texts and suggestions."""

import math
from dataclasses import replace
from typing import Any

import numpy as np

from app.language.translation import lazy, tr
from app.names_and_units import format_factor, per_cent
from app.problems import suggested_experiment
from app.problems.bar.slow_motion import BarSlowMotionStage
from app.problems.bar.stage import BarStage
from app.problems.interface import BodyRegions, MotionSelector, ProblemView, SliderRanges
from app.problems.suggested_experiment import (
    Answer,
    ComparedRuns,
    Offer,
    SuggestedExperiment,
    SuggestionNotApplicable,
    changed_state,
)
from app.shareable_state import State
from solvers.problems.bar.patch_test_inputs import PATCH
from solvers.problems.bar.scene import BarScene

MOST_CELLS = 160
BREAKING = 0.1  # amplitude in m at which hat functions fail in the second period
MISFITS = 2.5  # particles per cell: their positions differ in every other cell
PASSED = 1e-9  # relative error of the stress: round-off


def _crossing_offer(state: State) -> Offer:
    if state.scene.method == "mpm":  # already so: offer smoother functions
        return Offer(tr("Smooth the crossing"), tr("uGIMP: particles as intervals"),
                     changed_state(state, {"method": "ugimp"}))
    return Offer(tr("Let particles cross"), tr("hat functions, the oldest method"),
                 changed_state(state, {"method": "mpm"}, quantity="sigma"))


def _crossing_answer(runs: ComparedRuns) -> Answer:
    own, other = (series["crossings"][-1] if len(series.get("crossings", ())) else math.nan
                  for series in (runs.series, runs.pinned))
    larger = runs.ratio >= 1
    error = (tr("The error of the {noun} is {factor} times as large.", noun=runs.quantity_noun,
                factor=format_factor(runs.ratio)) if larger else
             tr("The error of the {noun} is {factor} times the previous one.", noun=runs.quantity_noun,
                factor=format_factor(runs.ratio)))
    if not math.isfinite(own + other):
        return error, tr("Crossings are not counted in at least one of the two runs.")
    return error, \
        tr("{own:,.0f} crossings, {other:,.0f} in the pinned run. It is the functions, not the crossing.", own=own,
           other=other) if larger else \
        tr("{own:,.0f} crossings, {other:,.0f} in the pinned run.", own=own, other=other)


VIBRATING = (suggested_experiment.suggest_halving_cells(MOST_CELLS),
             SuggestedExperiment("cross", "cross", lazy("Let particles cross"), _crossing_offer, _crossing_answer),
             suggested_experiment.suggest_breaking(lazy("A = 100 mm: which fails first?"),
                                         {"method": "mpm", "amplitude": BREAKING, "displacement": ""}, 1.5))


def _suggest_patch_test(title: str, hint: str, method: str) -> SuggestedExperiment:
    def offer(state: State) -> Offer:
        if (state.scene.method, state.scene.ppc) == (method, MISFITS):
            raise SuggestionNotApplicable(tr("it is on the stage"))
        return Offer(tr(title), tr(hint),
                     changed_state(state, {"method": method, "ppc": MISFITS}, pinned=False, quantity="sigma"))

    icon = {"mpm": "break", "bspline": "cross", "ugimp": "halve"}[method]
    return SuggestedExperiment(f"misfit-{method}", icon, title, offer, _patch_test_answer, 0.5)


def _patch_test_answer(runs: ComparedRuns) -> Answer:
    values = runs.series.get("error_sigma", ())
    wrong = float(sum(values) / len(values)) / runs.state.scene.size_of("sigma") if len(values) else math.nan
    if wrong < PASSED:
        return tr("Nothing happens, as expected."), \
            tr("The stress is exact up to round-off: the patch test passes.")
    return tr("The stress is {share} wrong, although the bar only moves at constant speed.", share=per_cent(wrong)), \
        tr("Nothing should happen, but every other cell has one more particle, which matters here.")


PATCH_TEST = (_suggest_patch_test(lazy("Particles that do not fit"), lazy("2.5 a cell, hat functions"), "mpm"),
              _suggest_patch_test(lazy("Smoother functions"), lazy("the same particles, B-splines"), "bspline"),
              _suggest_patch_test(lazy("Particles that tile"), lazy("the same as intervals: uGIMP"), "ugimp"))


def bar_suggestions(state: State) -> tuple[SuggestedExperiment, ...]:
    """Returns the suggestions for the bar in a state of the page: other ones for a patch test than for vibration."""
    return VIBRATING if state.scene.swings else PATCH_TEST


#: With the usual modulus and step a patch test's particles lie on cell boundaries to the last digit, where
#: rounding decides in which cell they are (``patch.edge_step``).
STIFF, STIFF_CFL = 1000.0, 0.2
LENGTHS = 20  # regions of the bar, of 0.05 m


def regions(X: np.ndarray) -> BodyRegions:
    """Returns the bar's 20 regions, equal lengths, for particles at X (P, 1) in m at rest."""
    number = np.clip((X[:, 0] * LENGTHS).astype(int), 0, LENGTHS - 1)
    return BodyRegions(tuple(f"X = {k / LENGTHS:.2f}–{(k + 1) / LENGTHS:.2f} m" for k in range(LENGTHS)), number)


def change_motion(scene: BarScene, motion: str, usual: tuple[str, ...]) -> BarScene:
    """Returns the scene with another ``motion``, by its key; fields without meaning in it get their defaults. A patch
    test gets the companion alone, another motion the estimators ``usual``, by name."""
    plain = BarScene()
    if motion == PATCH:
        return replace(scene, motion=motion, amplitude=plain.amplitude, body_force=plain.body_force, displacement="",
                       estimators=("companion",), modulus=STIFF, dt=None, cfl=STIFF_CFL)
    return replace(scene, motion=motion, stretch=plain.stretch, initial_velocity=plain.initial_velocity,
                   body_force=plain.body_force, ppc=max(1, round(scene.ppc)), estimators=usual, modulus=plain.modulus,
                   dt=None, cfl=None)


MOTION = MotionSelector(
    lazy("vibrate, or be stretched evenly and move on at constant speed, so that exactly nothing should happen"),
    change_motion,
    {"stretch": (lazy("Stretch F"), 0.8, 1.2, 0.01,
                 lazy("length of the bar over that at rest; at 1 it has no stress")),
     "initial_velocity": (lazy("Velocity v, m/s"), 0.0, 2.0, 0.05,
                          lazy("at which the whole bar moves through the grid"))}, speed=1.0, quantity="sigma")


def draw_picture(*arguments: Any) -> None:
    """Draws a result (:func:`app.problems.bar.picture_panels.draw_picture`); imports the slow matplotlib only when
    called."""
    from app.problems.bar import picture_panels

    picture_panels.draw_picture(*arguments)


BAR = ProblemView(
    "bar", BarStage, BarSlowMotionStage, draw_picture, regions, lazy("the bar into 20 lengths"),
    picture=(10.0, 1.25 / 3), speed=0.5,
    slider_ranges=SliderRanges((8, 160, 1), (1, 8), (1e-3, 0.2), (0.04, 4000.0)),
    amplitude_hint=lazy("amplitude of the vibration; from 0.159 m on (under two tones from 0.118 m on) the exact bar "
                        "turns inside out"),
    prices={"transport": 0.09, "recovered": 0.09, "companion": 0.06, "two-grid": 0.18},  # two-grid: of 80 cells
    formula=("displacement", lazy("Displacement u"),
             lazy("a formula of X, t, w and A in metres; empty for the built-in one")),
    motion=MOTION, suggestions=bar_suggestions,
    details={"linearity_preserving": lazy("correct the gradient so that linear stress gives the exact force"),
             "body_force": lazy("where the force is evaluated"),
             "velocity": lazy("the velocity that moves the particles")})
