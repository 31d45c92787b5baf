"""The command line: flags that reach a scene, clean standard output, whole files, exit statuses."""

from __future__ import annotations

import json
import os
import signal
from functools import partial

import pytest

from app import __version__
from app.cli import main
from app.commands import commands
from app.commands.output import NotWritten, OutputTarget
from app.commands.progress import record_interrupts
from solvers.problems import PROBLEMS
from solvers.problems.bar.scene import BarScene
from solvers.problems.ring import RingScene
from solvers.scene.effects import EFFECTS
from tests.support.processes import run_python

RunBar, RunRing = commands()["run", "bar"], commands()["run", "ring"]
QUICK = ["run", "bar", "--cells", "8", "--ppc", "2", "--periods", "0.2"]
WIDE = ["run", "ring", "--cells", "12", "--periods", "0.1"]


#: Runs ``python -m app`` as a person would.
command = partial(run_python, "-m", "app")


def test_standard_output_has_the_object_or_the_table_and_nothing_else():
    """And where the terminal has not all signs, the table is there all the same."""
    done, table = command(*QUICK, "--json", "-"), command(*QUICK, PYTHONIOENCODING="ascii")
    assert (done.returncode, table.returncode, done.stdout.count("\n")) == (0, 0, 1), done.stderr + table.stderr
    assert done.stderr == table.stderr == "" and "Taichi" not in table.stdout  # no terminal, no bar
    printed = json.loads(done.stdout)
    assert f"{printed['error']['x']['max']:.3e}" in table.stdout and "ok:" in table.stdout
    assert f"{printed['index']['sigma']:.3f}" in table.stdout and "a (m/s?)" in table.stdout


def test_an_extension_that_is_not_there_is_one_line():
    done = command(*QUICK, MPM_LAB_EXTENSIONS="tests.support.fake_rows,no_such_module")
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert "MPM_LAB_EXTENSIONS names no_such_module, which cannot be imported" in done.stderr
    assert "name its folder in PYTHONPATH" in done.stderr


def test_version(capsys):
    assert main(["--version"]) == 0
    assert capsys.readouterr().out == f"mpm-lab {__version__}\n"


@pytest.mark.parametrize("problem", PROBLEMS)
def test_flags_left_out_are_the_scenes_defaults(problem):
    assert commands()["run", problem]().scene() == PROBLEMS[problem].scene()


@pytest.mark.parametrize("line, scene", [
    ("bar --method cpgimp --cells 1e2 --ppc 2 --amplitude 0.1 --modulus 9 --density 2 --dt 1e-4 --t-end 0.5 "
     "--body-force node --linearity-preserving --velocity corners --estimator none --effects truth,energy --threads 2 "
     "--sample-every 7",
     BarScene(method="cpgimp", cells=100, ppc=2, amplitude=0.1, modulus=9.0, density=2.0, dt=1e-4, t_end=0.5,
              body_force="node", linearity_preserving=True, velocity="corners", estimators=(),
              effects=("truth", "energy"), threads=2, sample_every=7)),
    ("ring --method ugimp --cells 16 --ppc 3 --amplitude 0.05 --modulus 1e6 --density 900 --cfl 0.1 --t-end 0.01 "
     "--body-force none --velocity particle --layout cartesian --plan parallel --estimator none --effects truth "
     "--threads 2 --sample-every 7",
     RingScene(method="ugimp", cells=16, ppc=3, amplitude=0.05, modulus=1e6, density=900.0, cfl=0.1, t_end=0.01,
               body_force="none", velocity="particle", layout="cartesian", plan="parallel", estimators=(),
               effects=("truth",), threads=2, sample_every=7)),
    ("bar --effects none", BarScene(effects=())), ("bar --effects all", BarScene(effects=(*EFFECTS, "budget"))),
    ("bar --effects truth energy", BarScene(effects=("truth", "energy")))])
def test_flags_reach_the_scene(line, scene, monkeypatch):
    seen = []
    for kind in (RunBar, RunRing):
        monkeypatch.setattr(kind, "execute", lambda self: seen.append(self.scene()) or 0)
    assert main(["run", *line.split()]) == 0 and seen == [scene]


def test_bare_command_and_flags_without_command_serve(monkeypatch):
    from app.commands.serve import Serve
    seen = []
    monkeypatch.setattr(Serve, "execute", lambda self: seen.append((self.host, self.port, self.warm_up)) or 0)
    assert main([]) == 0 and main(["--port", "9000"]) == 0 and main(["serve", "--no-warm-up"]) == 0
    assert seen == [("127.0.0.1", 8080, True), ("127.0.0.1", 9000, True), ("127.0.0.1", 8080, False)]


@pytest.mark.parametrize("line", [[*QUICK, "--periods", "5", "--cfl", "1.5"],
                                  [*WIDE, "--periods", "0.5", "--cfl", "1.2"]], ids=["bar", "ring"])
def test_an_unstable_run_exits_3_and_still_prints_its_json(line, capfd):
    assert main([*line, "--json", "-"]) == 3
    out, said = capfd.readouterr()
    values = json.loads(out, parse_constant=lambda name: pytest.fail(f"{name} is not JSON"))
    warning, reason = said.splitlines()
    assert values["status"] == "unstable" and "above the" in warning and "--dt auto" in warning
    assert values["reason"] in reason


def test_a_large_amplitude_is_a_warning_and_quiet_is_quiet(capfd):
    assert main([*WIDE, "--amplitude", "0.2", "--effects", "none"]) == 0
    said = capfd.readouterr().err
    assert said.startswith("mpm-lab: warning: amplitude 0.2: above 0.115") and said.count("\n") == 1
    assert main([*WIDE, "--amplitude", "0.2", "--effects", "none", "--quiet"]) == 0
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize("line", [QUICK, WIDE], ids=["bar", "ring"])
def test_files_are_whole_and_alone(line, tmp_path, capfd):
    assert main([*line, "--json", str(tmp_path / "run.json"), "--plot", str(tmp_path / "run.PNG")]) == 0
    assert capfd.readouterr() == ("", "")
    assert json.loads((tmp_path / "run.json").read_text())["status"] == "ok"
    assert (tmp_path / "run.PNG").read_bytes().startswith(b"\x89PNG")
    assert {path.name for path in tmp_path.iterdir()} == {"run.json", "run.PNG"}


def test_a_failing_picture_does_not_lose_the_json(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("app.pictures.run_errors.run_figure", lambda result: 1 / 0)
    assert main([*QUICK, "--json", str(tmp_path / "a.json"), "--plot", str(tmp_path / "a.png")]) == 1
    assert "--plot" in capsys.readouterr().err
    assert json.loads((tmp_path / "a.json").read_text())["status"] == "ok"


@pytest.mark.parametrize(("flag", "key", "names"), [
    (["--estimators", "companion"], "estimator", ["companion"]), (["--estimate=transport"], "estimator", ["transport"]),
    (["--effect", "truth"], "effects", ["truth"]), (["--remedy", "zero-drift"], "remedies", ["zero-drift"])])
def test_other_words_for_a_flag(flag, key, names, capsys):
    assert main([*QUICK, *flag, "--json", "-"]) == 0
    assert json.loads(capsys.readouterr().out)["scene"][key] == names


def test_a_failed_write_leaves_the_old_file(tmp_path, monkeypatch):
    path = tmp_path / "a.json"
    path.write_text("old")
    target = OutputTarget("json", str(path))
    monkeypatch.setattr(os, "replace", lambda *_: (_ for _ in ()).throw(OSError("full")))
    with pytest.raises(NotWritten, match=r"--json .* could not be written: full"):
        target.write(b"new")
    assert path.read_text() == "old" and list(tmp_path.iterdir()) == [path]


def test_an_interrupt_that_native_code_swallows_is_raised_later():
    with record_interrupts() as check:
        check()
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)
        with pytest.raises(KeyboardInterrupt):
            check()
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
