"""``mpm-lab export LESSON|SCENE --out FILE.html``: one file that plays from disk, without a server or a network."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

import tyro

from app.commands.flags import BadInput, NumberFlag, Switch, TextFlag, default_hint
from app.commands.lesson import lesson_called
from app.commands.output import Target, say
from app.commands.progress import working
from app.export.lattice import within_reach
from app.language.spoken import ENGLISH, LANGUAGES, speaking
from app.lessons.lesson import LessonError
from app.state import StateError, begins, read
from solvers.scene.rules import require_choice, require_whole


@dataclass(frozen=True)
class Export:
    """Write a lesson or a scene as one HTML file that plays offline.

    WHAT is a lesson, by name or number, or a scene such as "bar cells=80 error-of=sigma". The file holds recorded
    runs, for the sliders too, and needs nothing else: neither this program nor a network. In a lesson's file stand
    the expected answers as well, for whoever reads its source.
    Exit status: 0 ok, 1 could not run or write, 2 bad input.
    """

    EXAMPLE: ClassVar[str] = "mpm-lab export 4 --out crossing.html"

    what: Annotated[TextFlag, tyro.conf.Positional]
    """A lesson or a scene."""
    out: TextFlag
    """File to write, .html."""
    core: Annotated[Switch, default_hint("off")] = False
    """A lesson's file begins with the core alone; its reader may choose all."""
    lang: TextFlag = ENGLISH
    """Language of the file: en or de; a lesson that is not in it keeps its own words."""
    processes: NumberFlag = 2
    """Processes that run scenes."""
    quiet: Annotated[Switch, default_hint("off")] = False
    """No progress bar."""

    def execute(self) -> int:
        require_whole("processes", self.processes, 1, 64)
        require_choice("lang", self.lang, tuple(LANGUAGES))
        is_scene = begins(self.what)
        if is_scene and self.core:
            raise BadInput("core", self.what, "a scene has no core; give a lesson, by name or number")
        if is_scene:
            try:
                scene = read(self.what).scene
            except StateError as error:
                raise BadInput("", self.what, str(error)) from None
            if refusal := within_reach(scene):
                raise BadInput("", self.what, refusal)
        name = self.what if is_scene else lesson_called(self.what)
        target = Target("out", self.out, ending=".html")
        # Imports here: bad input and --help must not wait for the page's.
        with working(self.quiet) as show, speaking(self.lang):
            if is_scene:
                from app.export.page import scene_page
                page = scene_page(name, self.processes, show).encode()
            else:
                from app.export.lesson import lesson_page
                from app.lessons import shelf
                try:
                    lesson = shelf.lesson(name)
                except LessonError as error:
                    raise BadInput("", name, str(error)) from None
                page = lesson_page(lesson, self.processes, show, core=self.core).encode()
        target.write(page)
        say(f"{target.text}: {len(page) / 1e6:.1f} MB")
        return 0
