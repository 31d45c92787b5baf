"""The chart of the Cost tab: what is drawn where, what can be compared, and the answer above it."""

import json
import re
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest

from app.colour_palette import GROUNDS, METHOD_COLOURS
from app.page.features.cost import visitor_run_list
from app.page.features.cost.cost_answer import answer_box, answer_headline, find_answer, tolerance_line
from app.page.features.cost.cost_chart import best_without_curve, curve_names, draw_runs
from app.page.features.cost.cost_texts import format_percent, format_seconds
from app.page.features.cost.log_axes import LogAxis, axes_for, axis_around
from app.page.features.cost.visitor_run_list import (
    LIVE,
    SEARCH,
    SHIPPED,
    SWEEP,
    VisitorRunList,
    cheapest_run,
    comparable_runs,
    measured_runs,
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
    return draw_runs(runs, comparable_runs(runs, scene), scene, "x", axes_for(runs, tolerance))


def sweep(*methods, source=SWEEP):
    return [(fake_row(method, cells), source) for method in methods for cells in (10, 20, 40)]


def headline(runs, tolerance=1e-3, scene=SCENE, follows=False, trouble="", **options):
    like = comparable_runs(runs, scene)
    return answer_headline(find_answer(like, scene, tolerance, follows), runs, like, scene, trouble, **options)


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
    runs = numbered(*sweep("ugimp"), (fake_row("mpm", status="unstable"), SWEEP), (judged("bspline", 42), SEARCH),
                    (failed_row(task_of(SCENE), "lost <b>"), SWEEP))
    drawing = drawn(runs)
    found = buttons(drawing)
    assert sorted(found) == [1, 2, 3, 4, 5] and "<b>" not in drawing
    assert found[1][1] < found[2][1] < found[3][1] and found[1][2] < found[2][2] < found[3][2]
    assert all(0 < left < 100 and 0 <= top < 100 for _, left, top, _ in found.values())
    assert found[4][0] == {"lab-dot", "lab-broken"} and found[4][2] == 0 and "too long" in found[4][3]
    assert found[5][0] == {"lab-dot", "lab-judged", "lab-small"} and "estimated by companion" in found[5][3]
    assert drawing.count("class='lab-curve'") == 2
    assert [words for _,
            words in curve_names(runs)] == ["uGIMP"] and [run.method for run in best_without_curve(runs)] == ["bspline"]
    rows = [(fake_row("ugimp", cells, cfl), SWEEP) for cfl in (0.1, 0.5) for cells in (10, 20)]
    assert [words for _, words in curve_names(numbered(*rows))] == ["uGIMP, CFL 0.1", "uGIMP, CFL 0.5"]
    assert not buttons(drawn([])) and "Time of one run" in drawn([])  # what will be there
    lost = fake_row(status="lost", reason="<img src=x onerror='alert(1)'>")
    stranger = drawn([visitor_run_list.NumberedRun(1, SWEEP, lost)])
    assert "<img" not in stranger and "onerror=&#x27;" in stranger


def test_times_of_a_stage_are_not_on_the_axis():
    """They are taken beside pictures and estimates: the own run then stands in a band, others nowhere; none is the
    answer, and no axis reaches for it."""
    slow = fake_row("bspline", seconds={"full": 1e5})
    runs = numbered((slow, LIVE), *sweep("ugimp"))
    assert sorted(buttons(drawn(runs))) == [2, 3, 4] and "lab-band" not in drawn(runs)
    own = replace(SCENE, method="bspline")
    found = buttons(drawn(runs, own))
    assert found[1][0] == {"lab-dot", "lab-untimed", "lab-own"} and found[1][1] == 0 and "on the stage" in found[1][3]
    assert axes_for(runs, 1e-3).time_axis.high < 2 and "not timed alone" in drawn(runs, own)
    only = numbered((slow, LIVE))
    assert not pareto_front(only) and cheapest_run(only, 1e9) is None and "lab-band" in drawn(only, own)


def test_runs_measured_here_replace_shipped_ones_mark_by_mark():
    """Times of two machines are not compared: those that are yet to be measured are hollow, and no answer."""
    runs = numbered(*sweep("ugimp", source=SHIPPED), *sweep("ugimp")[:2])
    assert [run.source for run in runs] == [SWEEP, SWEEP, SHIPPED]
    found = buttons(drawn(runs))
    assert [number for number, (kinds, *_) in found.items() if "lab-elsewhere" in kinds] == [3]
    assert "on the authors' machine" in found[3][3] and drawn(runs).count("class='lab-curve'") == 2
    assert measured_runs(runs) == runs[:2] and cheapest_run(runs, 0.03) is None
    before = numbered(*sweep("ugimp", source=SHIPPED))
    assert cheapest_run(before, 0.03) is before[2] and not any(
        "lab-elsewhere" in kinds for kinds, *_ in buttons(drawn(before)).values())


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
    says, more = headline(runs, 0.03)
    paid = f"<strong>{format_seconds(best.seconds)}</strong>"
    assert says == f"For an error of <b>3{NBSP}%</b>, pay {paid}: uGIMP on 40 cells."
    assert format_percent(best.error_or_estimate) in more and "MPM (hat functions) gets worse" in more
    assert "estimate" not in more
    so_far, still = headline(runs, 0.03, provisional=True)
    assert so_far == f"Cheapest so far for <b>3{NBSP}%</b>: {paid}, uGIMP on 40 cells." and still == more
    assert headline(runs, 1e-9)[0].startswith("No run so far comes below")
    assert "estimated by companion" in headline(numbered((judged(size=0.02), SEARCH)), 0.03)[1]
    assert headline(runs, float("nan"), trouble="give a <number>")[1] == "give a &lt;number&gt;"
    assert headline([]) == ("Nothing measured for your run yet.", "No run of this motion has been timed yet.<br>"
                            "<button data-press='Measure here'>Measure here</button>")
    says, more = headline(numbered((fake_row(), LIVE)))
    assert says.startswith("Your run is <b>") and "data-press='Measure here'" in more


def test_a_run_is_set_beside_one_as_accurate_and_one_as_fast():
    """The first has at most its error in the least time, the second the least error in at most 8 % more time."""
    scene = replace(SCENE, method="mpm")
    rows = [("mpm", 20, 1.0, 1e-2), ("ugimp", 10, 1.4, 4e-3), ("ugimp", 20, 1.4, 1.05e-2), ("bspline", 20, 1.7, 1.2e-2),
            ("bspline", 10, 0.5, 1e-3)]
    runs = numbered(*((fake_row(method, cells, order=order, seconds={"min": seconds}), SHIPPED)
                      for method, cells, order, seconds in rows))
    answer = find_answer(runs, scene, 0.5, follows=True)
    assert answer.own is runs[0] and answer.cheaper is runs[1] and answer.more_accurate is runs[2]
    assert answer.tolerance == runs[0].error and answer.is_own
    box = answer_box(answer)
    assert "uGIMP on 10 cells: 4 ms instead of 10 ms" in box.replace(NBSP, " ") and "data-run='2'" in box
    assert "<b>As fast as your run, more accurate:</b><p>uGIMP on 20 cells" in box and "data-run='3'" in box
    says = headline(runs, 0.5, scene, True)[0]
    assert says.endswith(f"As accurate in <strong>4{NBSP}ms</strong>: <b>uGIMP on 10 cells</b>.")
    best = find_answer(runs[1:2], replace(scene, method="ugimp", cells=10), 0.5, follows=True)
    assert best.cheaper is best.more_accurate is None and answer_box(best) == ""
    moved = find_answer(runs, scene, 1.6, follows=False)
    assert moved.cheaper is runs[1] and not moved.is_own and answer_box(moved) == ""
    untimed = numbered((fake_row("mpm", order=1.0), LIVE), *((run.row, SHIPPED) for run in runs[1:]))
    found = find_answer(untimed, scene, 0.5, follows=True)
    assert found.cheaper is not None and found.more_accurate is None
    assert "has not been measured alone" in headline(untimed, 0.5, scene, True)[1]


def test_other_motions_are_said_to_be_others():
    says, more = headline(numbered(*sweep("ugimp", source=SHIPPED)), scene=replace(SCENE, amplitude=0.01))
    assert says == "Nothing measured for your run yet." and "Measure here" in more
    assert "of another motion: A = 25 mm, E 4 Pa, until 5 s. Yours: A = 10 mm, E 4 Pa, until 5 s." in more


def test_line_says_what_it_lights_up():
    runs = numbered(*sweep("ugimp"))
    mark = tolerance_line(find_answer(runs, SCENE, 0.03, False), axes_for(runs, 0.03))
    assert f"data-marks='[[&quot;3&quot;, &quot;{format_seconds(runs[2].seconds)}&quot;]]'".encode() in mark.replace(
        "\\u00a0", NBSP).encode() and f"data-text='3{NBSP}% wanted'" in mark
    assert f"data-spoken='3{NBSP}%: {format_seconds(runs[2].seconds)}, uGIMP on 40 cells'" in mark
    out_of_reach = tolerance_line(find_answer(runs, SCENE, 1e-9, False), axes_for(runs, 1e-9))
    assert "data-marks='[]'" in out_of_reach and "no run so far" in out_of_reach
    own = tolerance_line(find_answer(runs, SCENE, 1.0, True), axes_for(runs, 1.0))
    assert "as accurate as your run" in own
    nothing = "<i class='lab-cost-line'></i>"
    assert tolerance_line(find_answer(runs, SCENE, float("nan"), False), axes_for(runs, 0.03)) == nothing
    assert tolerance_line(find_answer([], SCENE, 0.03, False), None) == nothing


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
    runs = numbered(*sweep("ugimp"))
    assert run_of_scene(runs, replace(SCENE, cfl=0.05, estimators=(), effects=())) is runs[1]
    assert "your run: uGIMP, 20 cells</span>" in drawn(runs) and "lab-own" in buttons(drawn(runs))[2][0]
    assert run_of_scene(runs, replace(SCENE, cells=40)) is runs[2]
    for other in ({"cells": 41}, {"cfl": 0.1}, {"amplitude": 0.01}):
        assert run_of_scene(runs, replace(SCENE, **other)) is None


def test_methods_have_the_colours_of_every_picture():
    """Light as in ``app.colour_palette``; on a dark ground with a contrast of 3 at least."""
    style = (WEB / "css/60-cost.css").read_text(encoding="utf-8")
    light, dark = (dict(re.findall(r"--m-(\w+): (#\w+);", block)) for block in re.findall(r"\{ (--m-[^}]+)\}", style))
    assert light == {name: colour for name, colour in METHOD_COLOURS.items() if name in light}
    assert set(light) == set(dark) == set(METHOD_COLOURS) - {"mpm"}
    assert all(contrast(colour, GROUNDS["ground"].dark) > 3 for colour in dark.values())


def test_a_corrected_result_is_a_hollow_mark_that_answers_and_loads_its_run():
    """It stands beside its run, whose time is less, on a dashed line; the companion's is none."""
    left = {"x": {"max": 1e-6 * SCENE.amplitude}}
    rows = [fake_row("ugimp", cells, corrected={"recovered": left, "companion": left}, seconds={
        "min": 1e-4 * cells, "estimators": {"recovered": 1e-5, "companion": 1e-5}}) for cells in (10, 20)]
    visitors = VisitorRunList()
    for row in rows:
        visitors.add(row, SWEEP)
    runs = visitors.with_corrected()
    assert [run.mark for run in runs] == ["1", "2", "1 recovered", "2 recovered"]
    assert run_of_scene(runs, SCENE) is runs[1]
    best = cheapest_run(runs, 1e-5)
    assert best.mark == "1 recovered" and best.seconds == pytest.approx(1.01e-3)
    html = drawn(runs)
    assert re.search("lab-corrected' data-run='1 recovered'", html) and "uGIMP, corrected by recovered" in html
    answer = find_answer(runs, SCENE, 1e-5, False)
    assert "uGIMP on 10 cells, corrected by recovered" in answer_headline(answer, runs, runs, SCENE, "")[0]
    assert json.loads(re.search("data-marks='(.*?)'", tolerance_line(answer, axes_for(runs, 1e-5)).replace(
        "&quot;", '"'))[1])[0][0] == "1 recovered"
