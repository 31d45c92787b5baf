"""Patches of the viewer in this process: faster widgets, and logging and language of callbacks."""

import asyncio
from concurrent.futures import Executor, Future
from functools import cached_property, lru_cache
from types import SimpleNamespace
from typing import Any
from zipfile import ZipFile

from viser import _gui_api, _gui_handles, _icons, _threadpool_exceptions
from viser._assignable_props_api import AssignablePropsBase
from viser.infra._messages import get_type_hints_cached

from app.access.rate_limited_log import log_failure
from app.language.translation import current_language, with_language

MESSAGE = "something that a visitor did could not be acted on"
PLAIN = (str, bool, int, float)
_ICONS = _icons.ICONS_DIR / "tabler-icons.zip"
_cast_by_type: Any = AssignablePropsBase._cast_value_recursive


def speed_up_widgets() -> None:
    """Caches the property types of each kind of widget, leaves plain values as they are, and reads icons from an
    archive that is opened once.

    The viewer determines the property types for each widget again, a third of a page's creation time, compares those
    types with four others at each assignment, a fifth of the time of a refresh, and opens the archive for each icon
    and reads thousands of names, half a second per page."""
    known = cached_property(widget_property_types)
    known.__set_name__(AssignablePropsBase, "_prop_hints")
    AssignablePropsBase._prop_hints = known  # type: ignore[method-assign, assignment]
    AssignablePropsBase._cast_value_recursive = cast_widget_property  # type: ignore[method-assign, assignment]
    for module in (_icons, _gui_api, _gui_handles):
        module.svg_from_icon = icon_svg  # type: ignore[attr-defined]


def widget_property_types(widget: Any) -> dict[str, Any]:
    """Returns the types of a widget's properties by name, cached by kind of widget."""
    return get_type_hints_cached(type(widget._impl.props))  # type: ignore[arg-type]  # kinds can be looked up


def cast_widget_property(widget: Any, kind: Any, value: Any, name: str) -> Any:
    """Returns the value of a widget's property as its type ``kind`` requires: arrays as by the viewer, plain values as
    they are."""
    return value if type(value) in PLAIN else _cast_by_type(widget, kind, value, name)


@lru_cache(1)
def _icon_archive() -> ZipFile:
    """Returns the zip archive of the viewer's icons, which stays open."""
    return ZipFile(_ICONS)


@lru_cache(256)
def icon_svg(name: str) -> str:
    """Returns one of the viewer's icons as svg by its name."""
    return _icon_archive().read(f"{name}.svg").decode()


def log_callback_failures() -> None:
    """Makes the viewer log each failing callback of a widget in one line, instead of printing its traceback."""
    def print_exception(kind: type, error: BaseException, trace: object) -> None:
        log_failure(MESSAGE, error)

    viewers: Any = _threadpool_exceptions
    viewers.traceback = SimpleNamespace(print_exception=print_exception)
    viewers.print = lambda *_, **__: None  # printed before the traceback


def log_loop_failure(loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
    """Logs a failure in an event loop's own callbacks in one line; an asyncio exception handler."""
    error = context.get("exception")
    if isinstance(error, Exception):
        log_failure(MESSAGE, error)


class _LanguageExecutor(Executor):
    """Executor that runs work in another one, in the language current at its creation."""

    def __init__(self, executor: Executor):
        self._executor, self._language = executor, current_language()

    def submit(self, work: Any, /, *args: Any, **options: Any) -> Future:
        return self._executor.submit(with_language(work, self._language), *args, **options)


def set_callback_language(client: Any) -> None:
    """Makes callbacks of the widgets and stage of a viewer's ``client`` run in the language that is current now."""
    for part in (client.gui, client.scene):
        part._thread_executor = _LanguageExecutor(part._thread_executor)
