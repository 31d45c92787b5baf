"""Answers that are dragged: ends and steps of their sliders, and what these are called."""

#: Ends and step of a slider that is dragged to a prediction; powers of ten where the field may be of any size.
REACH = {"cells": (8.0, 160.0, 1.0), "ppc": (1.0, 8.0, 1.0), "amplitude": (-4.0, -0.8, 0.01),
         "modulus": (0.0, 3.0, 0.01), "cfl": (-2.0, 0.5, 0.01)}
POWERS = ("amplitude", "modulus", "cfl")
NAMES = {"cells": "Cells", "ppc": "Particles / cell", "amplitude": "Amplitude", "modulus": "Modulus",
         "cfl": "CFL number"}
