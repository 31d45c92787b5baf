"""``mpm-lab serve``: the page."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from app.commands.flags import BadInput, NumberFlag, TextFlag


@dataclass(frozen=True)
class Serve:
    """Serve the page to browsers until Ctrl-C."""

    host: TextFlag = "127.0.0.1"
    """Address to listen on; 0.0.0.0 lets other machines in."""
    port: NumberFlag = 8080
    """Port to listen on."""
    max_sessions: NumberFlag = 40
    """Visitors served at the same time; one more is asked to wait."""

    def execute(self) -> int:
        """Serve until stopped."""
        if not self.host:
            raise BadInput("host", self.host, "give the name or the address of this machine")
        _require_whole("port", self.port, 1, 65535)
        _require_whole("max-sessions", self.max_sessions, 1, 10_000)
        from app.page.serve import ServeError, serve  # here: bad input and --help must not wait for the page's imports
        try:
            serve(self.host, self.port, self.max_sessions)
        except ServeError as error:
            raise BadInput("port", self.port, str(error)) from error
        return 0


def _require_whole(flag: str, value: Any, least: int, most: int) -> None:
    if not isinstance(value, int) or not least <= value <= most:
        raise BadInput(flag, value, f"give a whole number from {least} to {most}")
