"""What the ring asks: whether finer cells help as they should, what another judge says, and what breaks it."""

from dataclasses import replace

from app.language.heard import heard
from app.language.spoken import later, tr
from app.problems.spark import Answer, NotNow, Offer, Ran, Spark, asked, breaking, halving
from app.state import State
from app.words import per_cent, ratio

MOST_CELLS = 96
BREAKING = 0.25  # m, of A: hat functions lose it in the second period


def _ask_transport(state: State) -> Offer:
    judges = state.scene.estimators
    if (state.estimator or next(iter(judges), None)) == "transport":
        raise NotNow(tr("it is on the stage"))
    changed = asked(state, {"estimators": (*judges, *({"transport"} - set(judges)))}, pinned=False)
    return Offer(tr("Ask transport, too"), tr("the method's own equations"), replace(changed, estimator="transport"))


def _says(ran: Ran) -> Answer:
    if "transport" in ran.not_valid:
        return tr("Transport says: {reason}.", reason=heard(ran.not_valid["transport"])), \
            tr("It does not hold here, and says so.")
    index, companion = ran.index("transport"), ran.index("companion")
    if index != index:
        return tr("Transport does not estimate the {noun}.", noun=ran.noun), tr("It says so in place of a number.")
    said = tr("Transport says {times} times what the error is.", times=ratio(index)) if index >= 1 else \
        tr("Transport says {share} of what the error is.", share=per_cent(index))
    if companion == companion:
        return said, tr("Companion says {times} times. Which of them would you believe without the truth?",
                        times=ratio(companion))
    return said, tr("Which of them would you believe without the truth?")


SPARKS = (halving(MOST_CELLS), Spark("transport", "judge", later("Ask transport, too"), _ask_transport, _says, 0.5),
          breaking(later("Break it"), later("hat functions, A = 250 mm"),
                   {"method": "mpm", "amplitude": BREAKING}, 1.2))


def sparks(_: State) -> tuple[Spark, ...]:
    """The same three of every ring."""
    return SPARKS
