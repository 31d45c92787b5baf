"""What a notebook shows below a cell: a player that carries its run, and the table of a result."""

from __future__ import annotations

import html
import re
from dataclasses import replace

import numpy as np
import pytest

from app import shareable_state
from app.export import slider_grid
from app.export.html_file import scene_page
from app.names_and_units import format_ratio, with_unit
from app.notebook import show
from app.notebook.result_display import result_table
from solvers import BarScene, RingScene, SceneError, run
from tests.support.processes import run_python

SMALL = BarScene(cells=10, ppc=2, periods=0.25, estimators=("companion",))


def frame_of(player) -> dict[str, str]:
    """The attributes of the frame that a notebook is given."""
    text = player._repr_html_()
    assert text.startswith("<iframe ") and text.endswith("></iframe>") and text.count("<") == 2, "one element, no more"
    return {name: html.unescape(value) for name, value in re.findall(r"([a-z]+)=\"([^\"]*)\"", text)}


@pytest.mark.parametrize(("beside", "error_of"), [
    (None, "x"), pytest.param(replace(SMALL, method="mpm"), "sigma", marks=pytest.mark.slow)])
def test_the_player_is_the_exported_page_of_the_run(beside, error_of):
    """The same bytes as the export's, whose numbers are tested: recorded by this process, with no runs around it."""
    player = show(SMALL, beside=beside, error_of=error_of)
    text = shareable_state.write_state(shareable_state.State(SMALL, quantity=error_of, pinned=beside))
    assert player.page == scene_page(text, 1, lambda part, doing: None, counts={})
    assert frame_of(player)["srcdoc"] == player.page


def test_a_player_is_framed_and_saved_as_it_is(tmp_path):
    """The frame may run scripts and nothing of the notebook; a result is shown by its scene."""
    player = show(SMALL, height=300)
    frame = frame_of(player)
    assert set(frame["sandbox"].split()) == {"allow-scripts", "allow-downloads"}
    assert "height: 300px" in frame["style"] and "10 cells" in frame["title"]
    player.save(tmp_path / "run.html")
    assert (tmp_path / "run.html").read_text(encoding="utf-8") == player.page == show(run(SMALL)).page
    assert len(repr(player)) < 300 and "10 cells" in repr(player)


def test_sliders_bring_runs_around_it(monkeypatch):
    around, told = slider_grid.axes_around, []
    monkeypatch.setattr(slider_grid, "axes_around", lambda scene, counts: around(scene, {"cells": 2}))
    player = show(SMALL, sliders=True, processes=1, on_progress=lambda part, doing: told.append(part))
    assert told[-1] == 1.0 and len(player.page) > len(show(SMALL).page)


@pytest.mark.parametrize(("arguments", "names"), [
    (dict(what=3), "show 3: is neither a scene"),
    (dict(what="bar cells=40"), "is neither a scene"),
    (dict(what=SMALL, beside=RingScene()), "beside ring: is another problem; give one of the bar"),
    (dict(what=SMALL, beside=5), "beside 5: is neither a scene"),
    (dict(what=SMALL, error_of="s"), "error of s: is not known"),
    (dict(what=SMALL, height=10), "give a whole number from 200 to 4,000"),
    (dict(what=SMALL, processes=0), "give a whole number from 1 to 64"),
    (dict(what=BarScene(cells=2000, ppc=8, periods=500)), "too long to record"),
    (dict(what=SMALL, beside=BarScene(cells=2000, ppc=8, periods=500)), "too long to record")])
def test_what_cannot_be_shown_is_said(arguments, names):
    with pytest.raises(SceneError, match=re.escape(names)):
        show(**arguments)


def cells(table: str) -> list[list[str]]:
    return [[html.unescape(cell) for cell in re.findall(r"<t[dh][^>]*>(.*?)</t[dh]>", row)]
            for row in re.findall(r"<tr>(.*?)</tr>", table)]


def test_the_table_has_the_numbers_of_the_result():
    result = run(replace(SMALL, estimators=("companion", "recovered")))
    head, *rows = cells(result_table(result))
    assert head == ["largest RMS error", "true", "by companion", "index", "distance",
                    "by recovered", "index", "distance"]
    for row, key, unit in zip(rows, ("x", "v", "sigma", "a"), ("m", "m/s", "Pa", "m/s²"), strict=True):
        wanted = [with_unit(result.error[key]["max"], unit)]
        for name in ("companion", "recovered"):
            wanted += [with_unit(result.estimate[name][key]["max"], unit), format_ratio(result.index[name][key]),
                       format_ratio(result.distance[name][key])]
        assert row[1:] == wanted
    assert f"ok after {result.steps:,} steps, at 250 ms" in result_table(result)
    assert result._repr_html_() == result_table(result)


@pytest.mark.parametrize(("scene", "says"), [
    (replace(SMALL, estimators=()), "<th"),
    (replace(SMALL, estimators=("two-grid",), remedies=("frozen-weights",)), "two-grid: not valid here"),
    (replace(SMALL, effects=("soundness",), estimators=()), "–"),
    (BarScene(motion="patch", cells=10, estimators=("companion",), periods=None, t_end=0.1), "no index of"),
    (BarScene(method="mpm", cells=10, amplitude=0.15, cfl=0.9, periods=3, estimators=()), "unstable")])
def test_the_table_of_any_run(scene, says):
    """None without numbers, none that is not escaped: what stands in it are words and numbers."""
    table = result_table(run(scene))
    assert says in table and "nan" not in table and "None" not in table
    assert len({len(row) for row in cells(table)}) == 1
    assert re.fullmatch(r"(?:[^<]|</?(?:div|p|b|table|thead|tbody|tr|th|td)(?: style=\"[^\"<>]*\")?>)*", table)


def test_the_picture_is_that_of_the_command_line():
    result = run(SMALL)
    figure = result.plot()
    assert len(figure.axes) > 3
    drawn = [line.get_ydata() for line in figure.axes[0].get_lines()]
    assert any(np.array_equal(line[1:], result.series["error_x"][1:]) for line in drawn)  # at the start there is none
    assert figure._repr_png_().startswith(b"\x89PNG")


def test_a_users_own_pictures_keep_their_looks():
    """In a process of its own: this one draws all the time."""
    done = run_python("-c", """
import matplotlib
before = dict(matplotlib.rcParams)
from app.notebook import show
from solvers import BarScene, run
run(BarScene(cells=10, periods=0.1)).plot()._repr_png_()
assert dict(matplotlib.rcParams) == before
""")
    assert (done.returncode, done.stderr) == (0, "")


def test_without_anything_that_draws(monkeypatch):
    """In a tree that was only copied nothing names what draws."""
    monkeypatch.setattr("solvers.running.result.entry_points", lambda **asked: ())
    result = run(SMALL)
    assert result._repr_html_() is None
    with pytest.raises(RuntimeError, match="nothing that is installed draws a result"):
        result.plot()
