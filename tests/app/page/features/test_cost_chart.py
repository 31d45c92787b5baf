"""The chart of the Cost tab: what is drawn where, what can be compared, and the answer above it."""

import re
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest

from app.colour_palette import GROUNDS, METHOD_COLOURS
from app.page.features.cost import visitor_run_list
from app.page.features.cost.cost_chart import (
    LogAxis,
    answer_headline,
    axes_for,
    axis_around,
    best_without_curve,
    curve_names,
    draw_runs,
    tolerance_line,
)
from app.page.features.cost.cost_texts import format_percent, format_seconds
from app.page.features.cost.visitor_run_list import (
    LIVE,
    SEARCH,
    SWEEP,
    VisitorRunList,
    cheapest_run,
    comparable_runs,
    pareto_front,
    run_of_scene,
)
from app.page.panels.page_header import WEB
from solvers.problems.bar.scene import BarScene
from solvers.study.parameter_grid import task_of
from solvers.study.row import failed_row
from tests.app.test_colours import contrast
from tests.support.fake_rows import fake_row

SCENE = BarScene(method="ugimp", cells=20)  # what rows are made up of
NBSP = "\N{NO-BREAK SPACE}"


def judged(method="ugimp", cells=20, size=1e-3, **changed):
    """A row as a search knows it: of the errors the estimate only, of A as a part."""
    estimate = {"companion": {"x": {"max": size * SCENE.amplitude}}}
    return {**fake_row(method, cells), "error": {}, "estimate": estimate, **changed}


def numbered(*rows):
    """Runs with these rows and sources."""
    runs = VisitorRunList()
    for row, source in rows:
        runs.add(row, source)
    return runs.all()


def drawn(runs, scene=SCENE, tolerance=1e-3):
    return draw_runs(runs, comparable_runs(runs, scene), scene, axes_for(runs, tolerance))


def sweep(*methods):
    return [(fake_row(method, cells), SWEEP) for method in methods for cells in (10, 20, 40)]


def buttons(drawing):
    """Classes, place and words of every dot, by its run."""
    found = {}

    class Reader(HTMLParser):
        def handle_starttag(self, tag, attributes):
            have = dict(attributes)
            if tag == "button":
                left, top = re.match(r"left:([-\d.]+)%;top:([-\d.]+)%", have["style"]).groups()
                found[int(have["data-run"])] = set(have["class"].split()), float(left), float(top), have["aria-label"]

    Reader().feed(drawing)
    return found


def test_every_run_is_a_button_where_its_error_and_time_are():
    """Every run with an error and a time alone is within the chart, cheap ones to the left, exact ones below; one that
    broke is at the top, one that failed nowhere; runs of a sweep are joined and named at the finest."""
    runs = numbered(*sweep("ugimp"), (fake_row("mpm", status="unstable"), SWEEP), (judged("bspline", 40), SEARCH),
                    (failed_row(task_of(SCENE), "lost <b>"), SWEEP))
    drawing = drawn(runs)
    found = buttons(drawing)
    assert sorted(found) == [1, 2, 3, 4, 5] and "<b>" not in drawing
    assert found[1][1] < found[2][1] < found[3][1] and found[1][2] < found[2][2] < found[3][2]
    assert all(0 < left < 100 and 0 <= top < 100 for _, left, top, _ in found.values())
    assert found[4][0] == {"lab-dot", "lab-broken"} and found[4][2] == 0 and "too long" in found[4][3]
    assert found[5][0] == {"lab-dot", "lab-judged"} and "estimated by companion" in found[5][3]
    assert drawing.count("class='lab-curve'") == 2 and "hollow: estimated by companion" in drawing
    assert [words for _,
            words in curve_names(runs)] == ["uGIMP"] and [run.method for run in best_without_curve(runs)] == ["bspline"]
    rows = [(fake_row("ugimp", cells, cfl), SWEEP) for cfl in (0.1, 0.5) for cells in (10, 20)]
    assert [words for _, words in curve_names(numbered(*rows))] == ["uGIMP, CFL 0.1", "uGIMP, CFL 0.5"]
    assert not buttons(drawn([])) and "time of one run" in drawn([])  # what will be there
    lost = fake_row(status="lost", reason="<img src=x onerror='alert(1)'>")
    stranger = drawn([visitor_run_list.NumberedRun(1, SWEEP, lost)])
    assert "<img" not in stranger and "onerror=&#x27;" in stranger


def test_times_of_a_stage_are_not_on_the_axis():
    """They are taken beside pictures and estimates: such a run stands in a band, is never the answer, and no axis
    reaches for it."""
    slow = fake_row("bspline", seconds={"full": 1e5})
    runs = numbered((slow, LIVE), *sweep("ugimp"))
    found = buttons(drawn(runs))
    assert found[1][0] == {"lab-dot", "lab-untimed"} and found[1][1] == 0 and "on the stage" in found[1][3]
    assert axes_for(runs, 1e-3).time_axis.high < 2 and "not timed alone" in drawn(runs)
    only = numbered((slow, LIVE))
    assert not pareto_front(only) and cheapest_run(only, 1e9) is None and "lab-band" in drawn(only)
    assert "lab-band" not in drawn(numbered(*sweep("ugimp")))


def test_runs_of_another_scene_are_faint_and_no_answer():
    """Another amplitude is another question; another method or remedy is not."""
    runs = numbered(*sweep("ugimp"))
    other = replace(SCENE, amplitude=0.01)
    assert len(comparable_runs(runs, replace(SCENE, method="cpgimp", cells=33, ppc=2, cfl=0.3))) == 3
    assert not comparable_runs(runs, other)
    faint = buttons(drawn(runs, other)).values()
    assert all("lab-aside" in kinds and "another scene" in words for kinds, _, _, words in faint)
    assert not any("lab-aside" in kinds for kinds, *_ in buttons(drawn(runs)).values())


def test_front_is_what_none_beats():
    """By whatever method, and by an estimate where no truth is known; the cheapest below a tolerance is on it."""
    runs = numbered(*sweep("ugimp", "mpm"), (judged(cells=30, size=0.049, seconds={"min": 1e-4}), SEARCH))
    best = pareto_front(runs)
    assert [run.seconds for run in best] == sorted(run.seconds for run in best)
    assert [run.error_or_estimate for run in best] == sorted((run.error_or_estimate for run in best), reverse=True)
    assert (
        cheapest_run(runs, 0.05).number == 7
        and cheapest_run(runs, 0.03).scene.cells == 40
        and cheapest_run(runs, 1e-9) is None
    )


def test_headline_is_the_answer_and_says_whose_word_it_is():
    runs = numbered(*sweep("ugimp"), (fake_row("mpm", 10, order=0.5), SWEEP), (fake_row("mpm", 20, order=0.1), SWEEP))
    best = cheapest_run(runs, 0.03)
    says, more = answer_headline(runs, SCENE, 0.03, "", 16)
    assert says == f"For <b>3{NBSP}% of A</b>, pay <strong>{format_seconds(best.seconds)}</strong>: uGIMP on 40 cells."
    assert (
        format_percent(best.error_or_estimate) in more
        and "MPM (hat functions) gets worse" in more
        and "estimate" not in more
    )
    so_far, still = answer_headline(runs, SCENE, 0.03, "", 16, provisional=True)
    assert so_far == f"Cheapest so far for <b>3{NBSP}% of A</b>: <strong>{format_seconds(best.seconds)}</strong>, " \
        "uGIMP on 40 cells." and still == more
    assert answer_headline(runs, SCENE, 1e-9, "", 16)[0].startswith("No run so far comes below")
    guessed = numbered((judged(size=0.02), SEARCH))
    assert "estimated by companion" in answer_headline(guessed, SCENE, 0.03, "", 16)[1]
    assert answer_headline(runs, SCENE, float("nan"), "give a <number>", 16)[1] == "give a &lt;number&gt;"
    assert answer_headline([], SCENE, 1e-3, "", 16)[0] == "Nothing measured yet."
    says, more = answer_headline(numbered((fake_row(), LIVE)), SCENE, 1e-3, "", 16)
    assert says == "Nothing timed yet." and "data-press='Small sweep'" in more and "of 16 runs" in more


def test_line_says_what_it_lights_up():
    runs = numbered(*sweep("ugimp"))
    mark = tolerance_line(runs, SCENE, 0.03, axes_for(runs, 0.03))
    assert f"data-best='3' data-price='{format_seconds(runs[2].seconds)}'" in mark
    assert f"data-spoken='3{NBSP}% of A: {format_seconds(runs[2].seconds)}, uGIMP on 40 cells'" in mark
    out_of_reach = tolerance_line(runs, SCENE, 1e-9, axes_for(runs, 1e-9))
    assert "data-best" not in out_of_reach and "no run so far" in out_of_reach
    nothing = "<i class='lab-cost-line'></i>"
    assert (
        tolerance_line(runs, SCENE, float("nan"), axes_for(runs, 0.03))
        == tolerance_line([], SCENE, 0.03, None)
        == nothing
    )


def test_axes_hold_everything_and_only_grow():
    runs = numbered(*sweep("ugimp"))
    first = axes_for(runs, 1e-3)
    assert axes_for(runs, 0.01, first) == first  # what is looked at stays where it is
    wider = axes_for(runs, 1e-4, first)
    assert wider.error_axis.low < first.error_axis.low and wider.error_axis.high == first.error_axis.high
    assert axes_for(runs, 1e-30, first).error_axis.low > -10  # a line is no reason to squeeze all runs together
    empty = axes_for([], 1e-5)
    assert empty.error_axis.low < -4 and empty.time_axis.low < empty.time_axis.high and empty.times is None
    assert axes_for(runs, 1e-3, empty).time_axis == first.time_axis and axes_for([], 0.01, first) == first


@pytest.mark.parametrize("values", [[1e-3], [1e-9, 1e3], [0.02, 0.021]])
def test_axis_holds_its_values_and_has_ticks(values):
    axis = axis_around(values)
    ticks = axis.ticks(str)
    assert all(0 < axis.position(value) < 1 for value in values) and axis_around([]) is None
    assert ticks and np.all(np.diff([tick.position for tick in ticks]) > 0) and not all(tick.minor for tick in ticks)
    assert LogAxis(0.0, 1.0).extend_to(values).position(values[0]) >= 0


def test_run_on_the_stage_is_marked():
    """Whatever else is computed beside it, and where it was timed alone, if so; the step may be said either way."""
    runs = numbered((fake_row("ugimp", 20, estimate=None, key="live"), LIVE), *sweep("ugimp"))
    assert run_of_scene(runs, replace(SCENE, cfl=0.05, estimators=(), effects=())) is runs[2]
    assert run_of_scene(runs[:1], SCENE) is runs[0] and "on the stage</span>" in drawn(runs[:1])
    assert (
        run_of_scene(runs, replace(SCENE, cells=40)) is runs[3] and run_of_scene(runs, replace(SCENE, cells=41)) is None
    )
    assert (
        run_of_scene(runs, replace(SCENE, cfl=0.1)) is None
        and run_of_scene(runs, replace(SCENE, amplitude=0.01)) is None
    )


def test_methods_have_the_colours_of_every_picture():
    """Light as in ``app.colour_palette``; on a dark ground with a contrast of 3 at least."""
    style = (WEB / "css/60-cost.css").read_text(encoding="utf-8")
    light, dark = (dict(re.findall(r"--m-(\w+): (#\w+);", block)) for block in re.findall(r"\{ (--m-[^}]+)\}", style))
    assert light == {name: colour for name, colour in METHOD_COLOURS.items() if name in light}
    assert set(light) == set(dark) == set(METHOD_COLOURS) - {"mpm"}
    assert all(contrast(colour, GROUNDS["ground"].dark) > 3 for colour in dark.values())
