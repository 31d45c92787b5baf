"""The causes between which the effect ``budget`` divides the error of a run."""

#: Labels of the causes by name, in the order of the lanes in kernels and of the columns of samples.
CAUSES: dict[str, str] = {"crossings": "crossings", "coarse_grid": "coarse grid", "body_force": "body force",
                          "time_step": "time step"}
#: Stands for no cause, in a run that keeps all of them.
NOTHING = "nothing"
#: The fields whose error is divided.
FIELDS = ("x", "v", "F")
#: Columns of the effect in the samples: for each field, sums of e^2, of e_c e and of e_c^2, c a cause.
COLUMNS = tuple(name for field in FIELDS for name in (
    f"error_{field}", *(f"part_{field}_{cause}" for cause in CAUSES), *(f"size_{field}_{cause}" for cause in CAUSES)))
