"""A palette of small scenes: where a test needs any run of some kind, it takes one of these.

What a scene switches on is compiled, which takes seconds; what it runs takes tenths. So tests share switches:
``SCENES["ring"]`` is a run that all tests of a process share by way of the fixture ``simulate``, and
``like("ring", cells=24)`` is another with the same kernels. A scene of its own is for a test that is about its switches
or whose bound was measured there.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from solvers.problems.bar.scene import BarScene
from solvers.problems.ring import RingScene
from solvers.problems.vortex import VortexScene
from solvers.scene.remedies import COUPLED, FILTER, FROZEN, PIECES
from solvers.scene.scene import Scene
from solvers.scene.switches import combination

COMPANION = ("companion",)
#: Sound, as all of the palette are but those that are called otherwise.
BAR = BarScene(cells=20, ppc=2, amplitude=0.004, periods=0.2, estimators=COMPANION)
RING = RingScene(cells=12, amplitude=0.05, periods=0.5, cfl=0.2, estimators=COMPANION)
VORTEX = VortexScene(cells=16, ppc=2, amplitude=0.25, t_end=0.5, cfl=0.2, estimators=COMPANION)
BARE: dict[str, Any] = {"estimators": (), "effects": ()}
LOOKS: dict[str, Any] = {"estimators": (), "effects": ("truth", "soundness")}  # whether it ends well, and how far off

SCENES: dict[str, Scene] = {
    # Of each problem its own method and force, with a companion, with everybody who watches, and with nobody.
    "bar": BAR, "ring": RING, "vortex": VORTEX,
    "bar watched": replace(BAR, estimators=BarScene.ESTIMATORS, linearity_preserving=True),  # where all four hold
    "ring watched": replace(RING, estimators=RingScene.ESTIMATORS, cells=24),
    "vortex watched": replace(VORTEX, estimators=VortexScene.ESTIMATORS, cells=36),
    "bar bare": replace(BAR, **BARE), "ring bare": replace(RING, **BARE), "vortex bare": replace(VORTEX, **BARE),
    # Other methods, judged by the truth and by what contradicts itself.
    "bar mpm": replace(BAR, method="mpm", **LOOKS), "bar cpgimp": replace(BAR, method="cpgimp", **LOOKS),
    "bar bspline": replace(BAR, method="bspline", **LOOKS), "ring mpm": replace(RING, method="mpm", **LOOKS),
    "ring ugimp": replace(RING, method="ugimp", **LOOKS),
    "vortex cpgimp-v": replace(VORTEX, method="cpgimp-v", **LOOKS),
    # Remedies.
    "bar mended": replace(BAR, remedies=(FILTER, COUPLED), **LOOKS),
    "bar frozen": replace(BAR, remedies=(FROZEN,), **LOOKS), "bar pieces": replace(BAR, remedies=(PIECES,), **LOOKS),
    "ring mended": replace(RING, method="ugimp", remedies=(FILTER, COUPLED), **LOOKS),
    "ring frozen": replace(RING, method="ugimp", remedies=(FROZEN,), **LOOKS),
    "vortex filtered": replace(VORTEX, method="cpgimp-v", remedies=(FILTER,), **LOOKS),
    # Motions without a built-in solution, and one in which nothing should happen.
    "bar two-tone": replace(BAR, body_force="two-tone"), "ring two-tone": replace(RING, body_force="two-tone"),
    "vortex two-tone": replace(VORTEX, body_force="two-tone"),
    "bar patch": BarScene(motion="patch", cells=20, ppc=3, periods=0.5, estimators=COMPANION),
    # Another layout, which compiles nothing; slabs (on one thread: others restart Taichi); and runs that end badly.
    "ring cartesian": replace(RING, layout="cartesian"),
    "ring slabs": replace(RING, method="ugimp", plan="parallel", **LOOKS),
    "bar lost": BarScene(ppc=1, **LOOKS),
    "bar unstable": BarScene(method="mpm", cells=20, cfl=1.5, **LOOKS),
}


def like(name: str, **numbers: Any) -> Scene:
    """A scene of the palette with other numbers, which compiles nothing that the palette's own does not."""
    scene = replace(SCENES[name], **numbers)
    assert combination(scene) == combination(SCENES[name]), f"{numbers} compile another {name}"
    return scene
