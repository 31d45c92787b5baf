"""Names, units, symbols and number formats, common to the command line, the page and all pictures."""

import functools
import json
import math
import re
import shlex
from collections.abc import Iterable
from dataclasses import dataclass, fields
from pathlib import Path

from app.language.translation import (
    LANGUAGES,
    current_language,
    language_cache,
    lazy,
    localise_number,
    localise_numbers,
    tr,
    translate_message,
    trn,
)
from solvers.problems import PROBLEMS
from solvers.scene import error_causes
from solvers.scene.scene import AUTO, DEFAULT_CFL, Scene
from solvers.scene.stabilisations import REMEDIES
from solvers.scene.validation import field_flag, field_label
from solvers.untrusted import number_parsing

NOTHING = "–"
PREFIXES = {-4: "p", -3: "n", -2: "µ", -1: "m", 0: "", 1: "k", 2: "M", 3: "G"}  # by powers of a thousand
PLAIN_RATIOS = (0.095, 1000.0)  # range of ratios with two decimals
PLAIN_PERCENT, WHOLE_PERCENT = (1e-3, 1e6), 9.95  # range of plain percentages; from the last on without decimals
PLAIN_POWERS = (-1, 2)  # range of powers of ten that are not factored out
SUPERSCRIPTS = dict(zip("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹", strict=True))


@dataclass(frozen=True)
class MethodName:
    """Name of a method: short, such as "uGIMP", and in ``full``, "" where that is the same."""

    name: str
    full: str = ""

    def __str__(self) -> str:
        return tr(self.full) if self.full else self.name


METHODS = {"mpm": MethodName("MPM", lazy("MPM (hat functions)")), "ugimp": MethodName("uGIMP"),
           "cpgimp": MethodName("cpGIMP"),
           "cpgimp-v": MethodName("cpGIMP (V)", lazy("cpGIMP with the spatial stretch V")),
           "bspline": MethodName("B-spline"), "cpdi": MethodName("CPDI")}


@dataclass(frozen=True)
class Quantity:
    """Quantity whose error is shown: its English name, symbol and SI unit."""

    name: str
    symbol: str
    unit: str

    @property
    def noun(self) -> str:
        """The name in the current language."""
        return tr(self.name)

    def __str__(self) -> str:
        return f"{self.noun} {tr(self.symbol)}"


#: By key in samples and results, in the order of the error columns.
QUANTITIES = {"x": Quantity(lazy("displacement"), "x", "m"), "v": Quantity(lazy("velocity"), "v", "m/s"),
              "sigma": Quantity(lazy("stress"), "σ", "Pa"), "a": Quantity(lazy("acceleration"), "a", "m/s²")}
MAGNIFICATIONS = (1, 10, 100, 1000)  # of a field's deviation in its plot
#: Norms of single problems.
EXTRA_NORMS = {"sigma_log": Quantity("stress", "σ, E ln F", "Pa"),
               "a_nodes": Quantity("acceleration", lazy("a at nodes"), "m/s²")}
#: Fields left out of texts on a run, or described together, as those of the time step.
UNSAID = ("problem", "dt", "cfl", "t_end", "periods", "effects", "arch", "threads", "sample_every")
#: Symbols of a scene's sizes.
SYMBOLS = {"amplitude": "A", "modulus": "E", "density": "ρ", "stretch": "F", "initial_velocity": "v", "frequency": "B"}
#: Fields of most and of some problems.
OF_MOST = ("amplitude", "modulus", "density", "t_end", "periods", "body_force")
OF_SOME = ("motion", "stretch", "initial_velocity")
#: Labels of fields' choices, translated by :func:`choice_labels`, in the order in which they are offered.
CHOICES = {"method": {code: method.full or method.name for code, method in METHODS.items()},
           "body_force": {"material": lazy("at the particles"), "node": lazy("at the nodes"), "none": lazy("none"),
                          "two-tone": lazy("two tones")},
           "velocity": {"grid": lazy("grid velocity"), "particle": lazy("particle velocity"),
                        "corners": lazy("domain corners")},
           "motion": {"vibrate": lazy("vibration"), "patch": lazy("patch test")},
           "take_away": {error_causes.NOTHING: lazy("nothing"), **error_causes.CAUSES},
           "remedies": {remedy.name: remedy.label for remedy in REMEDIES.values()},
           "layout": {"polar": lazy("polar"), "cartesian": lazy("Cartesian")}}


def choice_labels(kind: type[Scene], field: str) -> dict[str, str]:
    """Returns the translated labels of the choices of a scene class's field, by value; one without label is its own."""
    allowed, words = kind.choices(field), CHOICES.get(field, {})
    return {code: tr(words[code]) for code in words if code in allowed} | {c: c for c in allowed if c not in words}


def unit_of(kind: type[Scene], field: str) -> str:
    """Returns the unit of a scene class's field, "m" or "rad" for an amplitude, "" for a field without unit."""
    return kind.__dataclass_fields__[field].metadata.get("unit", "")


def method_name(method: str) -> str:
    """Returns the short name of a method by its key, "cpGIMP" for "cpgimp"; an unknown key is its own name."""
    return METHODS[method].name if method in METHODS else method


def functions_name(method: str) -> str:
    """Returns the name of a method's shape functions by its key: "hat functions" for "mpm", "B-spline"."""
    return tr("hat functions") if method == "mpm" else method_name(method)


def main_settings_text(scene: Scene) -> str:
    """Describes grid, particles and motion of a run in few words: "40 cells, 4 a cell, A = 3.4 mm"."""
    per_each = tr("{said} a cell", said=per_cell(scene.problem, scene.ppc))
    return ", ".join([tr("{count} cells", count=scene.cells), per_each, _moved_by(scene)])


def motion_text(scene: Scene) -> str:
    """Describes what moves the material: "A = 25 mm"; for a patch test its stretch and velocity."""
    motion = scene.to_dict().get("motion")  # if the problem has several
    names = choice_labels(type(scene), "motion") if motion else {}
    unusual = [names[motion]] if motion and motion != type(scene)().to_dict()["motion"] else []
    return ", ".join([*unusual, _moved_by(scene)]) or tr(scene.title)


def _moved_by(scene: Scene) -> str:
    sizes = {field: (getattr(scene, field), unit_of(type(scene), field)) for field in scene.motion_fields}
    return ", ".join(f"{SYMBOLS[field]} = {with_unit(value, unit) if unit else localise_number(f'{value:g}')}"
                     for field, (value, unit) in sizes.items())


def in_a_line(scene: Scene) -> str:
    """Describes a run in a line of text: the main settings, and others that differ from the defaults."""
    said = ("method", "cells", "ppc", "amplitude", "estimators", *(name for name in OF_SOME if hasattr(scene, name)))
    more = difference_text(scene, type(scene)(**{name: getattr(scene, name) for name in said}))
    title, cells = tr(scene.title), tr("{count} cells", count=scene.cells)
    parts = str(METHODS[scene.method]), cells, particles_per_cell(scene.problem, scene.ppc), _moved_by(scene), more
    return f"{title[:1].upper()}{title[1:]}: {', '.join(filter(None, parts))}"


def per_cell(problem: str, ppc: float) -> str:
    """Formats particles per cell, counted along each direction of a problem: 4 on the bar, 2 × 2 in the plane."""
    return " × ".join([str(ppc)] * PROBLEMS[problem].scene.DIMENSIONS)


def particles_per_cell(problem: str, ppc: float) -> str:
    """Formats particles per cell as text: 1 particle per cell, 2 × 2 particles per cell."""
    said = per_cell(problem, ppc)
    return trn("{said} particle per cell", "{said} particles per cell", 1 if said == "1" else 2, said=said)


def reword_for_page(sentence: str) -> str:
    """Translates a sentence of the solvers, and replaces flags, methods and remedies in it by the widgets' labels."""
    sentence = translate_message(sentence)
    for typed, shown in ((tr("--dt auto takes"), tr("the box \"Auto step\" takes")),
                         (tr("the right --cells and --ppc"), tr("the right cells and particles per cell")),
                         (", cfl ", ", CFL "), (", or the flag --time with one time for each file", ""),
                         (", and --cells with one number for each file of several grids", "")):
        sentence = sentence.replace(typed, shown)
    labels = {remedy.name: tr("\"{name}\"", name=tr(remedy.label)) for remedy in REMEDIES.values()}
    name = "|".join(map(re.escape, labels))
    sentence = re.sub(rf"({name}),({name})", lambda found: _join_with_and(found[1], found[2]), sentence)
    sentence = re.sub(rf"({name}) (?={name})", r"\1, ", sentence)
    sentence = re.sub(name, lambda found: labels[found[0]], sentence)
    methods = "|".join(sorted(METHODS, key=len, reverse=True))
    return re.sub(rf"(?<!--method )\b({methods})\b(?!-lab)", lambda found: METHODS[found[0]].name, sentence)


@language_cache(64)  # called with every frame
def difference_text(scene: Scene, other: Scene) -> str:
    """Describes how a scene differs from another of its problem: "uGIMP, 40 cells, A = 25 mm"; "" if they are equal."""
    return ", ".join(mine for mine, theirs in zip(_settings(scene), _settings(other), strict=True) if mine != theirs)


def _settings(scene: Scene) -> list[str]:
    """Returns a short text for each setting of a run, in a fixed order: "40 cells"."""
    step = tr("CFL number {number:g}", number=DEFAULT_CFL if scene.cfl is None else scene.cfl)
    if scene.dt is not None:
        step = tr("auto step") if scene.dt == AUTO else tr("step {size}", size=with_unit(float(scene.dt), "s"))
    return [*(_field_text(scene, field.name, field.metadata["unit"]) for field in fields(scene)
              if field.name not in UNSAID), step]


def _field_text(scene: Scene, field: str, unit: str) -> str:
    value, label, names = getattr(scene, field), tr(field_label(field)), choice_labels(type(scene), field)
    if field == "take_away":
        return tr("as it is") if value == error_causes.NOTHING else \
            tr("without {cause}", cause=tr(error_causes.CAUSES[value]))
    if isinstance(value, bool):
        return label if value else tr("not {label}", label=label)
    if isinstance(value, tuple):
        told = functools.reduce(_join_with_and, (names[name] for name in value)) if value else ""
        return (told if field in CHOICES else f"{label} {told}") if value else tr("no {label}", label=label)
    if field == "cells":
        return tr("{count} cells", count=value)
    if field == "ppc":
        return particles_per_cell(scene.problem, value)
    if unit:
        return f"{SYMBOLS.get(field, label)} = {with_unit(value, unit)}"
    return names[value] if field in ("method", "velocity") else f"{label} {names.get(value, value)}"


def _join_with_and(several: str, last: str) -> str:
    return tr("{several} and {last}", several=several, last=last)


def command_line(scene: Scene) -> str:
    """Returns the command that runs the scene, with what differs from the defaults."""
    words = [f"mpm-lab run {scene.problem} --method {scene.method} --cells {scene.cells} --ppc {scene.ppc}",
             f"--dt {AUTO}" if scene.dt == AUTO else f"--cfl {scene.courant_number:g}"]
    kind = type(scene)
    for field in (*OF_MOST, *OF_SOME, "poisson_ratio", "frequency", "law", "displacement"):
        idle = field == "body_force" and not scene.swings
        if field in kind.__dataclass_fields__ and not idle and getattr(scene, field) != getattr(kind, field):
            words.append(f"--{field_flag(field)} {shlex.quote(str(getattr(scene, field)))}")
    if scene.linearity_preserving:
        words.append("--linearity-preserving")
    if scene.remedies:
        words.append(f"--remedies {','.join(scene.remedies)}")
    return " ".join(words)


def short_reason(reason: str) -> str:
    """Shortens a sentence why there is no estimate to "NAME is not valid here" if it says so; others stay."""
    not_valid = tr("not valid here")  # as the sentence says it
    name, found, _ = reason.partition(f": {not_valid}")
    return tr("{name} is not valid here", name=name) if found else reason


def format_number(value: float) -> str:
    """Formats a number to three significant digits: 0, 0.025, 1.5e-05."""
    return localise_number(f"{value:.3g}")


def format_coordinates(point: Iterable[float], digits: int = 3) -> str:
    """Formats coordinates with so many significant digits: "0.412, 0.103", in German "0,412; 0,103"."""
    return localise_numbers(", ".join(f"{x:.{digits}g}" for x in point))


def format_ratio(value: float) -> str:
    """Formats the ratio of an estimate to the truth: 0.36, 1.02, 6 × 10⁴."""
    if PLAIN_RATIOS[0] < value < PLAIN_RATIOS[1]:
        return localise_number(f"{value:.2f}")
    digits, _, power = f"{value:.1g}".partition("e")
    return f"{digits} × {format_power_of_ten(int(power)).strip()}" if power else localise_number(digits)


def format_factor(value: float) -> str:
    """Formats a factor to three digits: 0.386, 2.6, 13.7; beyond, as :func:`format_ratio`."""
    return format_number(value) if PLAIN_RATIOS[0] < value < PLAIN_RATIOS[1] else format_ratio(value)


def per_cent(share: float) -> str:
    """Formats a share to two digits: 0.29 %, 6.4 %, 53 %, 2,300 %; beyond, as :func:`format_ratio`."""
    percent = 100 * share
    if WHOLE_PERCENT <= percent < PLAIN_PERCENT[1]:
        return f"{localise_number(f'{percent:,.0f}')} %"
    plain = percent == 0 or PLAIN_PERCENT[0] < percent < PLAIN_PERCENT[1]
    return f"{localise_number(f'{percent:.2g}')} %" if plain else f"{format_ratio(percent)} %"


def power_of_ten(largest: float) -> int:
    """Returns the exponent of ten to factor out of numbers up to ``largest``: -4 for 3e-4, 0 where none is needed."""
    power = math.floor(math.log10(largest)) if 0 < largest < math.inf else 0
    return 0 if PLAIN_POWERS[0] <= power <= PLAIN_POWERS[1] else power


def format_power_of_ten(power: int) -> str:
    """Formats ten to this power: 10⁻⁴ and a space for -4, "" for 0."""
    return "" if power == 0 else "10" + "".join(SUPERSCRIPTS[sign] for sign in str(power)) + " "


def with_unit(value: float, unit: str, digits: int = 3) -> str:
    """Formats a value in this unit to so many digits, with an SI prefix if it is finite and not 0: 2.1 mm."""
    if not math.isfinite(value) or value == 0:
        return f"{localise_number(f'{value:g}')} {unit}"
    power = math.floor(math.log10(float(f"{abs(value):.{digits - 1}e}"))) // 3
    if power not in PREFIXES:
        return f"{localise_number(f'{value:.{digits - 1}e}')} {unit}"
    short = float(f"{value / 1000.0**power:.{digits}g}")
    return f"{localise_number(f'{short:g}')} {PREFIXES[power]}{unit}"


def clock_text(time: float) -> str:
    """Formats the present time in s: "0.25 s"; with a prefix if it is short."""
    return f"{format_number(time)} s" if time == 0 or time >= 1e-3 else with_unit(time, "s")


def in_periods(count: float) -> str:
    """Formats a number of periods to three digits, with the word: "2.5 periods"."""
    return trn("{count:g} period", "{count:g} periods", float(f"{count:.3g}"))


def number_format_script() -> str:
    """Returns the script that formats numbers in a browser as the functions above do here, in the current language."""
    formats = {"prefixes": PREFIXES, "superscripts": SUPERSCRIPTS, "ratios": PLAIN_RATIOS, "powers": PLAIN_POWERS,
               "percents": (*PLAIN_PERCENT, WHOLE_PERCENT), "nothing": NOTHING,
               "marks": LANGUAGES[current_language()].marks}
    script = Path(__file__).with_name("numbers.js").read_text(encoding="utf-8")
    return f"const NUMBER_FORMATS = {json.dumps(formats, ensure_ascii=False)};\n{script}"


def parse_size(text: str, unit: str) -> float:
    """Returns a size in this unit, 0.0021 for "2.1 mm", "2.1e-3" or "0,0021" in m; ValueError if it is not above 0."""
    prefixes = {prefix: power for power, prefix in PREFIXES.items()} if unit else {"": 0}
    found = re.fullmatch(rf"([+0-9.,eE-]+?)\s*(?:({'|'.join(prefixes)})({re.escape(unit)}))?", text.strip())
    if not found:
        raise ValueError(text)
    value = number_parsing.parse_float(found[1].replace(",", ".")) * 1000.0 ** prefixes[found[2] or ""]
    if not 0 < value < math.inf:
        raise ValueError(text)
    return float(f"{value:.12g}")
