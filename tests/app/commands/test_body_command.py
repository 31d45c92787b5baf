"""``mpm-lab run FILE.toml`` and ``mpm-lab body``."""

import json
from pathlib import Path

import pytest

from app.cli import main
from app.commands.body import value_and_bar
from solvers.bodies.body_file import library_names, library_text

KEYS = {"schema", "body", "status", "reason", "t", "steps", "particles", "estimated_until", "estimate", "goals",
        "warnings", "remarks", "companion", "recovered", "seconds"}


@pytest.fixture
def sector(tmp_path):
    path = tmp_path / "sector.toml"
    path.write_text(library_text("swinging_sector").replace("cells_per_metre = 16", "cells_per_metre = 8"))
    return str(path)


def test_a_run_as_json(sector, capsys):
    assert main(["run", sector, "--json", "-"]) == 0
    values = json.loads(capsys.readouterr().out)
    assert set(values) == KEYS and values["schema"] == "mpm-lab/body/1" and values["status"] == "ok"
    assert set(values["estimate"]) == {"x", "v", "sigma"}
    assert set(values["estimate"]["x"]) == {"final", "max", "mean", "delta", "trust", "unit"}
    assert values["goals"]["end"]["bar"] < 0.01 and values["goals"]["end"]["unit"] == "m"
    assert values["body"]["patches"][0]["arc"] == {"west": [0, 0], "east": [0, 0]}


def test_a_run_as_a_table(sector, capsys):
    assert main(["run", sector]) == 0
    out = capsys.readouterr().out
    for words in ("sector.toml: cpdi, 8 cells per metre", "ok:", "x (m)", "delta", "end ", " +- ", "orders 4 and 6 on"):
        assert words in out


def test_a_picture_of_the_goals(sector, tmp_path, capsys):
    """And a file that --json is to write, too, is refused before the run."""
    plot = tmp_path / "goals.png"
    assert main(["run", sector, "--plot", str(plot)]) == 0
    assert plot.read_bytes().startswith(b"\x89PNG") and plot.stat().st_size > 20_000
    assert main(["run", sector, "--plot", str(plot), "--json", str(plot)]) == 2
    assert "is the file of --json too" in capsys.readouterr().err


def test_a_second_estimate(sector, tmp_path, capsys):
    """Of a rectangle; the sector is none."""
    beam = tmp_path / "beam.toml"
    beam.write_text(library_text("cantilever").replace("cells_per_metre = 8", "cells_per_metre = 4")
                    .replace("t_end = 1.8", "t_end = 0.05"))
    assert main(["run", str(beam), "--estimator", "recovered"]) == 0
    assert "recovered, sigma (Pa)" in capsys.readouterr().out
    assert main(["run", sector, "--estimator", "recovered"]) == 2
    assert "--estimator recovered: needs a body of one rectangle" in capsys.readouterr().err


def test_bodies_that_come_along_are_listed_and_shown(capsys):
    assert main(["body", "list"]) == 0
    assert [line.split()[0] for line in capsys.readouterr().out.splitlines()] == library_names()
    assert main(["body", "show", "cantilever"]) == 0
    assert capsys.readouterr().out == library_text("cantilever")
    assert main(["body", "show", "cantilevr"]) == 2
    assert "did you mean cantilever?" in capsys.readouterr().err


@pytest.mark.parametrize(("old", "new", "words"), [
    ("density = 1000", "density = 0", "sector.toml: density 0: give a number above 1e-15"),
    ("density = 1000", "density = [", "sector.toml: is no TOML"),
    ('gravity = [0, -3]', 'force = ["sin(900*t)", "0"]', "changes too fast with t")])
def test_bad_files(sector, capsys, old, new, words):
    text = Path(sector).read_text()
    Path(sector).write_text(text.replace(old, new))
    assert main(["run", sector]) == 2
    said = capsys.readouterr().err
    assert words in said and len(said.splitlines()) == 1
    assert main(["run", "none.toml"]) == 2 and "none.toml: cannot be read" in capsys.readouterr().err


def test_hat_functions_are_warned_of_and_a_broken_run_has_its_status(sector, capsys):
    text = Path(sector).read_text()
    Path(sector).write_text(text.replace('"cpdi"', '"mpm"'))
    assert main(["run", sector, "--quiet"]) == 3
    assert "a particle has turned inside out" in capsys.readouterr().err
    assert main(["run", sector]) == 3
    assert "warning: hat functions break numerically" in capsys.readouterr().err


@pytest.mark.parametrize("value, bar, said", [
    (-1.315018, 0.00198, "-1.3150 +- 0.0020"), (464824.0, 6980.0, "464,800 +- 7,000"),
    (2.0, 0.0, "2.000000 +- 0.000000")])
def test_a_value_has_the_digits_of_its_bar(value, bar, said):
    assert value_and_bar(value, bar) == said


def test_other_commands_say_which_take_bodies(capsys):
    assert main(["advise", "sector.toml"]) == 2
    assert ("sector.toml: is a body, which only mpm-lab run FILE.toml and mpm-lab sweep FILE.toml take"
            in capsys.readouterr().err)
