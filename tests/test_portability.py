"""Other systems than Linux, as far as Linux can tell: what they have not is hidden, or looked for in the text."""

import ast
import os
import shlex
import subprocess
import sys

import pytest
import yaml

from tests.support.paths import ROOT
from tests.support.processes import HANG

#: What Windows has not; macOS has all but the scheduler's.
MODULES = ("fcntl", "grp", "pwd", "resource", "termios")
NAMES = {"os": {"fork", "getloadavg", "getpriority", "getuid", "geteuid", "killpg", "nice", "sched_getaffinity",
                "sched_setscheduler", "sched_param", "setpriority", "uname", "WNOHANG", "SCHED_BATCH", "SCHED_IDLE",
                "SCHED_OTHER", "PRIO_PROCESS"},
         "signal": {"SIGKILL", "SIGSTOP", "SIGCONT", "SIGHUP", "SIGUSR1", "SIGALRM", "pthread_sigmask"}}
#: Python and NumPy use these themselves, on a system that says that it has them.
OF_PYTHON = {"uname", "WNOHANG", "SIGKILL", "SIGSTOP", "SIGHUP", "pthread_sigmask"}
#: Files that use such names, and why they may.
MAY = {"solvers/engine/compiling_fork.py": "forks, where it is POSSIBLE",
       "solvers/engine/surveyor.py": "forks, where it is POSSIBLE", "solvers/engine/forked_child.py": "of such a fork",
       "solvers/engine/engine_process.py": "buries what was forked, and nothing else",
       "solvers/workers/worker_pool.py": "suppresses the AttributeError",
       "solvers/bench/all_benchmarks.py": "asks hasattr", "solvers/judging/uploaded_file_worker.py": "on Linux only",
       "app/commands/bench/class_load.py": "asks hasattr", "solvers/study/row_store.py": "suppresses the ImportError"}


def foreign(text):
    """Modules and names of the above that a source uses."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name in MODULES)
        elif isinstance(node, ast.ImportFrom):
            names = NAMES.get(node.module or "", set())
            yield from ([node.module] if node.module in MODULES else [])
            yield from (alias.name for alias in node.names if alias.name in names)
        elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            yield from {node.attr} & NAMES.get(node.value.id, set())


def test_what_only_some_systems_have_is_used_where_it_is_asked_for():
    sources = [path for room in ("app", "solvers", "lessons") for path in (ROOT / room).rglob("*.py")]
    users = {path.relative_to(ROOT).as_posix() for path in sources if set(foreign(path.read_text(encoding="utf-8")))}
    assert users == set(MAY)
    assert set(foreign("import os, fcntl\nfrom signal import SIGKILL\nos.nice(0)")) == {"fcntl", "SIGKILL", "nice"}


@pytest.fixture(scope="module")
def elsewhere(tmp_path_factory):
    """The environment of processes, and of those that they start, in which those modules and names are missing, and
    whose pipes take what Windows' take."""
    folder = tmp_path_factory.mktemp("elsewhere")
    hidden = {module: sorted(names - OF_PYTHON) for module, names in NAMES.items()}
    (folder / "sitecustomize.py").write_text(
        f"import os, signal, sys\nsys.modules.update(dict.fromkeys({MODULES}))\n"
        f"for module, names in {hidden}.items():\n    for name in names:\n"
        "        vars(sys.modules[module]).pop(name, None)\n", encoding="utf-8")
    return {**os.environ, "PYTHONPATH": str(folder), "PYTHONIOENCODING": "cp1252", "PYTHONUTF8": "0"}


def smoke():
    """The commands that the workflow tries on other systems."""
    workflow = yaml.safe_load((ROOT / ".github" / "workflows" / "tests.yml").read_text(encoding="utf-8"))
    for step in workflow["jobs"]["smoke"]["steps"]:
        if (command := step.get("run", "")).startswith("mpm-lab "):
            slow = [pytest.mark.slow] if "export" in command else []  # records the runs of all sliders
            yield pytest.param(command, id=command, marks=slow)


@pytest.mark.parametrize("command", list(smoke()))
def test_a_command_runs_without_them(command, elsewhere, tmp_path):
    done = subprocess.run([sys.executable, "-m", "app", *shlex.split(command)[1:]], cwd=tmp_path, env=elsewhere,
                          capture_output=True, timeout=HANG)
    assert (done.returncode, b"Traceback" in done.stderr) == (0, False), done.stderr.decode(errors="replace")
