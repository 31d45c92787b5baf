"""``mpm-lab serve``: the page."""

from dataclasses import dataclass
from typing import ClassVar

from app.access.allowed_hosts import is_host_name, is_ip
from app.access.code_login import LONGEST, SHORTEST, normalise_code
from app.commands.lenient_flag_types import BadInput, NamesFlag, NumberFlag, Switch, TextFlag
from app.commands.lesson import full_lesson_name
from solvers.scene.validation import require_number, require_whole

MOST_FRAMES = 60


@dataclass(frozen=True)
class Serve:
    """Serve the page to browsers until Ctrl-C.

    Exit status: 0 ended, 1 could not start, 2 bad input, 130 stopped by Ctrl-C."""

    EXAMPLE: ClassVar[str] = "mpm-lab serve --port 9000"

    host: TextFlag = "127.0.0.1"
    """Address to listen on; 0.0.0.0 lets other machines in, with the class code."""
    port: NumberFlag = 8080
    """Port to listen on."""
    max_sessions: NumberFlag = 40
    """Visitors served at the same time; one more is asked to wait."""
    code: TextFlag = ""
    """Class code that visitors must know; without one it is made up, except on this machine alone."""
    name: NamesFlag = ()
    """Public names of the lab behind a proxy, with commas between, such as lab.school.example."""
    frames: NumberFlag = 30
    """Pictures a second that each visitor gets at most; fewer for a slow network: one has some 50 kB."""
    lesson: TextFlag = ""
    """Lesson that everyone is opened on, by name or number (mpm-lab lesson list)."""
    core: Switch = False
    """Lessons begin with their core alone; who has time may choose all of it."""
    teacher: Switch = False
    """Show the teacher's notes in lessons; where others come in, to those only who type a code of its own."""
    board: Switch = False
    """Show, at a link of its own, what the class says to the lesson, without names, and open its steps from there."""
    warm_up: bool = True
    """Compile what visitors usually ask for before they do; takes a processor for some minutes the first time."""

    def execute(self) -> int:
        host = self.host.strip("[]")
        if not is_ip(host) and (":" in host or not is_host_name(host)):
            raise BadInput("host", self.host, "give the name or the address of this machine")
        if not isinstance(self.port, int) or not 1 <= self.port <= 65535:
            raise BadInput("port", self.port, "give a whole number from 1 to 65535")
        fits = self.code.isprintable() and SHORTEST <= len(normalise_code(self.code)) <= LONGEST
        if self.code.strip() and not fits:
            raise BadInput("code", self.code, f"give {SHORTEST} to {LONGEST} letters and digits, or none")
        for name in self.name:
            if not is_host_name(name):
                raise BadInput("name", name, "give the name of a host, such as lab.school.example")
        require_whole("max_sessions", self.max_sessions, 1, 10_000)
        require_number("frames", self.frames, 0, MOST_FRAMES)
        lesson = full_lesson_name(self.lesson) if self.lesson.strip() else ""
        if self.board and not lesson:
            raise BadInput("", "--board", "needs --lesson with the name or number of a lesson (mpm-lab lesson list)")
        from app.page import page_server  # here: bad input and --help must not wait for the page's imports
        from app.page.listening_address import ServeError
        try:
            page_server.serve(host, self.port, self.max_sessions, self.warm_up, self.code.strip(), self.name,
                              self.frames, lesson, self.teacher, self.core, self.board)
        except ServeError as error:
            raise BadInput("port", self.port, str(error)) from error
        return 0
