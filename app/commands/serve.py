"""``mpm-lab serve``: the page."""

from dataclasses import dataclass

from app.commands.flags import BadInput, NumberFlag, TextFlag
from solvers.rules import require_whole


@dataclass(frozen=True)
class Serve:
    """Serve the page to browsers until Ctrl-C."""

    host: TextFlag = "127.0.0.1"
    """Address to listen on; 0.0.0.0 lets other machines in."""
    port: NumberFlag = 8080
    """Port to listen on."""
    max_sessions: NumberFlag = 40
    """Visitors served at the same time; one more is asked to wait."""
    warm_up: bool = True
    """Compile what visitors usually ask for before they do; takes a processor for some minutes the first time."""

    def execute(self) -> int:
        """Serve until stopped."""
        if not self.host:
            raise BadInput("host", self.host, "give the name or the address of this machine")
        if not isinstance(self.port, int) or not 1 <= self.port <= 65535:
            raise BadInput("port", self.port, "give a whole number from 1 to 65535")
        require_whole("max_sessions", self.max_sessions, 1, 10_000)
        from app.page.serve import ServeError, serve  # here: bad input and --help must not wait for the page's imports
        try:
            serve(self.host, self.port, self.max_sessions, self.warm_up)
        except ServeError as error:
            raise BadInput("port", self.port, str(error)) from error
        return 0
