"""What ends a command otherwise than well: one sentence, a documented exit status, and nothing left behind."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
from types import SimpleNamespace

import pytest

from app.cli import INTERRUPTED, main
from app.commands import commands, dispatch
from app.commands.output import NotWritten, OutputTarget, print_message, show_tracebacks
from app.commands.run import command as run_command
from tests.support.paths import ROOT
from tests.support.processes import HANG, children, has_ended, has_library, wait_until

TEXT = (ROOT / "assets" / "command-line.md").read_text(encoding="utf-8")
FULL = "/dev/full"
needs_full = pytest.mark.skipif(not os.path.exists(FULL), reason=f"no {FULL}")


def command(*arguments: str, **options) -> subprocess.CompletedProcess:
    return subprocess.run([sys.executable, "-m", "app", *arguments], cwd=ROOT, text=True, timeout=HANG,
                          **{"stderr": subprocess.PIPE, **options})


def test_the_table_of_exit_statuses_is_whole():
    """And each command's help names none that is not in it."""
    told = {int(status) for status in re.findall(r"^\| (\d+) \|", TEXT, re.MULTILINE)}
    assert told == {0, dispatch.FAILED, dispatch.BAD_INPUT, run_command.BROKEN, INTERRUPTED, dispatch.BROKEN_PIPE}
    for kind in commands().values():
        statuses = (kind.__doc__ or "").partition("Exit status:")[2]
        assert {int(status) for status in re.findall(r"(?:^|, ) *(\d+) ", statuses)} <= told


def test_variables_of_the_environment_are_listed():
    """Those that the code, the tests and the checks read, and no other."""
    files = [path for room in ("app", "solvers", "tests", "lessons", ".ci") for path in (ROOT / room).rglob("*")
             if path.is_file() and (path.suffix == ".py" or room == ".ci")]
    read = {name for path in files for name in re.findall(r"MPM_LAB_[A-Z_]+[A-Z]", path.read_text(encoding="utf-8"))}
    assert read == set(re.findall(r"^\| `(MPM_LAB_[A-Z_]+)`", TEXT, re.MULTILINE))


@pytest.mark.parametrize("name", commands(), ids=" ".join)
def test_verbose_shows_the_place_in_every_command(name, capsys):
    assert main([*name, "--celss", "3"]) == 2
    brief = capsys.readouterr().err
    assert main([*name, "--verbose", "--celss", "3"]) == main(["--verbose", *name, "--celss", "3"]) == 2
    shown = capsys.readouterr().err
    assert "Traceback" not in brief and shown.count("Traceback") == 2 and shown.count("dispatch.py") >= 2
    assert shown.endswith(brief) and brief.count("\n") == 1


@pytest.mark.parametrize("words", [[], ["--verbose"]])
def test_verbose_shows_the_place_of_what_should_not_happen(words, monkeypatch, capsys):
    def fails(*_):
        raise MemoryError("no room")

    monkeypatch.setattr(run_command, "_run_and_try_cures", fails)
    monkeypatch.setattr(dispatch, "_wants_traceback", lambda: False)
    assert main(["run", "bar", *words]) == 1
    *places, told = capsys.readouterr().err.splitlines()
    assert told == "mpm-lab: failed: MemoryError: no room"
    assert bool(places) is bool(words) and ("in fails" in "\n".join(places)) is bool(words)


def test_verbose_ends_with_its_command_and_shows_what_is_told_on_the_way(capsys):
    for wanted in (True, False):
        with show_tracebacks(wanted):
            try:
                raise ValueError("a picture\x1b[2J")
            except ValueError as error:
                print_message(error)
            print_message("nothing failed")
    *places, first, second, third, fourth = capsys.readouterr().err.splitlines()
    assert (first, second) == (third, fourth) == ("mpm-lab: a picture\\x1b[2J", "mpm-lab: nothing failed")
    assert places[0].startswith("Traceback") and "\x1b" not in "".join(places)


@needs_full
@pytest.mark.parametrize("words", [["--version"], ["lesson", "list"], *(
    pytest.param(words, marks=pytest.mark.slow) for words in (["--help"], ["run", "bar", "--help"]))])
def test_a_full_disk_behind_the_standard_output_is_one_sentence(words):
    with open(FULL, "w") as full:
        done = command(*words, stdout=full)
    assert (done.returncode, done.stderr) == (
        1, "mpm-lab: standard output could not be written: no space left on device\n")


@needs_full
def test_a_full_disk_names_the_flag(monkeypatch):
    with open(FULL, "wb", buffering=0) as full, monkeypatch.context() as patch:
        patch.setattr(sys, "stdout", SimpleNamespace(buffer=full, flush=lambda: None))
        with pytest.raises(NotWritten, match=r"^standard output could not be written: no space left on device$"):
            OutputTarget("json", "-", may_be_stdout=True).write(b"{}")
    with pytest.raises(NotWritten, match=r"^--json /dev/full could not be written: no space left on device$"):
        OutputTarget("json", FULL).write(b"{}")
    with open(FULL, "w") as full:  # who cannot be told anything still gets the exit status
        assert command("frobnicate", stderr=full, stdout=subprocess.DEVNULL).returncode == 2


@pytest.mark.skipif(os.name == "nt", reason="POSIX pipes")
@pytest.mark.parametrize("words", [["run", "bar", "--help"], ["lesson", "list"], *(
    pytest.param(words, marks=pytest.mark.slow) for words in (["--help"], ["--completion", "bash"]))])
def test_a_reader_that_has_gone_is_no_fuss(words):
    read, write = os.pipe()
    os.close(read)
    done = command(*words, stdout=write)
    os.close(write)
    assert (done.returncode, done.stderr) == (dispatch.BROKEN_PIPE, "")


LONG = {"run bar --cells 20000 --dt 1e-6 --t-end 100 --json a.json": "", "lesson check": "",
        "sweep bar --cells 8 --periods 1e5 --out sweep": "",
        "judge ring exact.csv --cells 48 --out verdict": "slow", "bench --json a.json": "slow",
        "advise ring --tolerance 1e-5": "slow", "budget ring --cells 100": "slow", "lesson guide 9": "slow",
        "export bar --out bar.html": "slow", "stability bar --out map": "slow", "tables all --out tables": "slow"}


def family(process: int) -> list[int]:
    """A process and those below it."""
    return [process, *(each for child in children(process, "") for each in family(child))]


@pytest.mark.skipif(os.name == "nt", reason="POSIX signals")
@pytest.mark.parametrize("line", [pytest.param(line, marks=getattr(pytest.mark, mark) if mark else ())
                                  for line, mark in LONG.items()])
def test_an_interrupt_is_one_line_and_leaves_nothing_running(line, tmp_path):
    """And no file but the rows that are kept on purpose; serve has its own in tests/app/serving."""
    if "exact.csv" in line:
        assert main(["problem", "ring", "--cells", "48", "--out", str(tmp_path / "handout")]) == 0
        os.rename(tmp_path / "handout" / "exact.csv", tmp_path / "exact.csv")
    before = {path for path in tmp_path.rglob("*") if path.is_file()}
    process = subprocess.Popen([sys.executable, "-m", "app", *line.split()], cwd=tmp_path, text=True,
                               env={**os.environ, "PYTHONPATH": str(ROOT)}, stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE)

    def at_work() -> bool:
        assert process.poll() is None, process.communicate()
        try:
            return any(has_library(each, "taichi") for each in family(process.pid))
        except (FileNotFoundError, ProcessLookupError):  # it ended meanwhile
            return False

    wait_until(at_work, "Taichi loaded")
    started = family(process.pid)
    process.send_signal(signal.SIGINT)
    out, said = process.communicate(timeout=HANG)
    assert (process.returncode, out) == (INTERRUPTED, "")
    assert said.splitlines()[-1] == "mpm-lab: interrupted" and "Traceback" not in said
    wait_until(lambda: all(map(has_ended, started)), "every process ended")
    left = {path.name for path in tmp_path.rglob("*") if path.is_file() and path not in before}
    assert left <= {"rows.jsonl"} | {name for name in left if "tables" in line}
