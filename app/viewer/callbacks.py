"""What the viewer does when a visitor uses a widget, on threads of all visitors: in this one's language."""

from concurrent.futures import Executor, Future
from typing import Any

from app.language.spoken import carried, language


class _Carrying(Executor):
    """Does work as another one, in the language that was spoken when it was made."""

    def __init__(self, executor: Executor):
        self._executor, self._language = executor, language()

    def submit(self, work: Any, /, *args: Any, **options: Any) -> Future:
        return self._executor.submit(carried(work, self._language), *args, **options)


def speak(client: Any) -> None:
    """From now on callbacks of this visitor's widgets and stage speak the language that is spoken now. The viewer has
    no setting for it."""
    for part in (client.gui, client.scene):
        part._thread_executor = _Carrying(part._thread_executor)
