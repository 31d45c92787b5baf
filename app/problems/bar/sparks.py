"""What the bar asks: of its vibration, whether finer cells, crossing and large motions do what one thinks; of its patch
test, which particles fit."""

import math

from app.language.spoken import later, tr
from app.problems.spark import Answer, NotNow, Offer, Ran, Spark, asked, breaking, halving
from app.state import State
from app.words import factor, per_cent

MOST_CELLS = 160
BREAKING = 0.1  # m, of A: hat functions lose it in the second period
MISFITS = 2.5  # particles per cell that lie otherwise in every other cell
PASSED = 1e-9  # of the stress: round-off


def _cross(state: State) -> Offer:
    if state.scene.method == "mpm":  # they do: what would smoother functions do at the same crossings?
        return Offer(tr("Smooth the crossing"), tr("uGIMP: particles as intervals"), asked(state, {"method": "ugimp"}))
    return Offer(tr("Let particles cross"), tr("hat functions, the oldest way"),
                 asked(state, {"method": "mpm"}, quantity="sigma"))


def _crossed(ran: Ran) -> Answer:
    own, other = (series["crossings"][-1] if len(series.get("crossings", ())) else math.nan
                  for series in (ran.series, ran.pinned))
    if ran.ratio >= 1:
        return tr("The {noun} errs {factor} times as much.", noun=ran.noun, factor=factor(ran.ratio)), \
            tr("{own:,.0f} crossings, {other:,.0f} in the pinned run. It is the functions, not the crossing.", own=own,
               other=other)
    return tr("The {noun} errs {factor} times as much as before.", noun=ran.noun, factor=factor(ran.ratio)), \
        tr("{own:,.0f} crossings, {other:,.0f} in the pinned run.", own=own, other=other)


VIBRATING = (halving(MOST_CELLS), Spark("cross", "cross", later("Let particles cross"), _cross, _crossed),
             breaking(later("Break it"), later("A = 100 mm: who notices first?"),
                      {"method": "mpm", "amplitude": BREAKING}, 1.5))


def _misfit(title: str, hint: str, method: str) -> Spark:
    def offer(state: State) -> Offer:
        if (state.scene.method, state.scene.ppc) == (method, MISFITS):
            raise NotNow(tr("it is on the stage"))
        return Offer(tr(title), tr(hint),
                     asked(state, {"method": method, "ppc": MISFITS}, pinned=False, quantity="sigma"))

    icon = {"mpm": "break", "bspline": "cross", "ugimp": "halve"}[method]
    return Spark(f"misfit-{method}", icon, title, offer, _wrong, 0.5)


def _wrong(ran: Ran) -> Answer:
    values = ran.series.get("error_sigma", ())
    wrong = float(sum(values) / len(values)) / ran.state.scene.size_of("sigma") if len(values) else math.nan
    if wrong < PASSED:
        return tr("Nothing happens, as it should."), \
            tr("The stress is wrong by round-off: the patch test is passed.")
    return tr("The stress is {share} wrong, of a bar that only moves on.", share=per_cent(wrong)), \
        tr("Nothing should happen: every other cell has a particle more, and these functions feel it.")


PATCH_TEST = (_misfit(later("Particles that do not fit"), later("2.5 a cell, hat functions"), "mpm"),
              _misfit(later("Smoother functions"), later("the same particles, B-splines"), "bspline"),
              _misfit(later("Particles that tile"), later("the same as intervals: uGIMP"), "ugimp"))


def sparks(state: State) -> tuple[Spark, ...]:
    """The three that fit what the bar does."""
    return VIBRATING if state.scene.swings else PATCH_TEST
