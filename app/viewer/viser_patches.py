"""Corrections of the viewer in this process: how fast it makes widgets, and how callbacks fail and speak."""

import asyncio
from concurrent.futures import Executor, Future
from functools import cached_property, lru_cache
from types import SimpleNamespace
from typing import Any
from zipfile import ZipFile

from viser import _gui_api, _gui_handles, _icons, _threadpool_exceptions
from viser._assignable_props_api import AssignablePropsBase
from viser.infra._messages import get_type_hints_cached

from app.access.log_limit import log_failure
from app.language.translation import current_language, with_language

MESSAGE = "something that a visitor did could not be acted on"
_ICONS = _icons.ICONS_DIR / "tabler-icons.zip"


def mend_widgets() -> None:
    """Have widgets ask what is known of their kind, and take their icons from an archive that is opened once.

    The viewer works out anew with each widget what values its properties take, a third of the time that a page takes to
    make; and it opens the archive anew for each icon and reads some thousands of names, half a second for a page.
    """
    known = cached_property(kinds_of_values)
    known.__set_name__(AssignablePropsBase, "_prop_hints")
    AssignablePropsBase._prop_hints = known  # type: ignore[method-assign, assignment]
    for module in (_icons, _gui_api, _gui_handles):
        module.svg_from_icon = icon_svg  # type: ignore[attr-defined]


def kinds_of_values(widget: Any) -> dict[str, Any]:
    """What kinds of values a widget's properties take, worked out once for a kind of widget."""
    return get_type_hints_cached(type(widget._impl.props))  # type: ignore[arg-type]  # kinds can be looked up


@lru_cache(1)
def _archive() -> ZipFile:
    """Open from now on."""
    return ZipFile(_ICONS)


@lru_cache(256)
def icon_svg(name: str) -> str:
    """An icon by its name, as svg."""
    return _archive().read(f"{name}.svg").decode()


def mend_callbacks() -> None:
    """What the viewer prints when one of the page's callbacks fails, all of it each time, is one line of ours."""
    def print_exception(kind: type, error: BaseException, trace: object) -> None:
        log_failure(MESSAGE, error)

    viewers: Any = _threadpool_exceptions
    viewers.traceback = SimpleNamespace(print_exception=print_exception)
    viewers.print = lambda *_, **__: None  # in front of it


def of_loop(loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
    """The same for what fails in a loop's own callbacks, when nobody waits for them."""
    error = context.get("exception")
    if isinstance(error, Exception):
        log_failure(MESSAGE, error)


class _Carrying(Executor):
    """Does work as another one, in the language that was spoken when it was made."""

    def __init__(self, executor: Executor):
        self._executor, self._language = executor, current_language()

    def submit(self, work: Any, /, *args: Any, **options: Any) -> Future:
        return self._executor.submit(with_language(work, self._language), *args, **options)


def run_in_language(client: Any) -> None:
    """Lets callbacks of this visitor's widgets and stage speak the language that is spoken now."""
    for part in (client.gui, client.scene):
        part._thread_executor = _Carrying(part._thread_executor)
