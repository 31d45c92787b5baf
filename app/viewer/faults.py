"""What the viewer prints when one of the page's callbacks fails, all of it each time, is one line of ours."""

import asyncio
from types import SimpleNamespace
from typing import Any

from viser import _threadpool_exceptions

from app.doors.faults import noted

MESSAGE = "something that a visitor did could not be acted on"


def mend() -> None:
    """From now on, in all of this process."""
    def print_exception(kind: type, error: BaseException, trace: object) -> None:
        noted(MESSAGE, error)

    viewers: Any = _threadpool_exceptions
    viewers.traceback = SimpleNamespace(print_exception=print_exception)
    viewers.print = lambda *_, **__: None  # in front of it


def of_loop(loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
    """The same for what fails in a loop's own callbacks, when nobody waits for them."""
    error = context.get("exception")
    if isinstance(error, Exception):
        noted(MESSAGE, error)
