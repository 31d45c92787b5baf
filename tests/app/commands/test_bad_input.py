"""Bad input is one sentence that names it and what is allowed, exit status 2, and nothing is run, written or loaded for
it: one table for all commands. What of hostile text is quoted is in ``test_refusals``."""

import shlex

import pytest

from app.cli import main
from app.commands import commands
from tests.support.processes import run_python

LONG = "a" * 300
#: A command line, and what is said of it: how that begins and, after an ellipsis, what follows. Lines are typed
#: in a folder with ``file``, a file of two particles; ``taken/table1.json``, a folder; and nothing else. What a scene
#: refuses is in the tests of scenes; of that here is what each kind of flag hands on.
BAD = {
    # the command itself
    "frobnicate": "frobnicate: is not a command; give mpm-lab serve or mpm-lab run",
    "serv": "serv: is not a command (did you mean serve?)",
    "run": "run: what? give mpm-lab run bar or mpm-lab run square or mpm-lab run ring or mpm-lab run vortex",
    "run rod": "rod: is not a command",
    "--cells 4": "--cells: is not a flag of mpm-lab serve",
    "--completion": "--completion … give one of bash, zsh, fish",
    "--completion=csh": "--completion csh: give one of bash, zsh, fish",
    "run --scene": "--scene …",
    "run --scene 'bar;cells=3'": "--scene bar;cells=3: … from 4",
    # numbers, of every kind of flag
    "run bar --cells 0": "--cells 0: … from 4 to 100,000",
    "run bar --cells 2.5": "--cells 2.5: … from 4 to 100,000",
    "run bar --cells 40.0": "--cells 40.0: … from 4 to 100,000",
    "run bar --cells abc": "--cells abc: … from 4 to 100,000",
    "run bar --cells": "--cells (no value): … from 4 to 100,000",
    "run bar --cells 8 9": "--cells 8 9: … whole number",
    "run bar --dt -1": "--dt -1: … above 0",
    "run bar --dt=-1": "--dt -1: … above 0",
    "run bar --amplitude 0.2": "--amplitude 0.2: … below 0.159",
    "run bar --dt 1e-3 --cfl 0.1": "--cfl 0.1: … dt is given too",
    "run ring --plan serial --threads 2": "--threads 2: … parallel or auto",
    # choices and names
    "run bar --body-force all": "--body-force all: … material, node, none",
    "run bar --method 'a\nb'": "--method a\\nb: … ugimp",
    "run bar --estimator foo": "--estimator foo: … transport",
    "run bar --estimator none transport": "--estimator none transport: … stands alone",
    "run bar --effects truth,foo": "--effects foo: … crossings",
    "run bar --effects all,truth": "--effects all truth: … stands alone",
    "run bar --effects": "--effects (no value): … names",
    "run bar --corrected transport": "--corrected transport: … recovered, companion, two-grid",
    "run bar --corrected recovered --effects estimate": "--corrected recovered: … truth",
    "run bar --goal foo": "--goal foo: … kinetic-energy",
    "run ring --effects truth,budget": "--effects budget: … mpm-lab budget ring",
    # words that no flag is
    "run bar --celss 3": "--celss: … did you mean --cells?",
    "run bar stray": "stray: is not expected",
    "run bar --layout polar": "--layout: is not a flag of mpm-lab run bar",
    "advise bar --tolerance 1e-3 --cells 40": "--cells: is not a flag",
    "judge bar file --out new --estimator companion": "--estimator: is not a flag",
    "problem bar --out new --method mpm": "--method: is not a flag",
    "tables 1 --out d --json -": "--json: is not a flag of mpm-lab tables",
    "sweep bar --out x --cellz 3": "--cellz: … did you mean --cells?",
    "bench --cells 4": "--cells: is not a flag of mpm-lab bench",
    "bench quick": "quick: is not expected",
    # files and folders
    "run bar --json no/such/x.json": "--json no/such/x.json: … directory that exists",
    "run bar --json .": "--json .: … is a directory",
    "run bar --json": "--json (no value): … give a file",
    f"run bar --json {LONG}": f"--json {'a' * 30}…{'a' * 29}: … name too long",
    "run bar --plot x.pdf": "--plot x.pdf: … .png",
    "run bar --json x.png --plot ./x.png": "--plot ./x.png: … --json too",
    "run bar --particles run.txt": "--particles run.txt: give a file that ends in .npz or .csv",
    "run bar --particles no/such/run.npz": "--particles no/such/run.npz: cannot be written",
    "run bar --particles run.npz --cells 2000 --sample-every 1": "--particles run.npz: … sample more rarely",
    "bench --json no/such/x.json": "--json no/such/x.json: … directory that exists",
    "budget bar --plot x.pdf": "--plot x.pdf: give a file that ends in .png",
    "export bar --out a.htm": "--out a.htm: give a file that ends in .html",
    "export bar --out no/such/a.html": "--out no/such/a.html: cannot be written",
    "lesson guide 1 --out x.doc": "--out x.doc: give a file that ends in .md or .html",
    "sweep bar --cells 20": "--out (no value): give a directory",
    "sweep bar --out file": "--out file: is a file",
    "sweep bar --out .": "--out .: is not empty",
    "tables 1": "--out (no value): give a directory for the rows, tables and pictures",
    "tables 1 --out file/below": "--out file/below: cannot be used: not a directory",
    f"tables 1 --out {LONG}": "--out … name too long; give a directory",
    "tables 1 --out taken": "--out taken/table1.json: cannot be written: is a directory",
    "problem bar": "--out (no value): give a directory",
    "problem bar --out taken": "--out taken: is not empty; give an empty or a new directory",
    "problem bar --out file/below": "--out file/below: cannot be a directory",
    "judge bar file": "file: is of no kind that is known",
    "judge bar file --out file/x": "--out file/x: … not a directory",
    "sweep bar --out file/x": "--out file/x: … not a directory",
    "check file --out file/x": "--out file/x: … not a directory",
    "export bar --out file/x.html": "--out file/x.html: … not a directory",
    "lesson grade file --out file/x.csv": "--out file/x.csv: … not a directory",
    "judge bar file --out .": "--out .: is not empty; give an empty or a new directory",
    "coverage ring": "--out … give",
    "coverage body": "--out … give",
    # what only some commands take
    "serve --port 0": "--port 0: give a whole number from 1 to 65535",
    "serve --port http": "--port http: give a whole number",
    "serve --max-sessions 0": "--max-sessions 0: give a whole number",
    "serve --frames 0": "--frames 0: give a number above 0 and up to 60",
    "serve --host ''": "--host (no value):",
    "serve --host localhost:9000": "--host localhost:9000: give the name or the address of this machine",
    "serve --host ::1::2": "--host ::1::2: give the name or the address of this machine",
    "serve --host 'two words'": "--host two words: give the name or the address of this machine",
    "serve --host '\x1b[31mevil\u202e'": "--host … give the name or the address of this machine",
    "serve --lesson 99": "99: there is no lesson",
    "serve --board": "--board: needs --lesson with the name or number of a lesson",
    "serve --board --lesson 4 --code short": "--code short: give 6 to 64 letters and digits, or none",
    "sweep bar --out x --cells 2 3": "--cells 2: give a whole number from 4",
    "sweep bar --out x --amplitude 0.2 0.3": "--amplitude 0.2: the exact bar inverts",
    "sweep bar --out x --dt 1e-3 --cfl 0.1 0.2": "--cfl 0.1: dt is given too",
    "sweep bar --out x --workers 0": "--workers 0: give a whole number from 1 to 1,024",
    "sweep bar --out x --repeats many": "--repeats many: give a whole number",
    "sweep bar --out x --scheduler there": "--scheduler there: give the address of a Dask scheduler",
    "sweep bar --out x --scheduler tcp://a:1 --workers 2": "--workers 2: is for this machine",
    f"sweep bar --out x --modulus {' '.join(map(str, range(1, 200)))} --cells {' '.join(map(str, range(4, 100)))}":
        " … too many",
    "tables 4 --out d": "4: is not a table of the paper; give 1, 2, 3 or all",
    "tables 1 --out x --processes 0": "--processes 0: give a whole number from 1",
    "stability bar --out x --treatment prayer": "--treatment prayer: is not known",
    "stability bar --out x --method cpdi": "--method cpdi: is not known",
    "advise bar": "--tolerance (no value): give the error that is allowed",
    "advise bar --tolerance small": "--tolerance small: give a number above 0",
    "advise bar --tolerance 1e-3 --budget -1": "--budget -1: give a number above 0",
    "advise bar --tolerance 1e-3 --quantity y": "--quantity y: give one of x, v, sigma, a",
    "advise bar --tolerance 1e-3 --method cpdi": "--method cpdi: is not known (did you mean cpgimp?); give",
    "advise bar --tolerance 1e-3 --ppc 0": "--ppc 0: give a whole number from 1 to 64",
    "advise bar --tolerance 1e-3 --cfl fast": "--cfl fast: give a number above 0",
    "coverage ring --out new --runs 0": "--runs 0: give a whole number from 1 to 10,000",
    "coverage body --out new --runs 0": "--runs 0: give a whole number from 1 to 10,000",
    "coverage ring --out new --seed -1": "--seed -1: give a whole number from 0 to 2,147,483,647",
    "bench --history a.jsonl": "--history: is gone from mpm-lab bench",
    "bench --waits": "--waits: is gone from mpm-lab bench: assets/speed.md",
    "bench --beside=.": "--beside: is gone from mpm-lab bench",
    "bench --class many": "--class many: give a whole number from 1 to",
    "bench --class 2 --minutes -1": "--minutes -1: give a number above 0",
    "budget bar --effects none": "--effects none: a budget needs the effect truth",
    "budget ring --body-force two-tone --estimator none": "--body-force two-tone: leaves no exact solution",
    "budget bar --take-away gravity": "--take-away gravity: … coarse_grid",
    "budget ring --take-away gravity": "--take-away gravity: … coarse_grid",
    "budget bar --plot a.png --json a.png": " … is the file of --json too",
    "budget bar --map map.png": "--map: is gone from mpm-lab budget bar",
    "budget ring --particle 3": " … --plot draws",
    "budget ring --body-force none": " … give material",
    "budget ring --arch gpu": " … cpu",
    "budget ring --method ugimp --remedies null-space-filter": " … frozen-weights",
    "problem bar --out new --times soon": "--times soon: is no time; give seconds from 0 on",
    "problem bar --out new --times -1": "--times -1: is no time",
    "problem bar --out new --cells 1": "--cells 1: give a whole number",
    f"problem bar --out new --cells 9000 --times {' '.join(map(str, range(600)))}": " … at most 4,000,000 are allowed",
    "judge bar": "give one or several files of particles",
    "judge bar not-there.csv --out new": "not-there.csv: cannot be read: no such file or directory",
    "judge bar file --out new --cells 12 --time 1 2": "--time 1 2: gives 2 times for 1 files",
    "judge bar file --out new --cells 12 --time soon": "--time soon: is no time",
    "judge bar file --out new --cells '12 20'": " … gives 2 grids for 1 files",
    "judge bar file --out new --cells two": "--cells two: give a whole number",
    "check": "give one or several files of particles",
    "check no.csv": "no.csv: cannot be read",
    "check file --time 1 2": "--time 1 2: gives 2 times for 1 files",
    "check file --expect 'order.x > 1'": "--expect …",
    "lesson check 99": "99: there is no lesson '99'",
    "lesson check --processes 0": "--processes 0: … from 1 to 64",
    "lesson grade": " … give the files that students have handed in",
    "lesson guide": "give one of 01-one-step, 02-",
    "body show": "give one of cantilever, ",
    "lesson guide 1 --lang xy": "--lang xy: … give one of en, de",
    "export 'bar cells=2' --out a.html": " … cells=2: give a whole number from 4",
    "export 'bar cels=40' --out a.html": " … did you mean cells?",
    "export 'bar cells=10000 periods=100' --out a.html": " … too long to record",
    "export no-such-lesson --out a.html": " … there is no lesson 'no-such-lesson'",
    "export bar --out a.html --processes 0": "--processes 0: give a whole number",
    "export 'bar cells=8' --scorm --out a.zip": " … is no lesson, and a course keeps a score of lessons alone",
    "export --scorm --out a.zip": " … give lessons by name or number",
    "export 1 99 --scorm --out a.zip": " … there is no lesson '99'",
    "export 'bar cells=8' --core --out x.html": "--core bar cells=8: a scene has no core; give a lesson",
    "export 1 --scorm --out a.html": "--out a.html: give a file that ends in .zip",
    "export 1 --out a.zip": "--out a.zip: give a file that ends in .html",
    "export 1 4 --out a.html": "1 4: … a file has one lesson; give one, or --scorm for a package of several",
}


@pytest.mark.parametrize("line", BAD, ids=[line[:50] for line in BAD])
def test_bad_input_is_one_sentence(line, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").write_text("id,x\n1,0.2\n2,0.4\n")
    (tmp_path / "taken" / "table1.json").mkdir(parents=True)
    for run in ("app.commands.run.command._run_and_try_cures", "app.page.page_server.serve",
                "app.commands.study.study_command.Study._announce"):
        monkeypatch.setattr(run, lambda *_: pytest.fail("it ran before it had checked"))
    before = files(tmp_path)
    assert main(shlex.split(line)) == 2
    seen = capsys.readouterr()
    begins, _, follows = BAD[line].partition("…" if BAD[line].endswith("…") else " … ")
    assert seen.out == "" and seen.err.count("\n") == 1
    assert seen.err.startswith(f"mpm-lab: {begins.strip()}") and follows in seen.err
    assert files(tmp_path) == before


def files(folder):
    """What a folder holds."""
    return {path: path.read_text() if path.is_file() else "" for path in folder.rglob("*")}


ALONE = ("sweep bar --out x --workers 0", "tables 4 --out d", "advise bar", "bench quick", "serve --port 0", "check")
HEAVY = ("taichi", "viser", "matplotlib", "distributed")


def test_help_and_bad_input_load_nothing_heavy(tmp_path):
    """Of any command, one after the other in one process, which says after which of them there was something heavy."""
    lines = [["--version"], ["--help"], ["--completion", "bash"]]
    lines += [[*name, *words] for name in commands() if name[-1] not in ("ring", "vortex")
              for words in (["--help"], ["--celss", "3"])]
    lines += [shlex.split(line) for line in BAD if "bar --cells" in line or line in ALONE]
    code = (f"import sys\nfrom app.cli import main\nfor arguments in {lines}:\n    main(arguments)\n"
            f"    heavy = [name for name in {HEAVY} if name in sys.modules]\n"
            "    if heavy: sys.exit(f'{arguments}: {heavy}')\n")
    done = run_python("-c", code, cwd=tmp_path)
    assert done.returncode == 0, done.stderr[-2000:]
