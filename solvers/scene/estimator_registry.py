"""Registry of all estimators: name, appearance and explanation of each.

A problem's scene lists its estimators (``ESTIMATORS``), and its ``state.py`` their hooks, which the solver calls.
Modules named in the environment variable ``MPM_LAB_EXTENSIONS``, which every process imports, can add more with
:func:`register`. This module imports no Taichi, so that the command line and the page can use it.
"""

import functools
import html
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from solvers.scene import extension_modules
from solvers.scene.estimator_hooks import EstimatorHooks
from solvers.scene.estimator_limits import Limit
from solvers.scene.validation import SceneError
from solvers.translatable_message import Message

EXPLANATIONS = Path(__file__).parents[1] / "estimators" / "explanations"
#: Transport's defects are those of weights that follow the particles.
MOVING_WEIGHTS = Limit("transport", "frozen", allowed=(False,), why="transport assumes weights that are computed anew "
                       "each step, and with frozen-weights estimates 2 to 20,000 times the error; leave that remedy "
                       "out, or take recovered or companion")
#: Estimators of which a scene has the first that its problem offers, unless it names others. Measured with every method
#: in the usual scenes: companion is valid in all of them, its indices are 0.99 to 1.01, and it is the cheaper one.
DEFAULT_JUDGES = ("companion", "recovered")
COMPANION = "companion"  # subtracting its estimate leaves its own solution, and no MPM
#: Reasons why an estimator is known not to hold, shared by several problems.
PROCESSOR_REASON = ("{name} works on the particles in every step, which is not built for a GPU; take companion, which "
                    "the processor solves beside them, or --arch cpu")
HALF_REASON = "the second run has half the cells, and half of {scene.cells} is too few; give {least} or more"
REMEDIES_REASON = "the second run takes no remedies, so that it is a run of another method; leave {names} out"


@dataclass(frozen=True)
class Estimator:
    """Registry entry of an estimator, for all problems.

    ``colour`` is a warm one, for the truth is blue, and differs from the others' in lightness too; ``dashes`` are
    pixels drawn and left out (none: unbroken), ``symbol`` is its mark in pictures (``o``, ``s``, ``^``, ``D``, ``v``,
    ``P``, ``X``, ``*``). ``summary`` is one line, ``page`` its full explanation in HTML, by default that of the file
    ``explanations/NAME.html``. ``hooks`` maps problems without hooks of their own to hooks. ``refusals`` maps problems
    that do not support it to the reason, as the end of a sentence: "is not ...".
    """

    name: str
    summary: str
    colour: str
    dashes: tuple[int, ...] = ()
    symbol: str = "o"
    label: str = ""
    page: str = ""
    hooks: Mapping[str, EstimatorHooks] = field(default_factory=dict)
    refusals: Mapping[str, str] = field(default_factory=dict)
    beside_gpu: bool = False  # whether the processor can run it beside particles that are on a GPU
    judges: bool = False

    @property
    def title(self) -> str:
        """Name shown to users."""
        return self.label or self.name

    @property
    def explanation(self) -> str:
        """HTML text for a student: what it is, assumes, sees and misses."""
        return self.explanation_in("en")

    def explanation_in(self, language: str) -> str:
        """Returns the explanation in the language with this code, such as ``de``, or in English where there is none."""
        files = (EXPLANATIONS / f"{self.name}.{language}.html", EXPLANATIONS / f"{self.name}.html")
        file = next((file for file in files if file.exists()), None)
        return self.page or (file.read_text(encoding="utf-8") if file else f"<p>{html.escape(self.summary)}</p>")


ESTIMATORS: dict[str, Estimator] = {estimator.name: estimator for estimator in (
    Estimator("transport", "the paper's: sends the error of the gradient mapping through the method's own equations",
              colour="#cf5a00", symbol="o"),  # judges nothing: its size is often off by several times
    Estimator("recovered", "smooths the particles' motion and compares it with the equation of motion",
              colour="#6b2a00", dashes=(7, 3), symbol="s", judges=True),
    Estimator("companion", "a hidden solution of the same problem, of higher order, compared with the "
              "particles", colour="#c97d00", dashes=(3, 3), symbol="^", beside_gpu=True, judges=True),
    Estimator("two-grid", "the same run on cells twice as wide beside it, and Richardson's extrapolation",
              colour="#b0156b", dashes=(9, 3, 2, 3), symbol="D", judges=True,
              refusals={"vortex": "is not available for the vortex: companion is cheaper and more accurate there, "
                        "because it solves along one radius, while two-grid runs a second ring"}),
)}


def register(estimator: Estimator) -> None:
    """Makes an estimator known to scenes, solvers, page and pictures. Raises RuntimeError where the solver of a problem
    in its ``hooks`` has been imported: its kernels name what estimators keep. Register first."""
    extension_modules.require_before_solver_import(estimator.name, estimator.hooks)
    ESTIMATORS[estimator.name] = estimator
    names.cache_clear()


@functools.cache  # used by every scene
def names(problem: str, own: tuple[str, ...]) -> tuple[str, ...]:
    """Returns the names of a problem's estimators: its ``own`` and registered ones. Raises
    :class:`~solvers.scene.extension_modules.ExtensionError` where an extension cannot be imported."""
    extension_modules.load_extensions()
    return tuple(name for name, estimator in ESTIMATORS.items() if name in own or problem in estimator.hooks)


def default_estimators(own: tuple[str, ...]) -> tuple[str, ...]:
    """Returns the estimator of scenes that name none: the first default judge, or else the first of a problem's
    ``own``."""
    return (*(name for name in DEFAULT_JUDGES if name in own), *own)[:1]


def require_offered(chosen: object, problem: str, offered: tuple[str, ...]) -> None:
    """Raises :class:`SceneError`, with the estimator's own reason, for a ``chosen`` one that the problem refuses; the
    sentence lists those ``offered``."""
    for name in chosen if isinstance(chosen, tuple) else ():
        estimator = ESTIMATORS.get(name) if isinstance(name, str) else None
        if estimator and name not in offered and problem in estimator.refusals:
            raise SceneError("estimators", name, "{refusals}; give one of {offered}",
                             Message(estimator.refusals[problem]), ", ".join((*offered, "none")))


def require_corrector(name: object, offered: tuple[str, ...]) -> None:
    """Raises :class:`SceneError` for a name that is not that of an estimator, of those ``offered``, whose estimate may
    be subtracted from a result: its size must be reliable."""
    if name not in (correctors := [one for one in offered if ESTIMATORS[one].judges]):
        raise SceneError("corrected", name, "corrects no result here; give one of {correctors}", ", ".join(correctors))


def hooks_of(problem: str, own: Mapping[str, EstimatorHooks]) -> dict[str, EstimatorHooks]:
    """Returns the hooks of all estimators of a problem, by estimator: its ``own`` and registered ones."""
    found = names(problem, tuple(own))  # loads the extensions
    extension_modules.COMPILED_PROBLEMS.add(problem)
    return {name: ESTIMATORS[name].hooks.get(problem) or own[name] for name in found}
