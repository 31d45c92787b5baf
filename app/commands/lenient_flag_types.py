"""Flags that accept anything, so that errors come from the code that knows the valid range.

A number that does not parse stays text: ``Scene`` then reports what is wrong and what is allowed, in one line, as for a
number out of range. Therefore these flags take any number of words, and no range is repeated here."""

import os
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from typing import Annotated, Any

import tyro

from solvers.scene.validation import require_whole
from solvers.untrusted import number_parsing, quoting
from solvers.workers.cpu_count import MOST_PROCESSES, default_processes

MOST_FILES = 10_000


class BadInput(Exception):
    """Raised for unusable input: ``flag`` without dashes ("" if it is none), its value, and what is wrong with it. The
    ``sentence`` stands alone where there is neither."""

    def __init__(self, flag: str, value: object, sentence: str):
        self.flag, self.value, self.sentence = flag, value, sentence
        what = f"{f'--{flag} ' if flag else ''}{quoting.quote(value)}: " if flag or value else ""
        super().__init__(quoting.one_line(f"{what}{sentence}"))


def _lenient_parser(metavar: str, parse: Callable[[list[str]], Any]) -> Any:
    """Returns a tyro constructor that gives any number of words to ``parse``; help shows the ``metavar``."""
    return tyro.constructors.PrimitiveConstructorSpec(
        nargs="*", metavar=metavar, instance_from_str=parse, is_instance=lambda value: True,
        str_from_instance=lambda value: list(map(str, value)) if isinstance(value, tuple) else [quoting.quote(value)])


def parse_number_or_text(words: list[str], reader: Callable[[str], float] = number_parsing.parse_number) -> Any:
    """Returns an integer or float, as ``reader`` does, if the words, with spaces between, are one, else that text."""
    text = " ".join(words)
    try:
        return reader(text)
    except ValueError:
        return text


parse_float_or_text = partial(parse_number_or_text, reader=number_parsing.parse_float)


def _split_words(words: list[str]) -> tuple[str, ...]:
    """Splits words at commas, spaces or both."""
    return tuple(word for group in words for word in group.replace(",", " ").split())


def one_of(choices: Iterable[str]) -> Any:
    """Returns the metadata for ``Annotated[Any, ...]`` of a flag with one of the choices; its value is any text."""
    return _lenient_parser("{" + ",".join(choices) + "}", " ".join)


def several_of(choices: Iterable[str]) -> Any:
    """Returns the metadata for ``Annotated[Any, ...]`` of a flag with several words; its value is a tuple of texts."""
    return _lenient_parser("{" + ",".join(choices) + "} ...", _split_words)


def choices_of(choices: Iterable[str], default: str, text: str) -> Any:
    """Returns the type of a flag with several of the choices, the help ``text``, and "(default: ...)" after it."""
    return Annotated[Any, several_of(choices), default_hint(default), tyro.conf.arg(help=text)]


def default_hint(text: str) -> Any:
    """Returns the metadata for ``Annotated`` that shows "(default: text)" in a flag's help."""
    return tyro.conf.arg(help_behavior_hint=f"(default: {text})")


NumberFlag = Annotated[Any, _lenient_parser("N", parse_number_or_text)]
RealFlag = Annotated[Any, _lenient_parser("X", parse_float_or_text)]
TextFlag = Annotated[Any, _lenient_parser("TEXT", " ".join)]
NamesFlag = Annotated[Any, _lenient_parser("TEXT ...", _split_words)]
FilesFlag = Annotated[Any, _lenient_parser("FILE ...", tuple)]
PathFlag = Annotated[Any, _lenient_parser("PATH", " ".join)]
#: A flag without a value.
Switch = Annotated[bool, tyro.conf.FlagCreatePairsOff]
#: Claims about a report, each with a flag of its own.
ClaimsFlag = Annotated[tuple[str, ...], tyro.conf.UseAppendAction, tyro.conf.arg(
    metavar="CLAIM", help_behavior_hint="(default: nothing; may be given several times)")]
ProcessesFlag = Annotated[NumberFlag, default_hint("one on each processor")]


def process_count(processes: Any) -> int:
    """Returns the number of parallel processes: the one given, if valid, for None one per processor."""
    if processes is None:
        return default_processes()
    require_whole("processes", processes, 1, MOST_PROCESSES)
    return processes


def parse_times(words: tuple[str, ...], flag: str) -> list[float]:
    """Returns times in s; raises :class:`BadInput` of the flag for a word that is no time from 0 on."""
    times = []
    for word in words:
        time = parse_float_or_text([word])
        if isinstance(time, str) or time < 0:
            raise BadInput(flag, word, "is no time; give seconds from 0 on")
        times.append(time)
    return times


def parse_file_times(files: Sequence[str], words: tuple[str, ...]) -> list[float]:
    """Returns the ``words`` of ``--time`` in s, one for each file, or []; raises BadInput for files not there."""
    if not files:
        raise BadInput("", "", "give one or several files of particles")
    if len(files) > MOST_FILES:
        raise BadInput("", f"{len(files)} files", f"are too many; give at most {MOST_FILES:,}, each with many times "
                       "perhaps")
    times = parse_times(words, "time")
    if times and len(times) != len(files):
        raise BadInput("time", " ".join(words), f"gives {len(times)} times for {len(files)} files; give one for each")
    for file in files:
        try:
            os.stat(file)
        except (OSError, ValueError) as error:  # ValueError: a character invalid in names
            why = getattr(error, "strerror", None) or str(error)
            raise BadInput("", file, f"cannot be read: {why.lower()}; give a file that exists and may be "
                                     "read") from None
    return times
