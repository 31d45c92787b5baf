"""What the ring asks: whether finer cells help as they should, what another judge says, and what breaks it."""

from dataclasses import replace

from app.problems.spark import Answer, NotNow, Offer, Ran, Spark, asked, breaking, halving
from app.state import State
from app.words import per_cent, ratio

MOST_CELLS = 96
BREAKING = 0.25  # m, of A: hat functions lose it in the second period


def _ask_transport(state: State) -> Offer:
    judges = state.scene.estimators
    if (state.estimator or next(iter(judges), None)) == "transport":
        raise NotNow("it is on the stage")
    changed = asked(state, {"estimators": (*judges, *({"transport"} - set(judges)))}, pinned=False)
    return Offer("Ask transport, too", "the method's own equations", replace(changed, estimator="transport"))


def _says(ran: Ran) -> Answer:
    if "transport" in ran.not_valid:
        return f"Transport says: {ran.not_valid['transport']}.", "It does not hold here, and says so."
    index, companion = ran.index("transport"), ran.index("companion")
    if index != index:
        return f"Transport does not estimate the {ran.noun}.", "It says so in place of a number."
    said = f"{ratio(index)} times" if index >= 1 else per_cent(index) + " of"
    beside = f"Companion says {ratio(companion)} times. " if companion == companion else ""
    return f"Transport says {said} what the error is.", f"{beside}Which of them would you believe without the truth?"


SPARKS = (halving(MOST_CELLS), Spark("transport", "judge", "Ask transport, too", _ask_transport, _says, 0.5),
          breaking("Break it", "hat functions, A = 250 mm", {"method": "mpm", "amplitude": BREAKING}, 1.2))


def sparks(_: State) -> tuple[Spark, ...]:
    """The same three of every ring."""
    return SPARKS
