"""Dispatcher: finds the command, parses its flags, and reports every error in one line.

Exit status: 0 ok, 1 could not run or write, 2 bad input, 3 unstable or lost run, 130 Ctrl-C, 141 reader has gone."""

import contextlib
import io
import os
import sys
from dataclasses import fields
from typing import Any

import tyro

from app import __version__
from app.commands import BODY_FILE, DEFAULT_COMMAND, commands
from app.commands.help import PROGRAM, VERBOSE, PrintCapture, commands_overview, help_paragraphs, wrap_help
from app.commands.lenient_flag_types import BadInput
from app.commands.output import NotWritten, print_message, put_text, show_tracebacks
from solvers.scene.extension_modules import ExtensionError
from solvers.scene.validation import SceneError, field_flag, field_key, key_field
from solvers.untrusted.quoting import FileError, one_line, quote, suggest_word

FAILED, BAD_INPUT, BROKEN_PIPE = 1, 2, 141
LONGEST_COMPLAINT = 200  # letters of an error of the parser


def dispatch(arguments: list[str]) -> int:
    """Runs the words after ``mpm-lab``, returns the exit status; raises only Ctrl-C, with ``-X dev`` any error."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="replace")  # a terminal without ² must not lose the result
    with show_tracebacks(VERBOSE in arguments):
        return _exit_status([word for word in arguments if word != VERBOSE])


def _exit_status(arguments: list[str]) -> int:
    try:
        status = _run_command(arguments)
        put_text("")  # here, where a broken pipe is still handled
        return status
    except (BadInput, ExtensionError, FileError, SceneError) as error:
        print_message(BadInput(field_flag(error.field), error.value, error.sentence) if isinstance(error, SceneError)
                      else error)
        return BAD_INPUT
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # otherwise Python reports it again at exit
        return BROKEN_PIPE
    except NotWritten as error:
        print_message(error)
        return FAILED
    except Exception as error:
        if _wants_traceback():
            raise
        print_message(one_line(f"failed: {type(error).__name__}: {error}"))
        return FAILED


def _wants_traceback() -> bool:
    return sys.flags.dev_mode


def _run_command(arguments: list[str]) -> int:
    if arguments and arguments[0] == "--version":
        put_text(f"{PROGRAM} {__version__}\n")
        return 0
    flag, _, value = (arguments or [""])[0].partition("=")
    if flag == "--completion":
        from app.commands import completion
        put_text(completion.completion_script(value or " ".join(arguments[1:])))
        return 0
    name, rest = _find_command(arguments)
    if name not in commands():
        put_text(commands_overview(name) + "\n")
        return 0
    command = _read_flags(commands()[name], f"{PROGRAM} {' '.join(name)}", rest)
    return 0 if command is None else command.execute()


def _find_command(arguments: list[str]) -> tuple[tuple[str, ...], list[str]]:
    """Returns the words of the command's name and those after it; before --help, a name's beginning and no others."""
    if not arguments or (arguments[0].startswith("-") and arguments[0] not in ("-h", "--help")):
        return DEFAULT_COMMAND, arguments
    name: tuple[str, ...] = ()
    for position, word in enumerate(arguments):
        if word in ("-h", "--help"):
            return name, []
        flag, equals, value = word.partition("=") if word.startswith("-") else (word, "", "")  # run --scene=TEXT
        if word.endswith(".toml") and (*name, BODY_FILE) in commands():
            flag, equals, value = BODY_FILE, "=", word
        elif name and word.endswith(".toml"):
            takers = " and ".join(" ".join((PROGRAM, *one)) for one in commands() if one[-1] == BODY_FILE)
            raise BadInput("", word, f"is a body, which only {takers} take")
        if flag not in _next_words(name):
            raise BadInput("", word, f"is not a command{suggest_word(word, _next_words(name))}; {_suggest_next(name)}")
        name += (flag,)
        if name in commands():
            return name, [*([value] if equals else []), *arguments[position + 1:]]
    raise BadInput("", " ".join(name), f"what? {_suggest_next(name)}")


def _suggest_next(name: tuple[str, ...]) -> str:
    return f"give {' or '.join(' '.join((PROGRAM, *name, word)) for word in _next_words(name))}"


def _next_words(name: tuple[str, ...]) -> list[str]:
    """Returns the words that may follow the beginning of a command's name."""
    return list(dict.fromkeys(known[len(name)] for known in commands() if known[:len(name)] == name))


def _read_flags(kind: type, program: str, arguments: list[str]) -> Any:
    """Returns an instance of the command class ``kind`` with its flags; None after showing help."""
    read: Any = tyro.cli  # the type of what it returns depends on its flags
    names = {f.name for f in fields(kind)}
    arguments = [_translate_synonym(word, names) for word in arguments]
    complaints, shown = io.StringIO(), PrintCapture()
    try:
        with contextlib.redirect_stderr(complaints), contextlib.redirect_stdout(shown):
            command, unknown = read(kind, prog=program, args=arguments, return_unknown_args=True,
                                    description="\n\n".join(help_paragraphs(kind)))
    except SystemExit as end:
        if not end.code:
            put_text(wrap_help(shown.getvalue(), kind))
            return None
        # tyro's boxed error as one sentence: the first line within the box.
        lines = [line.strip(" │|╭╮╰╯─-") for line in complaints.getvalue().splitlines()]
        says = [line for line in lines if line and not line.startswith(("Missing", "Parsing", "For full"))]
        raise BadInput("", program, quote(says[0], LONGEST_COMPLAINT) if says else
                       "the flags could not be read; --help shows them") from None
    if unknown:
        raise _refuse_word(unknown[0], kind, program)
    return command


def _translate_synonym(word: str, names: set[str]) -> str:
    """Returns a flag such as ``--estimators`` by the one of a command's ``names`` for it; other words unchanged."""
    flag, separator, value = word.partition("=")
    name = flag.removeprefix("--")
    if not word.startswith("--") or name in names or field_key(key_field(name)) not in names:
        return word
    return f"--{field_flag(key_field(name))}{separator}{value}"


def _refuse_word(word: str, kind: type, program: str) -> BadInput:
    """Returns the error for a word that the command ``kind``, called ``program`` in messages, does not take."""
    flags = [*("--" + field.name.replace("_", "-") for field in fields(kind)), VERBOSE]
    flag = word.partition("=")[0]
    if not word.startswith("-") or word == "-" or flag in flags:
        return BadInput("", word, f"is not expected here; {program} --help shows the flags")
    if reason := getattr(kind, "GONE", {}).get(flag):
        return BadInput("", flag, f"is gone from {program}: {reason}")
    if hasattr(kind, "SCENE") and (reason := kind.SCENE.RUN_ONLY.get(flag.lstrip("-").replace("-", "_"))):
        return BadInput("", flag, f"is not a flag of {program}: {reason}")
    return BadInput("", flag, f"is not a flag of {program}{suggest_word(flag, flags)}; --help shows them all")
