"""Whatever is switched, the stage goes on: what must be compiled first is compiled beside it."""

import pytest

from tests.browser.driving import choose, engine_processes, steps, tick, until
from tests.support.processes import children, stop_processes
from tests.support.session_listener import PATIENCE

COMPILING = "[data-waits^=compiling]"  # beside the name of the control that was changed last


def compilers(server):
    """Ids of the forks of the engines that are at work."""
    return [child for engine in engine_processes(server[1]) for child in children(engine, "spawn_main")]


def ticks(page, *names):
    """Switches, each a function that clicks one box."""
    return [lambda name=name: tick(page, name) for name in names]


@pytest.mark.slow
def test_the_stage_goes_on_beside_the_compiler(page, server):
    """A compiler that is held still takes as long as the test likes: a word stands beside what was switched, the run
    before goes on, and when the compiler is done, the word goes. One may be too quick to be held: then the next.
    """
    until(lambda: steps(page) > 20, "a run under way")
    switches = [*ticks(page, "companion", "two-grid", "transport"), lambda: choose(page, "Method", "B-spline"),
                *ticks(page, "transport", "two-grid", "companion"), lambda: choose(page, "Method", "cpGIMP")]
    for switch in switches:
        switch()
        for _ in range(100):
            page.wait_for_timeout(5)
            if found := compilers(server):
                break
        with stop_processes(found):
            if found and compilers(server) == found:
                until(page.locator(COMPILING).is_visible, "the word")
                before = steps(page)
                until(lambda: steps(page) > before, "the run before going on")  # noqa: B023
                break
    else:
        raise AssertionError("no compiler was caught")
    until(lambda: page.locator(COMPILING).count() == 0, "no word left", PATIENCE)
