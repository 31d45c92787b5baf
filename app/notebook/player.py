"""The offline player below a notebook cell: the page of ``mpm-lab export``, complete in a frame.

It needs no server and no network, so it plays wherever a notebook shows HTML, and in one that is sent around."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from html import escape
from pathlib import Path

from app.export.html_file import recorded_page, scene_page
from app.export.slider_grid import why_too_long_to_record
from app.names_and_units import QUANTITIES, in_a_line
from app.shareable_state import State, write_state
from solvers.running.result import Result
from solvers.scene.scene import Scene
from solvers.scene.validation import SceneError, require_choice, require_whole

HEIGHT = 640  # pixels: a bar's readout, stage and timeline without scrolling, in a cell 800 wide
LEAST_HEIGHT, MOST_HEIGHT = 200, 4000
#: Permissions of the page in the frame: its own scripts and downloads. Without an origin it cannot read the notebook.
SANDBOX = "allow-scripts allow-downloads"


@dataclass(frozen=True, repr=False)
class Player:
    """A recorded run of ``scene`` as one HTML ``page``, which a notebook shows in a frame ``height`` pixels high."""

    scene: Scene
    page: str
    height: int = HEIGHT

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the page, as ``mpm-lab export`` does: it plays from disk, without a network."""
        Path(path).write_text(self.page, encoding="utf-8")

    def __repr__(self) -> str:
        return f"<player of {in_a_line(self.scene)}; seen in a notebook, or in a browser after .save(\"run.html\")>"

    def _repr_html_(self) -> str:
        style = f"display: block; width: 100%; height: {self.height}px; border: 0"
        return (f"<iframe srcdoc=\"{escape(self.page)}\" title=\"{escape(in_a_line(self.scene))}\" "
                f"sandbox=\"{SANDBOX}\" style=\"{style}\"></iframe>")


def show(what: Scene | Result, *, beside: Scene | Result | None = None, error_of: str = "x", sliders: bool = False,
         height: int = HEIGHT, processes: int = 2,
         on_progress: Callable[[float, str], None] = lambda part, doing: None) -> Player:
    """Records a run and plays it below the cell: particles by estimated and by true error, numbers, a timeline.

    Parameters
    ----------
    what
        A scene, or a result, whose scene is run again, as a result has only the final particles. A scene without an end
        is recorded for one period, or less if its problem's default is shorter.
    beside
        Another of the same problem, which plays beside it on the same scale.
    error_of
        The quantity whose error is coloured: "x", "v", "sigma" or "a".
    sliders
        Whether to record other cells, amplitudes and methods as well: up to sixty runs, by so many ``processes``,
        without estimators that only the notebook has registered. It takes about half a minute.
    height
        Height of the frame, 200 to 4000 pixels.
    on_progress
        Called with the part done (0 to 1) and a description.

    Raises
    ------
    SceneError
        If ``what`` is no scene or result, the quantity is unknown, the problems differ, or a run is too long to record.
    """
    scene, other = _scene("show", what), None if beside is None else _scene("beside", beside)
    require_choice("error_of", error_of, tuple(QUANTITIES))
    require_whole("height", height, LEAST_HEIGHT, MOST_HEIGHT)
    require_whole("processes", processes, 1, 64)
    if other is not None and other.problem != scene.problem:
        raise SceneError("beside", other.problem, f"is another problem; give one of the {scene.problem}")
    for one in (scene, other):
        if one is not None and (refusal := why_too_long_to_record(one)):
            raise SceneError("scene", in_a_line(one), refusal)
    shown = State(scene, quantity=error_of, pinned=other)
    page = scene_page(write_state(shown), processes, on_progress) if sliders else recorded_page(shown)
    return Player(scene, page, height)


def _scene(name: str, given: object) -> Scene:
    if isinstance(given, Result):
        return given.scene
    if isinstance(given, Scene):
        return given
    raise SceneError(name, given, "is neither a scene, such as BarScene(), nor the result of a run")
