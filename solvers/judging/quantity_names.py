"""Names of columns and arrays of particles as codes and people write them, and the quantities that they mean.

A quantity has one key: ``t``, ``id``, ``row`` (a number that may be that of the row or of a body), ``X`` (material
position), ``x`` (position), ``u`` (displacement), ``v``, ``F``, ``sigma``, ``mass`` and ``volume``. A file has it as an
array or as one column for each component, in any order.
"""

import re
from collections.abc import Iterable
from typing import Any, NamedTuple

#: What each quantity is called, in small letters, without what separates words. Where several columns say which
#: particle a row is, the first in this order is read.
NAMES = {key: tuple(words.split()) for key, words in {
    "t": "t time timevalue tcurrent currenttime simulationtime simtime physicaltime",
    "id": "id ids particleid particleids particle pid mpid mpids materialpointid materialpointids globalparticleid "
          "globalid globalids globalpointids pedigreeids particlenumber particletag ptag partid pointnumber gid",
    "row": "point pointid pointids vtkoriginalpointids index particleindex idx number no nr label tag rowid row",
    "X": "materialposition materialpositions initialposition initialpositions referenceposition originalposition "
         "initialcoordinates initialcoordinate referencecoordinates initialcoords initial reference",
    "x": "position positions points coordinates coordinate coords coord pos location locations globalposition "
         "currentposition currentcoordinates",
    "u": "u displacement displacements disp disps displ totaldisplacement displacementsolid",
    "v": "v vel vels velocity velocities velocitysolid velo",
    "F": "f deformationgradient deformationgradients deformationgradienttensor defgrad defgrads deformgrad defgradient",
    "sigma": "sigma sigmas stress stresses cauchystress cauchystresses cauchystressvector cauchystresstensor "
             "stresstensor stressvector stresscauchy cauchy totalstresssolid totalstress sig s tau",
    "mass": "mass masses particlemass masssolid",
    "volume": "volume volumes vol particlevolume currentvolume"}.items()}
OF_THE_FILE = ("cells", "scene", "result")  # what is not of particles, and read
LETTERS, PLANES = "xyz", ("xy", "xz", "yz")
SCALARS, VECTORS, TENSORS = ("t", "id", "row", "mass", "volume"), ("X", "x", "u", "v"), ("F", "sigma")
#: What may stand before a name: that it is of particles.
OF_PARTICLES = re.compile(r"(?:mp|p\.|p_(?=\w{3})|pt_|mps|particles?|material[ _]?points?)[ _.:\-]*", re.IGNORECASE)
#: A coordinate: its letter, of which a large one is material, and which of the two positions it is of.
COORDINATE = re.compile(r"([XYZxyz])(0|i|init|initial|ref|orig|p|t|cur|current)?")
PRINCIPAL = re.compile(r"sig(?:ma)?[\W_]*[123]\W*", re.IGNORECASE)  # stresses, without a 0 or a 4
MATERIAL = ("0", "i", "init", "initial", "ref", "orig")
GREEK = str.maketrans({"σ": "sigma", "τ": "tau", "ρ": "rho", "µ": "u", "μ": "u", "²": "2", "³": "3"})
LENGTHS = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "dm": 0.1, "km": 1e3, "um": 1e-6}
TIMES = {"s": 1.0, "sec": 1.0, "seconds": 1.0, "ms": 1e-3, "us": 1e-6, "min": 60.0}
PRESSURES = {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9, "N/m2": 1.0, "kN/m2": 1e3, "N/mm2": 1e6}
SPEEDS = {text: length / time for a, length in LENGTHS.items() for b, time in TIMES.items()
          for text in (f"{a}/{b}", f"{a}{b}-1", f"{a}{b}^-1")} | {"mps": 1.0}
#: By key: SI units by the text that stands for each unit in a heading.
UNITS = {"t": TIMES, "X": LENGTHS, "x": LENGTHS, "u": LENGTHS, "v": SPEEDS, "sigma": PRESSURES,
         "mass": {"kg": 1.0, "g": 1e-3, "mg": 1e-6, "t": 1e3},
         "volume": LENGTHS | {f"{a}{power}": length**power for a, length in LENGTHS.items() for power in (2, 3)}}
UNIT = re.compile(r"^(.*?)\s*(?:\[([^\[\]]*)\]|\(([^()]*)\)|(?:/|,|\bin\b)\s*(\S+))$")
UNIT_AT_END = re.compile(r"^(\w*?[^\W_])[_ ]([a-zA-Z]+(?:/[a-zA-Z]+|_?per_?[a-zA-Z]+)?)$")


class ColumnMeaning(NamedTuple):
    """Meaning of a name: the ``key`` of its quantity; its component, letters or digits, "" for the whole, and among the
    other names of a file its indices, or its place in a tensor written as one row, None for the whole; and the
    ``unit`` in SI units, by which the numbers are multiplied."""

    key: str
    component: Any = ""
    unit: float = 1.0


def _word_patterns() -> dict[str, re.Pattern[str]]:
    """Returns by key the pattern of a name without separators, with its component before or after it."""
    marks = {**dict.fromkeys(SCALARS, ("", "")), **dict.fromkeys(VECTORS, ("[xyz]", r"[xyz]|\d")),
             **dict.fromkeys(TENSORS, ("[xyz]{2}", r"[xyz]{1,2}|\d{1,2}"))}
    words = {key: "|".join(sorted(NAMES[key], key=len, reverse=True)) for key in NAMES}
    return {key: re.compile(rf"(?P<before>{marks[key][0]})?(?P<word>{words[key]})(?P<after>{marks[key][1]})?")
            for key in NAMES}


PATTERNS = _word_patterns()


def parse_name(name: str, capitals: bool = False) -> ColumnMeaning | None:
    """Returns the meaning of a name alone, of which ``capitals`` mean nothing if all names are of these; None for
    unknown names, and for those in a unit that is none of theirs."""
    bare = name.strip().strip("\"'").translate(GREEK)
    if found := UNIT.match(bare):
        text = next(filter(None, found.groups()[1:]), "")
        known = _parse_word(found[1], capitals)
        if known is not None and not re.fullmatch(r"\d(,?\d)?", text):
            return _with_unit(known, text)
    known = _parse_word(bare, capitals)
    if known is None and (found := UNIT_AT_END.match(bare)) and (known := _parse_word(found[1], capitals)) is not None:
        return _with_unit(known, found[2])
    return known


def _with_unit(known: ColumnMeaning, text: str) -> ColumnMeaning | None:
    text = re.sub(r"[\s*·]|(?<=\D)\^(?=\d)", "", re.sub(r"_?per_?", "/", text))
    if text in ("", "-", "1", "SI"):
        return known
    unit = UNITS.get(known.key, {}).get(text)
    return None if unit is None else known._replace(unit=unit)


def _parse_word(name: str, capitals: bool) -> ColumnMeaning | None:
    """Returns the meaning of a name without a unit."""
    name = name.lower() if capitals else name
    prefix = OF_PARTICLES.match(name)
    for text in (name, *([name[prefix.end():]] if prefix else [])):
        text = re.sub(r"[\W_]", "", text)
        if found := COORDINATE.fullmatch(text):
            material = found[1].isupper() or found[2] in MATERIAL
            return ColumnMeaning("X" if material else "x", found[1].lower())
        if found := re.fullmatch(r"([Xx])([1-3])", text):  # 0 is above
            return ColumnMeaning(found[1], found[2])
        for key, pattern in PATTERNS.items():
            found = pattern.fullmatch(text.lower())
            if found and (known := _known_word(key, found)) is not None and text != "T":  # a temperature
                return known
    return None


def _known_word(key: str, found: re.Match[str]) -> ColumnMeaning | None:
    """Returns the meaning of a match of :data:`PATTERNS`; None for a component that a quantity does not have."""
    before, word, after = found["before"] or "", found["word"], found["after"] or ""
    mark = before or after
    if (before and (after or len(word) < 3)) or (mark and key in SCALARS):
        return None
    if key in TENSORS:
        if len(mark) == 1 and len(word) < 3:
            return None  # s1 is a principal stress, fx a force
        mark = 2 * mark if len(mark) == 1 and mark.isalpha() else mark
        if word == "tau" and mark[:1] == mark[-1:]:
            return None
    return ColumnMeaning(key, mark)


def find_meanings(names: Iterable[str]) -> dict[str, ColumnMeaning]:
    """Returns the meaning of those names of a file that are known, in their order. What a name means depends on the
    others: whether components are counted from 0 or 1, x0 is the first of them, and letters are large throughout."""
    named = list(names)
    capitals = not any(letter.islower() for name in named for letter in UNIT.sub(r"\1", name))
    known = {name: found for name in named if (found := parse_name(name, capitals)) is not None}
    _count_x0_with_x1(known)
    for keys in (("id", "row"), ("t",)):
        alike = [name for name in known if known[name].key in keys]
        first = min(alike, key=_rank, default=None)
        known = {name: found for name, found in known.items() if name not in alike or name == first}
    sigma = {found.component for found in known.values() if found.key == "sigma"}
    from_0 = {found.key for found in known.values() if "0" in found.component}
    meanings = {}
    for name, found in known.items():
        lowest = int(found.key not in from_0)
        component = _component_indices(found, lowest)
        if component != () and not (lowest and "4" not in sigma and PRINCIPAL.fullmatch(name)):
            meanings[name] = found._replace(component=component)
    return meanings


def _rank(name: str) -> int:
    """Returns the place of a name among those of its quantity; names with a prefix or a unit are the last."""
    text = re.sub(r"[\W_]", "", name).lower()
    words = [word for key in ("id", "row", "t") for word in NAMES[key]]
    return words.index(text) if text in words else len(words)


def _count_x0_with_x1(known: dict[str, ColumnMeaning]) -> None:
    """Changes x0 to the first component of the position where there is an x1, too, as in x0, x1, x2."""
    for key in ("x", "X"):
        if any(found.key == key and found.component == "1" for found in known.values()):
            for name, found in known.items():
                if re.sub(r"[\W_]", "", name) in (f"{key}0", f"{key.upper()}0"):
                    known[name] = found._replace(key=key, component="0")


def _component_indices(known: ColumnMeaning, lowest: int) -> tuple[int, ...] | int | None:
    """Returns the indices of a component whose digits count from ``lowest``, or its place in a row, None for a whole;
    () for a component that there is not."""
    if not known.component:
        return None
    if known.component.isalpha():
        return tuple(LETTERS.index(letter) for letter in known.component)
    digits = tuple(int(digit) - lowest for digit in known.component)
    if known.key in TENSORS and len(digits) == 1:
        return digits[0] if 0 <= digits[0] < 9 else ()
    return digits if all(0 <= digit < 3 for digit in digits) else ()


def is_unit(text: str) -> bool:
    """Returns whether a text is a unit of one of the quantities."""
    return any(_with_unit(ColumnMeaning(key), text) is not None for key in UNITS)


def is_known_name(name: str) -> bool:
    """Returns whether an array of this name may be read: particles' quantities, the number of cells, the scene."""
    return name in OF_THE_FILE[:2] or bool(parse_name(name) or parse_name(name, True))


def describe_columns(key: str, dimensions: int) -> str:
    """Returns the column names of a quantity in so many ``dimensions``, with commas, for a sentence."""
    names = output_column_names(key, dimensions)
    return ", ".join(name for name in names if name != "syx")  # one of sxy and syx is enough


def output_column_names(key: str, dimensions: int) -> list[str]:
    """Returns the names of the columns that we write for a quantity, in the order of its components."""
    letters = LETTERS[:dimensions]
    if key in VECTORS:
        return [{"X": letter.upper(), "x": letter, "v": f"v{letter}"}[key] for letter in letters]
    return [f"{'s' if key == 'sigma' else 'F'}{i}{j}" for i in letters for j in letters]
