"""The causes between which the effect ``budget`` divides the error of a run."""

from solvers.translatable_message import Message

#: Labels of the causes by name, in the order of the lanes in kernels and of the columns of samples.
CAUSES: dict[str, str] = {"crossings": "crossings", "coarse_grid": "coarse grid", "body_force": "body force",
                          "time_step": "time step"}
PARTICLE_SUMS = Message("particle sums")
#: Stands for no cause, in a run that keeps all of them.
NOTHING = "nothing"
#: The fields whose error is divided.
FIELDS = ("x", "v", "F")
#: Columns of the effect in the samples: for each field, sums of e^2, of e_c e and of e_c^2, c a cause.
COLUMNS = tuple(name for field in FIELDS for name in (
    f"error_{field}", *(f"part_{field}_{cause}" for cause in CAUSES), *(f"size_{field}_{cause}" for cause in CAUSES)))


def cause_labels(crossed: bool) -> dict[str, str]:
    """Returns the labels of the causes by name. Until a particle has ``crossed`` into another cell, what "crossings"
    made is called particle sums: a particle counts whole in each cell that holds a part of it, already then."""
    return CAUSES if crossed else CAUSES | {"crossings": PARTICLE_SUMS}
