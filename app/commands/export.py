"""``mpm-lab export LESSON|SCENE --out FILE.html``: an offline file; with ``--scorm`` a package for a course."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

import tyro

from app.commands.body import read_body_file
from app.commands.lenient_flag_types import BadInput, ProcessesFlag, Switch, TextFlag, default_hint, process_count
from app.commands.lesson import full_lesson_name
from app.commands.output import OutputTarget, print_message
from app.commands.progress import show_progress
from app.export.slider_grid import why_too_long_to_record
from app.language.translation import ENGLISH, LANGUAGES, use_language
from app.lessons.lesson import Lesson, LessonError
from app.shareable_state import StateError, looks_like_state, parse_state
from solvers.scene.validation import require_choice


@dataclass(frozen=True)
class Export:
    """Write a lesson, a scene or a body as one HTML file that plays offline.

    WHAT is a lesson, by name or number, a scene such as "bar cells=80 error-of=sigma", or a body's file, .toml. What
    is written holds recorded runs, for the sliders too, and needs nothing else: neither this program nor a network. In
    a lesson's file stand the expected answers as well, for whoever reads its source. With --scorm lessons become a
    package for Moodle and its like, one part a lesson: "mpm-lab export 1 4 8 --scorm --out course.zip".
    Exit status: 0 ok, 1 could not run or write, 2 bad input."""

    EXAMPLE: ClassVar[str] = "mpm-lab export 4 --out crossing.html"

    what: Annotated[TextFlag, tyro.conf.Positional]
    """A lesson, a scene or a body's file; with --scorm one or more lessons."""
    out: TextFlag
    """File to write, .html; with --scorm .zip."""
    scorm: Annotated[Switch, default_hint("off")] = False
    """A package for a course's own system (SCORM 1.2), which is told score, completion and answers."""
    core: Annotated[Switch, default_hint("off")] = False
    """A lesson's file begins with the core alone; its reader may choose all."""
    lang: TextFlag = ENGLISH
    """Language of the file: en or de; a lesson that is not in it keeps its own words."""
    processes: ProcessesFlag = None
    """Processes that run scenes."""
    quiet: Annotated[Switch, default_hint("off")] = False
    """No progress bar."""

    def execute(self) -> int:
        processes = process_count(self.processes)
        require_choice("lang", self.lang, tuple(LANGUAGES))
        names = self._lesson_names()
        target = OutputTarget("out", self.out, ending=".zip" if self.scorm else ".html")
        with show_progress(self.quiet) as show, use_language(self.lang):
            from app.export import html_file, lesson_export  # here: bad input and --help must not wait for them
            lessons = [_load_lesson(name) for name in names]
            if self.scorm:
                content = lesson_export.make_scorm_package(lessons, processes, show, core=self.core)
            elif lessons:
                content = lesson_export.lesson_page(lessons[0], processes, show, core=self.core).encode()
            elif self.what.endswith(".toml"):
                from app.export.body_page import body_page
                try:
                    content = body_page(self.what, show).encode()
                except ValueError as error:
                    raise BadInput("", self.what, str(error)) from None
            else:
                content = html_file.scene_page(self.what, processes, show).encode()
        target.write(content)
        print_message(f"{target.text}: {len(content) / 1e6:.1f} MB")
        return 0

    def _lesson_names(self) -> list[str]:
        """Returns the full names of the lessons, [] for a scene; raises BadInput for what cannot be exported."""
        if self.what.endswith(".toml"):
            if self.scorm or self.core:
                raise BadInput("", self.what, "is a body; --scorm and --core are for lessons")
            read_body_file(self.what)
            return []
        if self.scorm:
            if not self.what.strip() or looks_like_state(self.what):
                raise BadInput("", self.what, "is no lesson, and a course keeps a score of lessons alone; give lessons "
                                              "by name or number")
            return list(dict.fromkeys(map(full_lesson_name, self.what.split())))
        if not looks_like_state(self.what):
            if len(self.what.split()) > 1:
                raise BadInput("", self.what, "is no scene, and a file has one lesson; give one, or --scorm for a "
                                              "package of several")
            return [full_lesson_name(self.what)]
        if self.core:
            raise BadInput("core", self.what, "a scene has no core; give a lesson, by name or number")
        try:
            scene = parse_state(self.what).scene
        except StateError as error:
            raise BadInput("", self.what, str(error)) from None
        if refusal := why_too_long_to_record(scene):
            raise BadInput("", self.what, refusal)
        return []


def _load_lesson(name: str) -> Lesson:
    from app.lessons import catalogue
    try:
        return catalogue.load_lesson(name)
    except LessonError as error:
        raise BadInput("", name, str(error)) from None
