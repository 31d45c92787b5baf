"""Flags that let anything through, so that whoever knows the allowed range can word the error.

A number that does not parse stays text: ``Scene`` then says what is wrong and what is allowed, in one line,
as it does for a number out of range. That is why these flags take any count of words (none, or too many, is
wrong in the same way) and why no range is repeated here.
"""

import os
from collections.abc import Callable, Iterable, Sequence
from typing import Annotated, Any

import tyro

from solvers.scene.validation import require_whole
from solvers.untrusted import number_parsing, quoting
from solvers.workers.cpu_count import MOST_PROCESSES, usual_processes

MOST_FILES = 10_000


class BadInput(Exception):
    """Something typed that no command can use. ``flag`` is without its dashes, "" for what is not a flag."""

    def __init__(self, flag: str, value: object, sentence: str):
        self.flag, self.value, self.sentence = flag, value, sentence
        super().__init__(quoting.sentence(f"{f'--{flag} ' if flag else ''}{quoting.quoted(value)}: {sentence}"))


def _lenient(metavar: str, parse: Callable[[list[str]], Any]) -> Any:
    """A tyro constructor that takes any words and never fails."""
    return tyro.constructors.PrimitiveConstructorSpec(
        nargs="*", metavar=metavar, instance_from_str=parse, is_instance=lambda value: True,
        str_from_instance=lambda value: list(map(str, value)) if isinstance(value, tuple) else [quoting.quoted(value)])


def parse_number(words: list[str]) -> Any:
    """A whole number or a float where the words are one, else the words."""
    return _read(number_parsing.number, words)


def parse_float(words: list[str]) -> Any:
    """A float where the words are one, else the words."""
    return _read(number_parsing.real, words)


def _read(reader: Callable[[str], float], words: list[str]) -> Any:
    text = " ".join(words)
    try:
        return reader(text)
    except ValueError:
        return text


def _words(words: list[str]) -> tuple[str, ...]:
    """Words separated by commas, spaces or both."""
    return tuple(word for group in words for word in group.replace(",", " ").split())


def one_of(choices: Iterable[str]) -> Any:
    """For a flag that is one of the choices: ``Annotated[Any, one_of(...)]``."""
    return _lenient("{" + ",".join(choices) + "}", " ".join)


def several_of(choices: Iterable[str]) -> Any:
    """For a flag that is several of the choices, separated by commas or spaces."""
    return _lenient("{" + ",".join(choices) + "} ...", _words)


def choices_of(choices: Iterable[str], default: str, text: str) -> Any:
    """The type of such a flag with its help, where "default" stands for none given."""
    return Annotated[Any, several_of(choices), default_hint(default), tyro.conf.arg(help=text)]


def default_hint(text: str) -> Any:
    """What the help says about the default of a flag that has none of its own."""
    return tyro.conf.arg(help_behavior_hint=f"(default: {text})")


NumberFlag = Annotated[Any, _lenient("N", parse_number)]
RealFlag = Annotated[Any, _lenient("X", parse_float)]
TextFlag = Annotated[Any, _lenient("TEXT", " ".join)]
NamesFlag = Annotated[Any, _lenient("TEXT ...", _words)]
FilesFlag = Annotated[Any, _lenient("FILE ...", tuple)]
PathFlag = Annotated[Any, _lenient("PATH", " ".join)]
#: A flag without a value.
Switch = Annotated[bool, tyro.conf.FlagCreatePairsOff]
#: What a report is to bear out, each with a flag of its own.
ClaimsFlag = Annotated[tuple[str, ...], tyro.conf.UseAppendAction, tyro.conf.arg(
    metavar="CLAIM", help_behavior_hint="(default: nothing; may be given several times)")]
ProcessesFlag = Annotated[NumberFlag, default_hint("one on each processor")]


def side_by_side(processes: Any) -> int:
    """How many processes are to work side by side, of what was typed; unless anything was, one on each processor."""
    if processes is None:
        return usual_processes()
    require_whole("processes", processes, 1, MOST_PROCESSES)
    return processes


def times_of(words: tuple[str, ...], flag: str) -> list[float]:
    """Times in seconds, as they were typed."""
    times = []
    for word in words:
        time = parse_float([word])
        if isinstance(time, str) or time < 0:
            raise BadInput(flag, word, "is no time; give seconds from 0 on")
        times.append(time)
    return times


def times_for(files: Sequence[str], words: tuple[str, ...]) -> list[float]:
    """Returns the times of ``--time`` in s, one for each file, or none; refuses files that are not there."""
    if not files:
        raise BadInput("", "", "give one or several files of particles")
    if len(files) > MOST_FILES:
        raise BadInput("", f"{len(files)} files", f"are too many; give at most {MOST_FILES:,}, each with many times "
                       "perhaps")
    times = times_of(words, "time")
    if times and len(times) != len(files):
        raise BadInput("time", " ".join(words), f"gives {len(times)} times for {len(files)} files; give one for each")
    for file in files:
        try:
            os.stat(file)
        except (OSError, ValueError) as error:  # a character that no name can have is the latter
            why = getattr(error, "strerror", None) or str(error)
            raise BadInput("", file, f"cannot be read: {why.lower()}; give a file that exists and may be "
                                     "read") from None
    return times
