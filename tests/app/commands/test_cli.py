"""The command line: its JSON contract, one clear line for every mistake, clean standard output, exit statuses."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys

import pytest

from app import __version__
from app.cli import main
from app.commands import commands
from app.commands.output import NotWritten, Target, json_text
from app.commands.progress import noted_interrupts
from app.commands.run.text import run_table
from solvers.problems.bar.scene import BarScene
from solvers.scene.effects import EFFECTS
from tests.paths import ROOT
from tests.processes import HANG, wait_for_library

RunBar = commands()["run", "bar"]

QUICK = ["--cells", "8", "--ppc", "2", "--periods", "0.2"]
KEYS = {"schema", "scene", "status", "reason", "t", "steps", "particles", "error", "estimate", "index", "distance",
        "goals", "soundness", "step", "life", "grid_crossings", "energy", "angular_momentum", "budget", "effects",
        "bytes", "seconds", "rate", "arch", "threads", "plan", "not_valid", "checked", "not_checked",
        "as_large_as_itself", "rounding"}


def command(*arguments: str, **options) -> subprocess.CompletedProcess:
    """Run ``python -m app`` as a person would."""
    return subprocess.run([sys.executable, "-m", "app", *arguments], cwd=ROOT, capture_output=True, text=True,
                          timeout=HANG, **options)


@pytest.fixture(scope="module")
def printed() -> dict:
    """The JSON object of a quick run; that standard output holds it and nothing else."""
    done = command("run", "bar", *QUICK, "--json", "-")
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("\n") == 1
    return json.loads(done.stdout, parse_constant=lambda name: pytest.fail(f"{name} is not JSON"))


def test_json_has_exactly_the_contracts_keys(printed):
    assert set(printed) == KEYS
    assert printed["schema"] == "mpm-lab/run/1"
    assert (printed["status"], printed["reason"]) == ("ok", None)
    assert printed["particles"] == 16
    assert printed["t"] == pytest.approx(0.2)
    assert printed["t"] == pytest.approx(printed["steps"] * printed["scene"]["dt"])


def test_json_scene_has_every_flag_with_its_default(printed):
    flags = {"method", "cells", "ppc", "amplitude", "modulus", "density", "dt", "cfl", "t_end", "periods",
             "body_force", "linearity_preserving", "velocity", "estimator", "effects", "remedies", "arch", "threads",
             "sample_every", "motion", "take_away"}
    of_patch = {"stretch", "initial_velocity"}  # which mean nothing here
    assert set(printed["scene"]) == flags | {"problem"} | of_patch
    assert {name for name, value in printed["scene"].items() if value is None} == of_patch
    assert (printed["scene"]["cells"], printed["scene"]["ppc"]) == (8, 2)
    assert printed["scene"]["modulus"] == BarScene.modulus
    assert printed["scene"]["estimator"] == list(BarScene.estimators)


@pytest.mark.parametrize("key", ["error", "estimate"])
def test_json_errors_and_estimates_are_summaries(printed, key):
    quantities = {"x", "v", "sigma", "a"} | ({"sigma_log"} if key == "error" else set())
    assert set(printed[key]) == quantities
    for values in printed[key].values():
        assert set(values) == {"final", "max", "mean"}
        assert 0 < values["mean"] <= values["max"] and values["final"] <= values["max"]


@pytest.mark.parametrize("key", ["index", "distance"])
def test_json_index_and_distance_are_numbers(printed, key):
    assert set(printed[key]) == {"x", "v", "sigma", "a"}
    assert all(value > 0 for value in printed[key].values())


def test_json_cost_and_energy(printed):
    seconds = printed["seconds"]
    assert set(seconds) == {"setup", "compile", "run", "estimate", "estimators"}
    assert seconds["estimate"] == sum(seconds.pop("estimators").values())
    assert all(value >= 0 for value in seconds.values())
    assert printed["rate"] == pytest.approx(1e-6 * 16 * printed["steps"] / printed["seconds"]["run"])
    assert set(printed["energy"]) == {"initial", "final", "drift"}
    assert printed["bytes"] > 0 and printed["threads"] == 1 and printed["grid_crossings"] >= 0
    assert set(EFFECTS) <= set(printed["effects"])


BAD = [
    (["--amplitude", "0.2"], "--amplitude 0.2:", "below 0.159"),
    (["--amplitude", "nan"], "--amplitude nan:", "above 1e-12"),
    (["--amplitude", "inf"], "--amplitude inf:", "below 0.159"),
    (["--cells", "0"], "--cells 0:", "from 4 to 100,000"),
    (["--cells", "2.5"], "--cells 2.5:", "from 4 to 100,000"),
    (["--cells", "abc"], "--cells abc:", "from 4 to 100,000"),
    (["--cells"], "--cells (no value):", "from 4 to 100,000"),
    (["--cells", "8", "9"], "--cells 8 9:", "whole number"),
    (["--dt", "-1"], "--dt -1:", "above 0"),
    (["--dt=-1"], "--dt -1:", "above 0"),
    (["--dt", "1e-3", "--cfl", "0.1"], "--cfl 0.1:", "dt is given too"),
    (["--t-end", "1", "--periods", "1"], "--periods 1:", "t-end is given too"),
    (["--ppc", "0"], "--ppc 0:", "from 1 to 64"),
    (["--body-force", "all"], "--body-force all:", "material, node, none"),
    (["--method", "cpdi"], "--method cpdi:", "one of mpm, ugimp, cpgimp, bspline"),
    (["--method", "foo"], "--method foo:", "mpm, ugimp, cpgimp, bspline"),
    (["--method", "a\nb"], "--method a\\nb:", "ugimp"),
    (["--estimator", "foo"], "--estimator foo:", "transport"),
    (["--estimator", "none", "transport"], "--estimator none transport:", "stands alone"),
    (["--effects", "truth,foo"], "--effects foo:", "crossings"),
    (["--effects", "all,truth"], "--effects all truth:", "stands alone"),
    (["--effects"], "--effects (no value):", "names"),
    (["--velocity", "corners"], "--velocity corners:", "cpgimp"),
    (["--celss", "3"], "--celss:", "did you mean --cells?"),
    (["stray"], "stray:", "not expected"),
    (["--json", "no/such/directory/x.json"], "--json no/such/directory/x.json:", "directory that exists"),
    (["--json", "."], "--json .:", "is a directory"),
    (["--json"], "--json (no value):", "give a file"),
    (["--json", "a" * 300], "--json " + "a" * 30 + "…" + "a" * 29 + ":", "name too long"),
    (["--plot", "x.pdf"], "--plot x.pdf:", ".png"),
    (["--plot", "no/such/directory/x.png"], "--plot no/such/directory/x.png:", "directory that exists"),
    (["--json", "x.png", "--plot", "./x.png"], "--plot ./x.png:", "--json too"),
]


@pytest.mark.parametrize(("flags", "names", "allows"), BAD, ids=[" ".join(bad[0])[:30] for bad in BAD])
def test_bad_input_is_one_line_that_names_the_flag(flags, names, allows, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("app.commands.run.command._run", lambda *_: pytest.fail("it ran before it had checked"))
    assert main(["run", "bar", *flags]) == 2
    seen = capsys.readouterr()
    assert seen.out == "" and seen.err.count("\n") == 1
    assert seen.err.startswith(f"mpm-lab: {names}") and allows in seen.err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("words", "says"), [
    (["frobnicate"], "mpm-lab: frobnicate: is not a command; give mpm-lab serve or mpm-lab run"),
    (["serv"], "did you mean serve?"),
    (["run"], "give mpm-lab run bar or mpm-lab run ring or mpm-lab run vortex"),
    (["run", "rod"], "rod: is not a command"),
    (["--cells", "4"], "--cells: is not a flag of mpm-lab serve"),
    (["--port", "0"], "--port 0: give a whole number from 1 to 65535"),
    (["serve", "--port", "http"], "--port http: give a whole number"),
    (["serve", "--max-sessions", "0"], "--max-sessions 0: give a whole number"),
    (["serve", "--frames", "0"], "--frames 0: give a number above 0 and up to 60"),
    (["serve", "--host", ""], "--host (no value):"),
    *((["serve", "--host", host], "give the name or the address of this machine") for host in (
        "\x1b[31mevil\u202e", "two words", "x\x00y")),
    (["serve", "--board"], "--board: needs --lesson with the name or number of a lesson"),
    (["serve", "--board", "--lesson", "99"], "there is no lesson"),
    (["serve", "--board", "--lesson", "4", "--code", "short"], "give 6 to 64 letters and digits, or none"),
    (["serve", "--code", "wave\x1b[31m4711"], "give 6 to 64 letters and digits, or none"),
])
def test_bad_commands_are_one_line(words, says, capsys):
    assert main(words) == 2
    seen = capsys.readouterr()
    assert seen.out == "" and seen.err.count("\n") == 1 and says in seen.err


LIGHT = [["--help"], ["run", "--help"], ["run", "bar", "--help"], ["--version"], ["advise", "ring", "--help"],
         ["sweep", "bar", "--help"], ["bench", "--help"], ["--completion", "bash"], ["run", "bar", "--cells", "0"],
         ["run", "bar", "--celss", "3"]]


def test_help_and_bad_input_import_nothing_heavy():
    """One after the other in one process, which says after which of them there was something heavy."""
    code = (f"import sys\nfrom app.cli import main\nfor arguments in {LIGHT}:\n    main(arguments)\n"
            "    heavy = [name for name in ('taichi', 'viser', 'matplotlib') if name in sys.modules]\n"
            "    if heavy: sys.exit(f'{arguments}: {heavy}')\n")
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, timeout=HANG)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("arguments", [["--help"], ["run", "bar", "--cells", "8"], ["serve"]])
def test_an_extension_that_is_not_there_is_one_line(arguments):
    done = command(*arguments, env={**os.environ, "MPM_LAB_EXTENSIONS": "no_such_module"})
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert "MPM_LAB_EXTENSIONS names no_such_module, which cannot be imported" in done.stderr
    assert "name its folder in PYTHONPATH" in done.stderr


def test_what_a_problem_has_not_is_not_a_flag(capsys):
    assert main(["run", "bar", "--layout", "polar"]) == 2
    assert "--layout: is not a flag of mpm-lab run bar" in capsys.readouterr().err


def test_an_output_without_the_signs_still_gets_its_table():
    done = command("run", "ring", "--cells", "8", "--periods", "0.01", "--quiet",
                   env={**os.environ, "PYTHONIOENCODING": "ascii"})
    assert done.returncode == 0 and "2 ? 2 particles per cell" in done.stdout


def test_help_lists_every_flag_with_its_default(capsys):
    assert main(["run", "bar", "--help"]) == 0
    shown = " ".join(word for word in capsys.readouterr().out.split() if word != "│")
    for flag in ("method", "cells", "ppc", "dt", "cfl", "t-end", "periods", "no-linearity-preserving",
                 "estimator", "effects", "sample-every", "json", "plot", "quiet"):
        assert f"--{flag}" in shown
    assert f"(default: {BarScene.cells})" in shown and f"(default: {BarScene.amplitude})" in shown


def test_version(capsys):
    assert main(["--version"]) == 0
    assert capsys.readouterr().out == f"mpm-lab {__version__}\n"


def test_flags_left_out_are_the_scenes_defaults():
    assert RunBar().scene() == BarScene()


def test_flags_reach_the_scene(monkeypatch):
    seen = []
    monkeypatch.setattr(RunBar, "execute", lambda self: seen.append(self.scene()) or 0)
    assert main(["run", "bar", "--method", "cpgimp", "--cells", "1e2", "--ppc", "2", "--amplitude", "0.1",
                 "--modulus", "9", "--density", "2", "--dt", "1e-4", "--t-end", "0.5", "--body-force", "node",
                 "--linearity-preserving", "--velocity", "corners", "--estimator", "none",
                 "--effects", "truth,energy", "--threads", "2", "--sample-every", "7"]) == 0
    assert seen == [BarScene(method="cpgimp", cells=100, ppc=2, amplitude=0.1, modulus=9.0,
                             density=2.0, dt=1e-4, t_end=0.5, body_force="node", linearity_preserving=True,
                             velocity="corners", estimators=(), effects=("truth", "energy"), threads=2,
                             sample_every=7)]


@pytest.mark.parametrize(("text", "effects"), [("none", ()), ("all", (*EFFECTS, "budget")),
                                               ("truth energy", ("truth", "energy"))])
def test_words_for_effects(text, effects, monkeypatch):
    seen = []
    monkeypatch.setattr(RunBar, "execute", lambda self: seen.append(self.scene().effects) or 0)
    assert main(["run", "bar", "--effects", *text.split()]) == 0
    assert seen == [effects]


def test_bare_command_and_flags_without_command_serve(monkeypatch):
    from app.commands.serve import Serve
    seen = []
    monkeypatch.setattr(Serve, "execute", lambda self: seen.append((self.host, self.port, self.warm_up)) or 0)
    assert main([]) == 0 and main(["--port", "9000"]) == 0 and main(["serve", "--no-warm-up"]) == 0
    assert seen == [("127.0.0.1", 8080, True), ("127.0.0.1", 9000, True), ("127.0.0.1", 8080, False)]


def test_table_is_printed_without_json(printed):
    done = command("run", "bar", *QUICK)
    assert done.returncode == 0 and "Taichi" not in done.stdout
    assert f"{printed['error']['x']['max']:.3e}" in done.stdout and "ok:" in done.stdout
    assert f"{printed['index']['sigma']:.3f}" in done.stdout
    assert done.stderr == ""  # no terminal, no bar


def test_table_survives_an_empty_result(printed):
    nothing = {"final": None, "max": None, "mean": None}
    bare = {**printed, "error": dict.fromkeys(printed["error"], nothing), "energy": None, "grid_crossings": None,
            "effects": [], "rate": None, "seconds": {"compile": 0.0, "run": 0.0, "estimate": None}}
    assert "estimate:" not in run_table(bare) and "energy drift    -" in run_table(bare)


def test_unstable_run_exits_3_and_still_prints_its_json():
    done = command("run", "bar", *QUICK, "--periods", "5", "--cfl", "1.5", "--json", "-")
    values = json.loads(done.stdout, parse_constant=lambda name: pytest.fail(f"{name} is not JSON"))
    assert done.returncode == 3 and values["status"] == "unstable"
    warning, reason = done.stderr.splitlines()
    assert "above the" in warning and "--dt auto" in warning and values["reason"] in reason


def test_files_are_whole_and_alone(tmp_path):
    done = command("run", "bar", *QUICK, "--json", str(tmp_path / "run.json"), "--plot", str(tmp_path / "run.PNG"))
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    assert set(json.loads((tmp_path / "run.json").read_text())) == KEYS
    assert (tmp_path / "run.PNG").read_bytes().startswith(b"\x89PNG")
    assert {path.name for path in tmp_path.iterdir()} == {"run.json", "run.PNG"}


def test_a_failing_picture_does_not_lose_the_json(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("app.pictures.run.run_figure", lambda result: 1 / 0)
    status = main(["run", "bar", *QUICK, "--json", str(tmp_path / "a.json"), "--plot", str(tmp_path / "a.png")])
    assert status == 1 and "--plot" in capsys.readouterr().err
    assert set(json.loads((tmp_path / "a.json").read_text())) == KEYS


def test_a_failed_write_leaves_the_old_file(tmp_path, monkeypatch):
    path = tmp_path / "a.json"
    path.write_text("old")
    target = Target("json", str(path))
    monkeypatch.setattr(os, "replace", lambda *_: (_ for _ in ()).throw(OSError("full")))
    with pytest.raises(NotWritten, match=r"--json .* could not be written: full"):
        target.write(b"new")
    assert path.read_text() == "old" and list(tmp_path.iterdir()) == [path]


def test_json_refuses_what_json_has_not():
    with pytest.raises(ValueError, match="not JSON compliant"):
        json_text({"rate": float("nan")})


def test_unexpected_failures_are_one_line(monkeypatch, capsys):
    monkeypatch.setattr("app.commands.run.command._run", lambda *_: (_ for _ in ()).throw(MemoryError("no room")))
    monkeypatch.setattr("app.commands.dispatch._wants_traceback", lambda: False)
    assert main(["run", "bar"]) == 1
    assert capsys.readouterr().err == "mpm-lab: failed: MemoryError: no room\n"


@pytest.mark.skipif(os.name == "nt", reason="POSIX signals")
def test_interrupt_is_one_line_and_130(tmp_path):
    path = tmp_path / "a.json"
    run = subprocess.Popen([sys.executable, "-m", "app", "run", "bar", "--cells", "20000", "--dt", "1e-6",
                            "--t-end", "100", "--json", str(path)], cwd=ROOT, stderr=subprocess.PIPE, text=True)
    wait_for_library(run, "taichi")
    run.send_signal(signal.SIGINT)
    _, said = run.communicate(timeout=HANG)
    assert (run.returncode, said) == (130, "mpm-lab: interrupted\n")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(os.name == "nt", reason="POSIX pipes")
def test_a_reader_that_has_gone_is_no_fuss():
    read, write = os.pipe()
    os.close(read)
    done = subprocess.run([sys.executable, "-m", "app", "run", "bar", *QUICK], cwd=ROOT, stdout=write,
                          stderr=subprocess.PIPE, text=True, timeout=HANG)
    os.close(write)
    assert (done.returncode, done.stderr) == (141, "")


def test_an_interrupt_that_native_code_swallows_is_raised_later():
    with noted_interrupts() as check:
        check()
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)
        with pytest.raises(KeyboardInterrupt):
            check()
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
