"""What the columns of a file of particles may be called, and what they mean.

A quantity has one key here: ``t``, ``id``, ``X`` (material position), ``x`` (position), ``v``, ``F`` and ``sigma``. A
file has it as an array or as one column for each component.
"""

import itertools
import re

#: What else each quantity may be called. X and x, which differ only in size, are the only names whose size counts.
NAMES = {"t": ("t", "time", "timevalue"),
         "id": ("id", "ids", "particle_id", "particle", "pid", "global_id"),
         "X": ("X", "X0", "x0", "material_position", "initial_position", "reference_position"),
         "x": ("x", "position", "positions", "points", "coordinates", "coords"),
         "v": ("v", "velocity", "velocities"),
         "F": ("f", "deformation_gradient", "defgrad"),
         "sigma": ("sigma", "stress", "cauchy_stress", "s")}
LETTERS = "xyz"
VECTORS, TENSORS = ("X", "x", "v"), ("F", "sigma")
SEPARATORS = ("", "_", ":", ".", "-")
#: What is said where something is missing.
SAY = {"t": "t", "id": "id", "X": "X, Y", "x": "x, y", "v": "vx, vy", "F": "Fxx, Fxy, Fyx, Fyy",
       "sigma": "sxx, sxy, syy"}


def _components() -> dict[str, tuple[str, tuple[int, ...]]]:
    """Every column's name with its quantity and component."""
    found: dict[str, tuple[str, tuple[int, ...]]] = {}
    for key, names in NAMES.items():
        for name, separator in itertools.product(names, SEPARATORS):
            if key in VECTORS and name not in ("x", "X"):
                found |= {f"{name}{separator}{mark}": (key, (k,)) for k in range(3) for mark in (LETTERS[k], str(k))}
            if key in TENSORS:
                pairs = list(itertools.product(range(3), range(3)))
                found |= {f"{name}{separator}{LETTERS[i]}{LETTERS[j]}": (key, (i, j)) for i, j in pairs}
                found |= {f"{name}{separator}{i}{j}": (key, (i, j)) for i, j in pairs}
    for key, letters in (("X", "XYZ"), ("x", LETTERS)):
        found |= {letter: (key, (k,)) for k, letter in enumerate(letters)}
    return found


COMPONENTS = _components()
WHOLE = {name: key for key, names in NAMES.items() for name in names}


def meaning(name: str) -> tuple[str, tuple[int, ...] | None] | None:
    """The quantity of a column or an array, and its component where it is only that; None for any other. A unit in
    brackets at the end says nothing."""
    bare = re.sub(r"\s*[\[(][^\])]*[\])]\s*$", "", name.strip().strip('"'))
    for table in (COMPONENTS, {whole: (key, None) for whole, key in WHOLE.items()}):
        for text in (bare, bare.lower()):
            if text in table:
                return table[text]
    return None


def spelled(key: str, dimensions: int) -> str:
    """What the columns of a quantity are called in a file of so many dimensions."""
    if key in ("t", "id"):
        return key
    if dimensions == 1:
        return {"X": "X", "x": "x", "v": "vx", "F": "Fxx", "sigma": "sxx"}[key]
    return SAY[key]


def column_names(key: str, dimensions: int) -> list[str]:
    """The columns that we write for a quantity, in the order of its components."""
    letters = LETTERS[:dimensions]
    if key in VECTORS:
        return [{"X": letter.upper(), "x": letter, "v": f"v{letter}"}[key] for letter in letters]
    return [f"{'s' if key == 'sigma' else 'F'}{i}{j}" for i in letters for j in letters]
