"""The flags that say what a scene is, shared by every command that runs some."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Annotated, Any, ClassVar

from app.commands.flags import BadInput, NumberFlag, RealFlag, choice_flag, default_hint, list_flag
from solvers.scene import DEFAULT_CFL, EFFECTS, ESTIMATORS, FLAGS, Arch, Scene

SCENE_FIELDS = {key: field for field, key in FLAGS.items()}


def periods_flag(scene: type[Scene]) -> Any:
    """The type of --periods, whose default is the problem's."""
    return Annotated[RealFlag, default_hint(f"{scene.DEFAULT_PERIODS:g} without --t-end")]


def sample_every_flag(scene: type[Scene]) -> Any:
    """The type of --sample-every, whose default is the problem's."""
    return Annotated[NumberFlag, default_hint(f"about {scene.SAMPLES_A_PERIOD} samples a period")]


@dataclass(frozen=True, kw_only=True)
class SceneFlags:
    """The flags of every problem's scene, in the order of the help. A problem fills in the defaults.

    Every field but those in ``OUTPUT`` is an input of ``SCENE``, which checks it.
    """

    SCENE: ClassVar[type[Scene]]
    OUTPUT: ClassVar[frozenset[str]] = frozenset()

    method: Any
    cells: NumberFlag
    ppc: NumberFlag
    amplitude: RealFlag
    modulus: RealFlag
    density: RealFlag
    dt: Annotated[RealFlag, default_hint("from --cfl")] = None
    """Time step, s; instead of --cfl."""
    cfl: Annotated[RealFlag, default_hint(f"{DEFAULT_CFL} without --dt")] = None
    """Time step as dt c/h, no unit, c = sqrt(E/density); instead of --dt."""
    t_end: Annotated[RealFlag, default_hint("from --periods")] = None
    """End of the run, s; instead of --periods."""
    periods: Any = None
    body_force: Any
    linearity_preserving: bool = False
    velocity: Any
    estimator: list_flag((*ESTIMATORS, "none")) = Scene.estimators
    """Error estimators, one or several."""
    effects: Annotated[list_flag((*EFFECTS, "all", "none")), default_hint("all")] = EFFECTS
    """What to compute beside the method, with commas between; what is left out costs nothing."""
    arch: choice_flag(Arch) = Scene.arch
    """Processor to run on."""
    threads: NumberFlag = Scene.threads
    """Processor threads, at most."""
    sample_every: Any = None

    def scene(self) -> Scene:
        """The scene that the flags describe; the scene itself checks it."""
        return self.SCENE(**{SCENE_FIELDS.get(key, key): value for key, value in self.inputs().items()})

    def inputs(self) -> dict[str, Any]:
        """What was given for each input of a scene, by the name of its flag."""
        values = {f.name: getattr(self, f.name) for f in fields(self) if f.name not in self.OUTPUT}
        values["estimator"] = _expand("estimator", self.estimator, {"none": ()})
        values["effects"] = _expand("effects", self.effects, {"none": (), "all": EFFECTS})
        return values


def _expand(flag: str, words: tuple[str, ...], special: dict[str, tuple[str, ...]]) -> tuple[str, ...]:
    """Words with the special ones, which must stand alone, replaced by what they mean."""
    if not words:
        raise BadInput(flag, "", "give one or several names (--help lists them)")
    for word in words:
        if word in special:
            if len(words) > 1:
                raise BadInput(flag, " ".join(words), f"{word} stands alone; leave it or the others out")
            return special[word]
    return words
