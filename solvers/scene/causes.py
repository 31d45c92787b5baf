"""The causes between which the effect ``budget`` divides the error of a run, known once."""

#: By name, what each is called in words. The order is that of the lanes in kernels and of the columns of samples.
CAUSES: dict[str, str] = {
    "crossings": "crossings",
    "coarse_grid": "coarse grid",
    "body_force": "body force",
    "time_step": "time step",
}
#: What a run that keeps all of them takes away.
NOTHING = "nothing"
#: The fields whose error is divided.
FIELDS = ("x", "v", "F")
