"""``mpm-lab budget bar --map``: the picture of where and when, what JSON says of it, and what is refused."""

import json

import pytest

from app.cli import main
from app.pictures.budget_map import ROWS, budget_map_figure
from solvers.problems import PROBLEMS
from solvers.problems.bar.scene import BarScene
from solvers.scene.causes import CAUSES

HATS = ("budget", "bar", "--method", "mpm", "--cells", "12", "--periods", "0.25", "--quiet")


@pytest.mark.parametrize("asked", [(), ("--particle", "5", "--field", "F"), ("--take-away", "crossings")], ids=str)
def test_a_map_is_drawn_and_said(asked, capfd, tmp_path):
    """One of the run that keeps its causes, also beside one that does not."""
    file = tmp_path / "map.png"
    assert main([*HATS, *asked, "--map", str(file), "--json", "-"]) == 0
    assert file.read_bytes().startswith(b"\x89PNG")
    said = json.loads(capfd.readouterr().out)["map"]
    assert said["field"] == ("F" if "F" in asked else "x") and said["particle"] == (5 if "5" in asked else None)
    assert sum(said["shares"].values()) == pytest.approx(1, abs=1e-9) and list(said["shares"]) == list(CAUSES)
    assert said["shown"] == "crossings" and 1 <= said["cancelled"] <= 5 and said["not_valid"] is None


def test_what_cancels_is_said_and_not_drawn(capfd, tmp_path):
    file = tmp_path / "map.png"
    assert main(["budget", "bar", "--periods", "1", "--quiet", "--map", str(file)]) == 1
    out, told = capfd.readouterr()
    assert "crossings" in out  # the budget itself is told
    assert told.count("\n") == 1 and "cancels" in told and not file.exists()


@pytest.mark.parametrize(("arguments", "said"), [
    (("--particle", "3"), "give --map FILE too"), (("--field", "v"), "give --map FILE too"),
    (("--map", "map.pdf"), "ends in .png"), (("--map", "{}", "--particle", "48"), "from 0 to 47"),
    (("--map", "{}", "--particle", "1.5"), "from 0 to 47"), (("--map", "{}", "--field", "a"), "x, v, F"),
    (("--map", "{}", "--remedies", "zero-drift"), "not through zero-drift"),
    (("--map", "{}", "--plot", "{}"), "is the file of another flag")])
def test_what_has_no_map_is_refused_before_it_runs(arguments, said, capfd, tmp_path):
    file = str(tmp_path / "map.png")
    assert main([*HATS, *(word.format(file) for word in arguments)]) == 2
    told = capfd.readouterr().err
    assert said in told and told.count("\n") == 1


def test_the_picture_has_time_upwards_and_the_material_to_the_right():
    """The map's pixels are the binned shares, its dots the crossings, and the margins end at the shares."""
    scene = BarScene(method="mpm", cells=12, periods=0.25, estimators=(), effects=("truth",))
    found = PROBLEMS["bar"].error_map(scene)
    figure = budget_map_figure(found)
    places, time, cells, _ = (axes for axes in figure.axes if axes.get_label() != "<colorbar>")
    image = places.images[0]
    assert image.get_array().shape == (ROWS, 12) and image.origin == "lower"
    assert image.get_array().sum() == pytest.approx(100 * found.share("crossings"), rel=1e-6)
    assert tuple(image.get_extent()) == (0, 1, 0, pytest.approx(scene.end_time))
    assert len(places.lines[0].get_xdata()) == len(found.crossings) > 0
    assert time.lines[0].get_xdata()[-1] == pytest.approx(100 * found.share("crossings"), rel=1e-6)
    bars = [bar.get_height() for bar in cells.patches]
    assert sum(bars) == pytest.approx(100, abs=0.5)  # but for causes too small to be seen
