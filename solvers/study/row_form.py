"""What a kept row must have for tables and pictures to be made of it."""

from dataclasses import fields
from typing import Any

from solvers.problems import PROBLEMS
from solvers.scene.rules import field_key
from solvers.solver.soundness import BROKEN, OK
from solvers.study.forms import NUMBER, NUMBER_OR_NONE, Each, mismatch
from solvers.study.row import FAILED, REFUSED

ANY = (object, bool)
TEXT_OR_NONE = (str, type(None))
STATUSES = (OK, *BROKEN, FAILED, REFUSED)
IDENTITY = {"key": str, "problem": str, "asked": dict, "status": str, "reason": TEXT_OR_NONE,
            "scene": (dict, type(None))}
NORMS = Each(Each(NUMBER_OR_NONE))  # of each quantity, by kind of norm
#: What the row of a run has beside that.
MEASURED = {
    "h": NUMBER, "steps": int, "particles": int, "error": NORMS, "estimate": Each(NORMS), "index": NORMS,
    "seconds": {"repeats": list, "min": NUMBER, "full": NUMBER, "estimators": Each(NUMBER), "effects": Each(NUMBER)},
    "rate": NUMBER_OR_NONE, "life": Each(NUMBER_OR_NONE)}
SCENE = {"method": str, "cells": int, "ppc": NUMBER, "amplitude": NUMBER_OR_NONE, "dt": NUMBER, "cfl": NUMBER,
         "periods": NUMBER, "estimator": list, "effects": list, "remedies": list}


def fault(row: Any) -> str | None:
    """What is wrong with a kept row, in words; None where it is whole."""
    if found := mismatch(row, IDENTITY):
        return found
    if row["problem"] not in PROBLEMS or row["status"] not in STATUSES:
        name = "status" if row["problem"] in PROBLEMS else "problem"
        return f"its {name} is not one of {', '.join(STATUSES if name == 'status' else PROBLEMS)}"
    inputs = {field_key(field.name): ANY for field in fields(PROBLEMS[row["problem"]].scene)} | SCENE
    if row["scene"] is not None and (found := mismatch(row["scene"], inputs, "scene")):
        return found
    if row["status"] not in (OK, *BROKEN):
        return None
    return mismatch(row, {"scene": dict, **MEASURED})
