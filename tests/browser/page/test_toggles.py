"""Whatever is switched, the stage goes on: what must be compiled first is compiled beside it."""

from __future__ import annotations

import re
from itertools import pairwise

import pytest

from tests.browser.conftest import visit
from tests.browser.driving import choose, engine_processes, readout, scene, steps, tick, unfold, until
from tests.listening import PATIENCE
from tests.processes import children, held, starving

COMPILING = "[data-waits^=compiling]"  # beside the name of the control that was changed last
LONGEST = 1.0  # seconds that the stage may stand still, whatever has to be compiled
#: Notes when the stage moves: frames reach the page from a worker of the viewer's.
NOTE_MOVES = """
window.moves = [];
const Usual = window.Worker;
window.Worker = class extends Usual {
  constructor(...how) {
    super(...how);
    this.addEventListener("message", event => {
      if ((event.data.messages || []).some(m => /\\/field\\/particles$/.test(m.name || "")))
        window.moves.push(performance.now() / 1000);
    });
  }
};
"""


def compilers(server):
    """Ids of the forks of the engines that are at work."""
    return [child for engine in engine_processes(server[1]) for child in children(engine, "spawn_main")]


def ticks(page, *names):
    """Switches, each a function that clicks one box."""
    return [lambda name=name: tick(page, name) for name in names]


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
        with held(found):
            if found and compilers(server) == found:
                until(page.locator(COMPILING).is_visible, "the word")
                before = steps(page)
                until(lambda: steps(page) > before, "the run before going on")  # noqa: B023
                break
    else:
        raise AssertionError("no compiler was caught")
    until(lambda: page.locator(COMPILING).count() == 0, "no word left", PATIENCE)


def test_toggles_in_a_row_are_all_met(page):
    """Faster than anything can be compiled: the last state is on the stage in the end, and the run has not stopped."""
    until(lambda: steps(page) > 20, "a run under way")
    unfold(page, "Effects: compute")
    for switch in [*ticks(page, "companion", "energy", "two-grid"), lambda: choose(page, "Method", "B-spline"),
                   *ticks(page, "two-grid", "companion"), lambda: choose(page, "Method", "cpGIMP"),
                   *ticks(page, "companion")]:
        switch()
    until(lambda: page.locator(COMPILING).count() == 0 and "companion" in readout(page)
          and not re.search(r"two-grid|^energy\t", readout(page), re.M), "what was wished last", PATIENCE)
    before = steps(page)
    until(lambda: steps(page) != before, "a run that goes on")


@pytest.mark.slow
def test_the_stage_never_stands_still(server, chromium):
    """A dozen toggles, nearly all of which have to be compiled: in the page itself no two frames of the stage come
    longer apart than one would notice, but for time in which other work had the processors."""
    with visit(chromium, server[0], script=NOTE_MOVES) as page:
        until(lambda: page.evaluate("window.moves.length") > 20, "a moving stage")
        unfold(page, "Effects: compute")
        for switch in [*ticks(page, "companion", "energy", "transport"), lambda: choose(page, "Method", "MPM"),
                       *ticks(page, "two-grid", "recovered"), lambda: choose(page, "Method", "cpGIMP"),
                       lambda: choose(page, "Problem", "expanding ring"), *ticks(page, "companion"),
                       lambda: choose(page, "Method", "uGIMP"), *ticks(page, "transport"),
                       lambda: choose(page, "Problem", "vibrating bar")]:
            before = scene(page)
            with starving() as starved:
                page.evaluate("window.moves = window.moves.slice(-1)")
                switch()
                until(lambda: scene(page) != before, "another scene", PATIENCE)  # noqa: B023
                count = page.evaluate("window.moves.length")
                until(lambda: page.evaluate("window.moves.length") > count + 3, "it moves")  # noqa: B023
                moves = page.evaluate("window.moves")
                still = max(later - earlier for earlier, later in pairwise(moves))
                assert still < LONGEST + starved(), scene(page)
