"""``mpm-lab --completion SHELL``: the script that completes commands, flags, their words and files in a shell."""

import contextlib
import io
import operator
from dataclasses import dataclass, fields, replace
from functools import reduce
from pathlib import Path
from typing import Annotated, Any, get_type_hints

import tyro

from app.commands import commands
from app.commands.help import PROGRAM
from app.commands.lenient_flag_types import BadInput

SHELLS = ("bash", "zsh", "fish")
FILES = ("PATH", "FILE ...")  # metavars of flags that take files
#: Changes to tyro's script for bash: falls back to files, as bash does without it.
BASH = {"complete -F": "complete -o default -F",
        'COMPREPLY=("${matches[@]}")': 'COMPREPLY=(); [ -z "$completions" ] || COMPREPLY=("${matches[@]}")'}


def completion_script(shell: str) -> str:
    """Returns the completion script for "bash", "zsh" or "fish", made from the commands' own flags."""
    if shell not in SHELLS:
        raise BadInput("completion", shell, f"give one of {', '.join(SHELLS)}")
    tree: dict[str, Any] = {}
    for (first, *rest), kind in commands().items():
        if not rest:
            tree[first] = _with_choices(kind)
        elif not rest[0].startswith("-"):  # --scene TEXT has no completion
            tree.setdefault(first, {})[rest[0]] = _with_choices(kind)
    read: Any = tyro.cli  # the type of what it returns depends on the commands
    printed = io.StringIO()
    kinds = _command_choice_type({first: _command_choice_type(kind) if isinstance(kind, dict) else kind
                                  for first, kind in tree.items()})
    with contextlib.redirect_stdout(printed), contextlib.suppress(SystemExit):
        read(kinds, prog=PROGRAM, args=["--tyro-print-completion", shell])
    return reduce(lambda text, old: text.replace(old, BASH[old]), BASH, printed.getvalue())


def _command_choice_type(kinds: dict[str, Any]) -> Any:
    """Returns tyro's type for a choice between commands, classes by their words."""
    return reduce(operator.or_, [Annotated[kind, tyro.conf.subcommand(name)] for name, kind in kinds.items()])


def _with_choices(kind: Any) -> type:
    """Returns a command class whose flags name their choices, as those for reading accept anything."""
    hints = get_type_hints(kind, include_extras=True)
    typed = {f.name: hint for f in fields(kind) if (hint := _completion_type(hints[f.name])) is not None}
    known = {"__annotations__": typed, "__doc__": kind.__doc__, **dict.fromkeys(typed)}
    return dataclass(frozen=True, kw_only=True)(type(kind.__name__, (kind,), known))


def _completion_type(hint: Any) -> Any:
    """Returns the narrower type for a flag's annotation if it takes files or some words; None for any other."""
    marks = getattr(hint, "__metadata__", ())
    spec = next((mark for mark in marks if isinstance(mark, tyro.constructors.PrimitiveConstructorSpec)), None)
    if spec is None:
        return None
    others = [mark for mark in marks if mark is not spec]
    if spec.metavar in FILES:
        file: Any = (Path | None, *others)
        return Annotated[file]
    if spec.metavar.startswith("{"):
        words = tuple(spec.metavar.partition("}")[0][1:].split(","))
        word: Any = (Any, replace(spec, choices=words), *others)
        return Annotated[word]
    return None
