"""What --help and --completion print: what each command does, an example, no line too wide, colours where wanted."""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
from dataclasses import fields

import pytest

from app.cli import main
from app.commands import commands
from app.commands.completion import SHELLS, completion_script
from app.commands.dispatch import _find_command, _read_flags
from app.commands.help import EVERYWHERE, WIDEST
from app.commands.progress import wants_colour
from tests.support.paths import ROOT
from tests.support.processes import HANG

WITHOUT_NAMES = {"text", "file", "files", "table", "names", "name", "what", "visitors"}  # typed where they stand
EACH = pytest.mark.parametrize("name", commands(), ids=" ".join)


@pytest.fixture
def wide(monkeypatch):
    monkeypatch.setenv("COLUMNS", str(WIDEST))


def helped(capsys, *words: str) -> list[str]:
    assert main([*words, "--help"]) == 0
    seen = capsys.readouterr()
    assert seen.err == ""
    return seen.out.splitlines()


@EACH
def test_help_of_a_command(name, wide, capsys):
    """Usage, a sentence on one line, exit statuses, flags, an example; nothing beyond the width that everybody has."""
    lines = helped(capsys, *name)
    assert lines[0].startswith(f"usage: mpm-lab {' '.join(name)}") and max(map(len, lines)) <= WIDEST
    first = lines.index("") + 1  # after a usage that may take several lines
    assert re.fullmatch(r"[A-Z][^.]*[^.]\.", lines[first]) and not lines[first + 1]
    assert sum("Exit status: 0" in line for line in lines) == 1
    assert lines[-3].startswith(f"Example:  mpm-lab {' '.join(name)}") and lines[-1] == EVERYWHERE
    shown = " ".join(" ".join(lines).replace("│", " ").split())
    flags = {field.name.replace("_", "-") for field in fields(commands()[name])} - WITHOUT_NAMES
    assert [flag for flag in flags if f"--{flag}" not in shown and f"--no-{flag}" not in shown] == []
    if name in (("run", "bar"), ("run", "ring"), ("run", "vortex")):
        scene = commands()[name].SCENE
        assert f"(default: {scene.cells})" in shown and f"(default: {scene.DEFAULT_PERIODS:g} without" in shown


@EACH
def test_the_example_of_a_command_can_be_typed(name):
    program, *words = shlex.split(commands()[name].EXAMPLE)
    found, rest = _find_command(words)
    assert (program, found) == ("mpm-lab", name)
    command = _read_flags(commands()[name], " ".join(words), rest)
    if hasattr(command, "SCENE") and hasattr(command, "scene") and "sweep" not in name:
        command.scene()  # raises where the numbers are not allowed


@pytest.mark.parametrize("name", [(), *sorted({known[:-1] for known in commands() if len(known) > 1})], ids=" ".join)
def test_the_overview_fits_a_terminal(name, wide, capsys):
    lines = helped(capsys, *name)
    assert max(map(len, lines)) <= WIDEST and lines[-1] == EVERYWHERE
    assert all(any(line.startswith(f"  mpm-lab {' '.join(known)} ") for line in lines)
               for known in commands() if known[:len(name)] == name)


@pytest.mark.parametrize("environment, is_terminal, wanted", [
    ({"TERM": "xterm"}, True, True), ({"TERM": "xterm"}, False, False), ({"TERM": "dumb"}, True, False),
    ({}, True, False),
    ({"TERM": "xterm", "NO_COLOR": "1"}, True, False), ({"TERM": "xterm", "NO_COLOR": ""}, True, True),
    ({"TERM": "xterm", "FORCE_COLOR": "1"}, False, True), ({"TERM": "dumb", "FORCE_COLOR": "1"}, True, False),
    ({"TERM": "xterm", "FORCE_COLOR": "1", "NO_COLOR": "1"}, True, False)])
def test_who_wants_colours(environment, is_terminal, wanted):
    assert wants_colour(environment, is_terminal) is wanted


@pytest.mark.skipif(os.name == "nt", reason="POSIX terminals")
@pytest.mark.parametrize("given, wanted", [({}, True), ({"NO_COLOR": "1"}, False)], ids=["as it is", "NO_COLOR"])
def test_help_on_a_terminal(given, wanted):
    import pty  # here: elsewhere it cannot be imported

    outside, terminal = pty.openpty()
    known = {name: value for name, value in os.environ.items() if name not in ("NO_COLOR", "FORCE_COLOR")}
    process = subprocess.Popen([sys.executable, "-m", "app", "lesson", "check", "--help"], cwd=ROOT, stdout=terminal,
                               env={**known, "TERM": "xterm", **given})
    os.close(terminal)
    shown = b""
    try:
        while part := os.read(outside, 65536):
            shown += part
    except OSError:  # how Linux says that nobody holds the terminal's other end any more
        pass
    os.close(outside)
    assert process.wait(HANG) == 0 and b"--variants" in shown and (b"\x1b[" in shown) is wanted


@pytest.mark.parametrize("shell", [shell if shell == "bash" else pytest.param(shell, marks=pytest.mark.slow)
                                   for shell in SHELLS])
def test_a_shell_gets_its_script(shell, capsys):
    assert main(["--completion", shell]) == 0 and main([f"--completion={shell}"]) == 0
    seen = capsys.readouterr()
    assert seen.out == 2 * completion_script(shell) and seen.err == ""
    assert all(word in seen.out for name in commands() for word in name if not word.startswith("-"))
    assert "--linearity-preserving" in seen.out


@pytest.mark.skipif(shutil.which("bash") is None, reason="no bash")
def test_bash_completes_commands_flags_words_and_files(tmp_path):
    """What is offered after each line; where nothing is known, bash offers files by itself (-o default)."""
    (tmp_path / "lab.sh").write_text(completion_script("bash"), encoding="utf-8")
    (tmp_path / "mine.csv").touch()
    lines = {"mpm-lab ru": "run", "mpm-lab run b": "bar", "mpm-lab run bar --meth": "--method",
             "mpm-lab run bar --estimator comp": "companion", "mpm-lab run bar --json min": "mine.csv",
             "mpm-lab run bar --cells ''": "", "mpm-lab judge bar mi": ""}
    ask = "\n".join(f'COMP_WORDS=({line}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1)); _tyro_mpm_lab; '
                    'echo "${#COMPREPLY[@]} ${COMPREPLY[*]}"' for line in lines)
    done = subprocess.run(["bash", "-c", f"source ./lab.sh; complete -p mpm-lab\n{ask}"], cwd=tmp_path, text=True,
                          capture_output=True, timeout=HANG)
    registered, *offered = done.stdout.splitlines()
    assert registered == "complete -o default -F _tyro_mpm_lab mpm-lab"
    assert offered == [f"1 {word}" if word else "0 " for word in lines.values()]


def test_no_flag_hides_what_its_command_does():
    """A ring has a field ``plan``: a method of that name would be its value."""
    hidden = [(name, flag.name) for name, kind in commands().items() for flag in fields(kind)
              for base in kind.__mro__ if callable(own := vars(base).get(flag.name)) or isinstance(own, property)]
    assert hidden == []
