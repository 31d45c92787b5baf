"""Which tests ``uv run pytest`` runs, those that take less than a second of a processor, and how processes share them.

A pytest plugin. ``long_tests.txt`` lists the other tests with the seconds that they took, kernels compiled anew; those
in a browser are long all the same. ``--long`` runs them too, ``--long -m long`` only them, and so does naming a file or
a test. A test marked ``short`` stays however long it takes, ``slow`` ones run with ``--slow`` alone. After tests have
come or gone::

    uv run --all-groups pytest --long --update-long-tests
"""

from __future__ import annotations

import os
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest
from xdist.scheduler import LoadScopeScheduling
from xdist.workermanage import WorkerController

LIST = Path(__file__).with_name("long_tests.txt")
BROWSER = "tests/browser/"
LONG = 1.0  # seconds of processor time from which on a test is long
LIMIT = 15.0  # seconds of this process that no short test may take where CI is set, should it compile for others too


def read_long_tests() -> dict[str, float]:
    """Seconds of processor time of each long test, by its id."""
    rows = (line.split(maxsplit=1) for line in LIST.read_text(encoding="utf-8").splitlines())
    return {name: float(seconds) for seconds, name in rows}


def write_long_tests(seconds: dict[str, float]) -> None:
    """Write the list anew: tests that were measured as they are now, others as they were."""
    rows = {name: spent for name, spent in (read_long_tests() | seconds).items()
            if spent >= LONG and not name.startswith(BROWSER)}
    LIST.write_text("".join(f"{spent:.1f} {name}\n" for name, spent in sorted(rows.items())), encoding="utf-8")


def seconds_by_file() -> Counter[str]:
    """Processor time of the long tests of each file."""
    total: Counter[str] = Counter()
    for name, seconds in read_long_tests().items():
        total[name.partition("::")[0]] += seconds
    return total


def cpu_seconds() -> float:
    """Processor time of this process so far, and of those that it has started and waited for."""
    spent = os.times()
    return spent.user + spent.system + spent.children_user + spent.children_system


def slowness() -> float:
    """How many times as long this machine takes now as the one on which the list of long tests was made, .1 s."""
    begun = time.process_time()
    sum(range(5_000_000))
    return max(1.0, (time.process_time() - begun) / 0.1)


def is_everything(config: pytest.Config) -> bool:
    """Whether all tests were asked for, by no name of a file or test; processes of tests hear it from the first."""
    if hasattr(config, "workerinput"):
        return config.workerinput["everything"]
    return config.args_source is not pytest.Config.ArgsSource.ARGS


def runs_long_tests(config: pytest.Config) -> bool:
    """Whether long tests are among those that run."""
    return config.getoption("--long") or config.getoption("--slow") or not is_everything(config)


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--long", action="store_true", help="run the long tests too")
    parser.addoption("--slow", action="store_true", help="run the long and the slow tests too")
    parser.addoption("--update-long-tests", action="store_true", help=f"write tests/{LIST.name} anew after this run")


def pytest_configure(config: pytest.Config) -> None:
    config.pluginmanager.register(ProcessorTime(config), "processor time of tests")


def pytest_report_header(config: pytest.Config) -> str:
    left_out = [name for name, runs in (("long", runs_long_tests(config)), ("slow", config.getoption("--slow")))
                if not runs]
    return "all tests" if not left_out else f"without {' and '.join(left_out)} tests (--{left_out[-1]} runs them all)"


def pytest_configure_node(node: WorkerController) -> None:
    node.workerinput["everything"] = is_everything(node.config)


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    listed = read_long_tests()
    for item in items:
        if (item.nodeid in listed or item.nodeid.startswith(BROWSER)) and not item.get_closest_marker("short"):
            item.add_marker("long")
    complete = is_everything(config) and not config.getoption("ignore") and os.environ.get("CI")
    if complete and (gone := listed.keys() - {item.nodeid for item in items}):
        raise pytest.UsageError(f"tests/{LIST.name} names tests that are gone: {', '.join(sorted(gone))}")
    left_out = {"slow"} if not config.getoption("--slow") else set()
    left_out |= {"long"} if not runs_long_tests(config) else set()
    deselected = {item for item in items if any(item.get_closest_marker(mark) for mark in left_out)}
    if deselected:
        config.hook.pytest_deselected(items=list(deselected))
        items[:] = [item for item in items if item not in deselected]


#: Files with tests in the browser, shared out to so many processes: each starts a server and a browser once. Three of
#: four processes would leave each browser less of a processor than a visitor's patience bears.
BROWSERS = 2
BROWSER_FILES = sorted(path.name for path in (Path(__file__).parent / "browser").rglob("test_*.py"))


def pytest_xdist_auto_num_workers(config: pytest.Config) -> int:
    """Those in the browser wait a lot, for two processors four processes are right; without them, two."""
    return 4 if runs_long_tests(config) else 2


#: Files whose tests run the same scenes of the plane: one process compiles these once, in tens of seconds.
SAME_KERNELS = {f"tests/solvers/{name}.py" for name in ("estimators/test_accuracy", "running/test_same_bits",
                                                        "estimators/test_recovered", "estimators/test_two_grid")}


class FileByFile(LoadScopeScheduling):
    """Tests of a file share what it prepares, so one process runs them; and of those in the browser each part: by the
    alphabet, which divides the time that they take better than taking turns does. What takes longest is begun first:
    one process would still be at it when the others have ended."""

    is_sorted = False

    def _assign_work_unit(self, node: WorkerController) -> None:
        if not self.is_sorted:
            self.is_sorted, seconds = True, seconds_by_file()
            rows = sorted(self.workqueue.items(), key=lambda row: (not row[0].startswith("browser"),
                                                                   row[0] != "same kernels", -seconds[row[0]]))
            self.workqueue.clear()
            self.workqueue.update(rows)
        super()._assign_work_unit(node)

    def _split_scope(self, nodeid: str) -> str:
        path = Path(nodeid.partition("::")[0])
        if not nodeid.startswith(BROWSER):
            return "same kernels" if str(path) in SAME_KERNELS else str(path)
        return f"browser {BROWSERS * BROWSER_FILES.index(path.name) // len(BROWSER_FILES)}"


def pytest_xdist_make_scheduler(config: pytest.Config, log: object) -> FileByFile:
    """Who runs what where there are several processes."""
    return FileByFile(config, log)


class ProcessorTime:
    """Measures what each test takes of a processor, with the shared fixtures that it uses, and fails a short one that
    takes too much where CI is set."""

    def __init__(self, config: pytest.Config):
        self.config, self.seconds = config, dict[str, float]()
        self.shared = dict[str, float]()  # of the fixture with that name that was set up last
        self.begun, self.own_fixtures, self.own_begun = 0.0, 0.0, 0.0

    @pytest.hookimpl(wrapper=True)
    def pytest_fixture_setup(self, fixturedef: pytest.FixtureDef, request: pytest.FixtureRequest) -> Iterator[None]:
        begun, own_begun = cpu_seconds(), time.process_time()
        try:
            return (yield)
        finally:
            if fixturedef.scope != "function":
                self.shared[fixturedef.argname] = spent = cpu_seconds() - begun
                self.own_fixtures += spent
                self.own_begun += time.process_time() - own_begun

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_setup(self, item: pytest.Item) -> Iterator[None]:
        self.begun, self.own_fixtures, self.own_begun = cpu_seconds(), 0.0, time.process_time()
        return (yield)

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_teardown(self, item: pytest.Item) -> Iterator[None]:
        result = yield
        spent = cpu_seconds() - self.begun - self.own_fixtures
        shared = sum(self.shared.get(name, 0.0) for name in item.fixturenames)
        item.user_properties.append(("processor", spent + shared))
        short = not any(item.get_closest_marker(mark) for mark in ("long", "slow", "short"))
        own = time.process_time() - self.own_begun  # without children, whose time counts when they are waited for
        if short and own > LIMIT and own > LIMIT * slowness() and os.environ.get("CI"):
            pytest.fail(f"{own:.1f} s of a processor, and a short test has {LIMIT:g}: make it cheaper, or list it "
                        f"in tests/{LIST.name}")
        return result

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.when == "teardown":
            self.seconds[report.nodeid] = dict(report.user_properties).get("processor", 0.0)

    def pytest_sessionfinish(self) -> None:
        if self.config.getoption("--update-long-tests") and not hasattr(self.config, "workerinput"):
            write_long_tests(self.seconds)
