"""``mpm-lab tables``: the paper's numbers beside ours, rows that survive a kill, and what is written of them."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from concurrent.futures import Future

import pytest

from app.cli import main
from app.commands.study import tables as command
from app.commands.study.tables_text import markdown
from app.pictures.tables import figure
from app.words import QUANTITIES
from solvers.problems import PROBLEMS
from solvers.scene.registry import ESTIMATORS
from solvers.study.tables import making, paper, plan, rows
from solvers.study.tables.document import document
from solvers.study.tables.making import Making
from solvers.study.tables.paper import digits, short
from tests.paths import ROOT
from tests.processes import HANG

ONE = {"bar": ("transport",), "ring": ("transport",)}
#: Cut-down tables: the coarsest rows, the bar for a hundredth of the time.
MADE = """{"1": plan.table_1({"bar": ("transport",)}, cells=(20,), end=0.01, long=0.02),
           "2": plan.table_2({"ring": ("transport",)}, cells=(12,), methods=("cpdi",)),
           "3": plan.table_3({"ring": ("transport",)}, cells=(12,), methods=("cpdi",))}"""
CUT = eval(MADE)
ROWS = [row for number in ("1", "2") for row in CUT[number].rows]  # Table 3 has the rows of Table 2


@pytest.fixture(autouse=True)
def cut_down(monkeypatch):
    monkeypatch.setattr(plan, "make", lambda number, estimators: CUT[number])


@pytest.fixture(scope="module")
def results() -> dict:
    """The runs of every row, once for all tests."""
    return made_of(ROWS, {}, 1)


def made_of(wanted: list, begun: dict, processes: int) -> dict:
    """Rows as they are made."""
    found = {}
    Making(wanted, begun, processes, lambda part, name: None, lambda row, runs: found.update({row.name: runs})).make()
    return found


class Remembered:
    """In the place of :class:`Making`: rows come from ``results`` instead of being run. ``asked`` are their names."""

    results: dict
    asked: list[str]

    def __init__(self, rows, begun, processes, show, keep):
        self._rows, self._keep = rows, keep

    def make(self):
        for row in self._rows:
            self.asked.append(row.name)
            self.before(row)
            self._keep(row, self.results[row.name])

    def before(self, row):
        """What else happens first."""


@pytest.fixture
def remembered(results, monkeypatch) -> type[Remembered]:
    made = type("Made", (Remembered,), {"results": dict(results), "asked": []})
    monkeypatch.setattr(command, "Making", made)
    return made


@pytest.fixture
def counted(remembered) -> list[str]:
    """The names of the rows that were asked for."""
    return remembered.asked


@pytest.fixture
def unwritten(monkeypatch) -> None:
    """Only rows are written: drawing takes its time."""
    monkeypatch.setattr(command, "_write", lambda *_: None)


@pytest.fixture
def made(results) -> dict[str, dict]:
    """The three tables' objects, as they read in their files."""
    return {number: json.loads(json.dumps(document(table, results), allow_nan=False)) for number, table in CUT.items()}


# ---- what is in a table ---------------------------------------------------------------------------------------


def test_the_papers_numbers_are_those_of_the_bars_reference():
    reference = json.loads((ROOT / "assets/reference/bar.json").read_text())["table1"]
    for case in ("small", "large"):
        for cells, row in reference[case]["rows"].items():
            printed = paper.bar(reference[case]["modulus"], int(cells))
            assert {key: printed[key] for key in row["paper"]} == row["paper"]
            assert {q: printed[f"index_{q}"] for q in row["paper_index"]} == row["paper_index"]
    assert paper.ring_errors("cpdi", 96) == {"x": 8.9e-6, "v": 1.4e-2, "a_nodes": 7.6e1}
    assert paper.ring_index("ugimp", 12) == {"index_x": 0.69}
    assert paper.bar(4.0, 21) == paper.ring_errors("cpdi", 13) == paper.ring_index("mpm", 12) == {}


def test_whole_tables_have_the_papers_rows_twice(monkeypatch):
    monkeypatch.undo()
    first, second, third = (plan.make(number, {name: PROBLEMS[name].estimators for name in ("bar", "ring")})
                            for number in plan.NUMBERS)
    assert (len(first.rows), len(second.rows), len(third.rows)) == (16, 24, 24)
    assert all(row.paper for table in (first, second, third) for row in table.rows)
    assert {row.name: row.scenes for row in second.rows} == {row.name: row.scenes for row in third.rows}
    for row in (*first.rows, *second.rows):
        scene = row.scenes["errors"]
        assert scene.sample_interval == scene.estimate_interval
        assert scene.estimators == PROBLEMS[scene.problem].estimators
        assert row.scenes["cost"].sample_every is None
    assert {(row.scenes["errors"].end_time, row.scenes["crossings"].end_time) for row in first.rows} == {(1.0, 10.0)}


def test_the_object_has_its_schema(made):
    for number, table in made.items():
        assert (table["schema"], table["table"]) == ("mpm-lab/tables/1", number)
        assert set(table) == {"schema", "table", "title", "caption", "setup", "estimators", "rows", "seconds"}
        assert table["estimators"] == ["transport"] and all(isinstance(line, str) for line in table["setup"])
        for row in table["rows"]:
            assert set(row) == {"name", "part", "inputs", "particles", "h", "unstable", "paper", "ours", "ratio",
                                "estimators"}
            assert set(row["paper"]) == set(row["ours"]) == set(row["ratio"])
            said = row["estimators"]["transport"]
            assert set(said) == {"index", "distance", "cost", "not_valid"} and 0 <= said["cost"] < 1
            assert set(said["index"]) == set(said["distance"]) == {"x", "v", "sigma", "a"}


def test_numbers_and_ratios_are_those_of_the_runs(made, results):
    for table in made.values():
        for row in table["rows"]:
            for key, ratio in row["ratio"].items():
                if row["paper"][key] is None:
                    assert ratio is None
                else:
                    assert ratio == pytest.approx(row["ours"][key] / row["paper"][key])
    bar, ring, index = (made[number]["rows"][0] for number in "123")
    run = results["bar-small-node-20"]["errors"]
    assert bar["ours"]["x"] == run["error"]["x"]["max"] and bar["ours"]["index_v"] == run["index"]["v"]
    assert bar["ours"]["sigma_log"] == run["error"]["sigma_log"]["max"] and bar["paper"]["x"] == 3.6e-6
    assert ring["ours"]["a_nodes"] == results["ring-ours-cpdi-12"]["errors"]["error"]["a_nodes"]["final"]
    assert (ring["paper"]["a_nodes"], index["paper"]["index_x"]) == (250, 10)
    assert index["ours"]["index_x"] == results["ring-ours-cpdi-12"]["errors"]["index"]["x"]
    assert bar["inputs"]["t_end_crossings"] == pytest.approx(0.02)
    large = results["bar-large-node-20"]
    assert large["crossings"]["grid_crossings"] > large["errors"]["grid_crossings"] > 0
    assert large["crossings"]["effects"] == ["crossings", "body_force", "linearity_preserving"]


def test_the_ring_matches_the_reference(made):
    reference = json.loads((ROOT / "assets/reference/ring.json").read_text())
    assert made["2"]["rows"][0]["ours"]["x"] == pytest.approx(reference["cpdi"]["x"][0], rel=0.02)
    assert made["3"]["rows"][0]["ours"]["index_x"] == pytest.approx(reference["transport_index_x"]["cpdi"][0], rel=0.1)


def test_several_estimators_are_told_apart(results):
    row = CUT["3"].rows[0]
    runs = {name: dict(result) for name, result in results[row.name].items()}
    for run in runs.values():
        run["scene"] = {**run["scene"], "estimator": ["transport", "recovered"]}
        run["not_valid"] = {"recovered": "not valid here: a wall"}
        run["index"], run["distance"] = ({"transport": run[kind], "recovered": None} for kind in ("index", "distance"))
    table = document(plan.Table("3", "t", "c", (), (row,)), {row.name: runs})
    said = table["rows"][0]["estimators"]
    assert said["transport"]["index"]["x"] == results[row.name]["errors"]["index"]["x"]
    assert said["recovered"] == {"index": dict.fromkeys(said["transport"]["index"]), "cost": None,
                                 "distance": dict.fromkeys(said["transport"]["index"]),
                                 "not_valid": "not valid here: a wall"}
    text = markdown(table)
    assert "| –[^1] |" in text and "| recovered[^1] | – |" in text
    assert text.count("[^1]: recovered: not valid here: a wall") == 1
    assert any("no index: recovered" in words.get_text() for axes in figure(table).subfigs[0].axes
               for words in axes.texts)


def test_pictures_have_a_colour_an_estimator_and_no_dead_panel(results):
    """A quantity without any index has no row of panels, and a part without one has words and no axes."""
    row = CUT["3"].rows[0]
    runs = {name: {**result, "scene": {**result["scene"], "estimator": ["transport", "companion"]}, "not_valid": {},
                   "index": {"transport": result["index"], "companion": {**result["index"], "sigma": None}},
                   "distance": dict.fromkeys(("transport", "companion"), result["distance"])}
            for name, result in results[row.name].items()}
    table = document(plan.Table("3", "t", "c", (), (row,)), {row.name: runs})
    assert table["rows"][0]["estimators"]["transport"]["index"]["sigma"] is None
    panels = figure(table).subfigs[0].axes
    assert [panel.get_ylabel() for panel in panels] == [f"index of {QUANTITIES[q]}" for q in ("x", "v", "a")]
    colours = {line.get_label(): line.get_color() for line in panels[0].get_lines()}
    assert {name: colours[name] for name in runs["errors"]["index"]} == {
        name: ESTIMATORS[name].colour for name in runs["errors"]["index"]}
    stressed = {**table["rows"][0], "inputs": {**table["rows"][0]["inputs"], "method": "ugimp"}, "estimators": {
        "companion": {"index": dict.fromkeys(QUANTITIES, 1.0)}}}
    panels = figure({**table, "rows": [*table["rows"], stressed]}).subfigs[0].axes
    dead = [panel for panel in panels if not panel.axison]
    assert [text.get_text() for panel in dead for text in panel.texts] == ["no index of σ here"]


# ---- Markdown and pictures ------------------------------------------------------------------------------------


def test_markdown_has_the_setup_the_papers_numbers_ours_and_the_ratio(made):
    for number, table in made.items():
        text = markdown(table)
        assert text.startswith(f"# Table {number}. ") and all(line in text for line in table["setup"])
        rows = [line for line in text.splitlines() if line.startswith("|")]
        assert {line.count("|") for line in rows if "cells" in line} <= {line.count("|") for line in rows}
        assert all(f"## {row['part']}" in text for row in table["rows"])
    ours = digits(made["1"]["rows"][0]["ours"]["x"], 3)
    assert f"| 20 | {ours} | 3.6e-6 |" in markdown(made["1"])
    assert "| 17,000 |" in markdown(made["1"]) and "| 20 | the paper's, printed | 0.89 | 0.14 | 1.6 |" \
        in markdown(made["1"])
    assert f"| CPDI | 12 | {digits(made['2']['rows'][0]['ours']['x'], 3)} | 4.1e-4 |" in markdown(made["2"])
    assert "| 250 |" in markdown(made["2"]) and "| 10 |" in markdown(made["3"])


@pytest.mark.parametrize(("value", "count", "text"), [
    (3.49e-6, 3, "3.49e-6"), (0.05806, 3, "0.0581"), (0.2, 2, "0.20"), (9.162, 3, "9.16"), (448.2, 3, "448"),
    (9999.0, 2, "1.0e4"), (0.0999, 2, "0.10"), (3.5e5, 2, "3.5e5"), (700.0, 2, "700")])
def test_digits(value, count, text):
    assert digits(value, count) == text


def test_short():
    assert [short(v) for v in (2.5e-4, 0.025, 1e7, 4.0, 1000.0)] == ["2.5e-4", "0.025", "1e7", "4", "1000"]


def test_pictures_show_ours_and_the_papers(made):
    for table in made.values():
        drawn = [line for part in figure(table).subfigs for axes in part.axes for line in axes.get_lines()]
        labels = {line.get_label() for line in drawn}
        assert "the paper's, printed" in labels
        for row in table["rows"]:
            values = [value for line in drawn for value in line.get_ydata()]
            shown = {"1": ("x", "v", "sigma_log", "index_x"), "2": ("x", "v", "a_nodes"), "3": ("index_x",)}
            for key in shown[table["table"]]:
                assert row["ours"][key] in values and row["paper"][key] in values


# ---- the command ----------------------------------------------------------------------------------------------


def test_all_writes_nine_files_and_keeps_every_row(tmp_path, counted, capsys):
    assert main(["tables", "all", "--out", str(tmp_path / "new" / "dir")]) == 0
    folder = tmp_path / "new" / "dir"
    assert {path.name for path in folder.iterdir()} == {"rows", *(f"table{n}.{kind}" for n in "123"
                                                                  for kind in ("md", "json", "png"))}
    for number in "123":
        table = json.loads((folder / f"table{number}.json").read_text())
        assert (folder / f"table{number}.md").read_text() == markdown(table)
        assert (folder / f"table{number}.png").read_bytes().startswith(b"\x89PNG\r\n\x1a\n")
    assert sorted(counted) == sorted(path.stem for path in (folder / "rows").iterdir())
    assert len(counted) == len(set(counted)) == len(ROWS)  # Tables 2 and 3 share theirs
    assert capsys.readouterr() == ("", "")


def test_a_finished_table_is_not_run_again(tmp_path, counted, capsys):
    assert main(["tables", "3", "--out", str(tmp_path)]) == 0
    first = (tmp_path / "table3.md").read_text()
    assert main(["tables", "2", "--out", str(tmp_path)]) == main(["tables", "3", "--out", str(tmp_path)]) == 0
    assert len(counted) == 2 and (tmp_path / "table3.md").read_text() == first
    assert capsys.readouterr().err.splitlines() == ["mpm-lab: 2 of 2 rows are there already"] * 2


@pytest.mark.parametrize("spoil", [
    lambda path: path.write_text("not json"), lambda path: path.write_text(path.read_text()[:-100]),
    lambda path: path.write_bytes(b"\xff\xfe\x00"), lambda path: path.write_text("[]"),
    lambda path: path.write_text("{}"),
    lambda path: path.write_text(path.read_text().replace('"cells": 12', '"cells": 13')),
    lambda path: path.write_text(path.read_text().replace('"cost"', '"price"')), lambda path: path.unlink()])
def test_a_row_that_is_not_whole_is_made_again(spoil, tmp_path, counted, unwritten):
    assert main(["tables", "2", "--out", str(tmp_path), "--quiet"]) == 0
    spoil(tmp_path / "rows" / "ring-ours-cpdi-12.json")
    assert main(["tables", "2", "--out", str(tmp_path), "--quiet"]) == 0
    assert [name for name in counted if counted.count(name) > 1] == ["ring-ours-cpdi-12"] * 2


def test_a_changed_setup_or_solver_is_not_a_finished_row(tmp_path, counted, unwritten, monkeypatch):
    assert main(["tables", "2", "--out", str(tmp_path), "--quiet"]) == 0
    monkeypatch.setitem(CUT, "2", plan.table_2(ONE, cells=(12,), methods=("cpdi",), end=0.01))
    assert main(["tables", "2", "--out", str(tmp_path), "--quiet"]) == 0
    assert len(counted) == 4
    monkeypatch.setattr(rows, "fingerprint", lambda: "another")
    assert main(["tables", "2", "--out", str(tmp_path), "--quiet"]) == 0
    assert len(counted) == 6


def untimed(runs: dict) -> dict:
    """A row's runs without what is measured on a clock."""
    return {name: {key: value for key, value in run.items() if key not in ("seconds", "rate")}
            for name, run in runs.items()}


def test_rows_are_the_same_however_many_processes_make_them(results):
    """To the last bit; and what was made before is not made again, nor told of."""
    row = ROWS[0]
    assert untimed(made_of([row], {}, 2)[row.name]) == untimed(results[row.name])
    begun = {row.name: {name: run for name, run in results[row.name].items() if name != "cost"}}
    again = made_of([row], begun, 2)[row.name]
    assert untimed(again) == untimed(results[row.name])
    assert all(again[name] is begun[row.name][name] for name in begun[row.name])
    assert results[row.name]["cost"]["seconds"]["estimators"] and not again["errors"]["seconds"]["estimators"]


def test_what_is_timed_runs_alone(monkeypatch):
    """All other runs are asked for at once; one that is timed when every other has ended, and before the next."""
    asked, open_ones, most = [], set(), {True: 0, False: 0}

    class Pool:
        def __init__(self, work, processes): ...

        def submit(self, question, hear, kind):
            future = Future()
            asked.append(question["timed"])
            open_ones.add(future)
            future.add_done_callback(open_ones.discard)
            most[question["timed"]] = max(most[question["timed"]], len(open_ones))
            return future

        def close(self): ...

    def wait(waiting, *_):
        first = next(iter(waiting))
        first.set_result({"result": {}})
        return {first}, set()

    monkeypatch.setattr(making, "WorkerPool", Pool)
    monkeypatch.setattr(making, "wait", wait)
    made_of(ROWS, {}, 2)
    timed = sum(name in making.TIMED for row in ROWS for name in row.scenes)
    assert asked == [False] * (len(asked) - timed) + [True] * timed
    assert most == {False: len(asked) - timed, True: 1}


@pytest.mark.parametrize("spoil", [lambda text: text, lambda text: text[:-100], lambda text: "[]",
                                   lambda text: text.replace('"cells": 12', '"cells": 13'),
                                   lambda text: text.replace('"errors"', '"other"')],
                         ids=["whole", "cut", "a list", "another scene", "another run"])
def test_runs_of_a_row_that_is_not_finished_are_taken_if_they_are_whole(spoil, results, tmp_path):
    row = next(row for row in ROWS if row.name == "ring-ours-cpdi-12")
    some = {"errors": results[row.name]["errors"]}
    rows.write_row(tmp_path, row, some)
    [path] = tmp_path.iterdir()
    assert path.suffix == rows.BEGUN and rows.read_row(tmp_path, row) is None
    text = path.read_text()
    path.write_text(spoil(text))
    assert rows.read_begun(tmp_path, row) == (some if path.read_text() == text else {})
    rows.write_row(tmp_path, row, results[row.name])
    assert [path.suffix for path in tmp_path.iterdir()] == [rows.FINISHED]


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="POSIX signals")
def test_a_killed_run_goes_on_where_it_was(tmp_path, results, counted, capsys):
    code = f"""
import os, signal, sys
from app.cli import main
from app.commands.study import tables
from solvers.study.tables import plan
MADE = {MADE}
plan.make, write, runs = lambda number, estimators: MADE[number], tables.write_row, []
def ten_runs(folder, row, made):
    write(folder, row, made)
    runs.append(row)
    if len(runs) == 10:
        os.kill(os.getpid(), signal.SIGKILL)
tables.write_row = ten_runs
main(["tables", "1", "--out", sys.argv[1]])
"""
    killed = subprocess.run([sys.executable, "-c", code, str(tmp_path)], cwd=ROOT, capture_output=True, timeout=HANG)
    assert killed.returncode == -signal.SIGKILL, killed.stderr
    # Two runs of each of the four rows, then what is timed, row by row.
    kept = sorted(path.name for path in (tmp_path / "rows").iterdir())
    assert kept == ["bar-large-material-20.begun", "bar-large-node-20.begun", "bar-small-material-20.json",
                    "bar-small-node-20.json"] and not (tmp_path / "table1.md").exists()
    assert main(["tables", "1", "--out", str(tmp_path)]) == 0
    assert counted == ["bar-large-node-20", "bar-large-material-20"]
    assert capsys.readouterr().err == "mpm-lab: 2 of 4 rows are there already\n"
    first, again = json.loads((tmp_path / "table1.json").read_text()), document(CUT["1"], results)
    assert [row["ours"] for row in first["rows"]] == [row["ours"] for row in again["rows"]]  # to the last bit


def test_an_interrupt_is_one_line_and_130_and_keeps_rows(tmp_path, remembered, capsys):
    def interrupted(self, row):
        if row is not CUT["2"].rows[0]:
            signal.raise_signal(signal.SIGINT)

    remembered.before = interrupted
    assert main(["tables", "2", "--out", str(tmp_path)]) == 130
    assert capsys.readouterr().err == "mpm-lab: interrupted\n"
    assert [path.name for path in tmp_path.rglob("*.*")] == ["ring-ours-cpdi-12.json"]


def test_an_unstable_row_is_marked_and_exits_3(tmp_path, results, remembered, capsys):
    remembered.results["ring-ours-cpdi-12"] = {
        name: {**run, "status": "unstable", "reason": "the run went unstable"}
        for name, run in results["ring-ours-cpdi-12"].items()}
    assert main(["tables", "2", "--out", str(tmp_path)]) == 3
    assert capsys.readouterr().err == "mpm-lab: ring-ours-cpdi-12: the run went unstable\n"
    assert "| 12[^1] |" in (tmp_path / "table2.md").read_text()
    assert "[^1]: the run went unstable" in (tmp_path / "table2.md").read_text()


@pytest.mark.parametrize(("flags", "says"), [
    (["4", "--out", "d"], "4: is not a table of the paper; give 1, 2, 3 or all"),
    (["1", "2", "--out", "d"], "1 2: is not a table of the paper"),
    (["1"], "--out (no value): give a directory for the tables"),
    (["1", "--out"], "--out (no value): give a directory for the tables"),
    (["1", "--out", "file"], "--out file: cannot be a directory: not a directory; give one that exists"),
    (["1", "--out", "file/below"], "--out file/below: cannot be a directory: not a directory"),
    (["1", "--out", "a" * 300], "name too long; give one"),
    (["1", "--out", "taken"], "--out taken/table1.json: cannot be written: is a directory"),
    (["1", "--out", "d", "--json", "-"], "--json: is not a flag of mpm-lab tables"),
])
def test_bad_input_is_one_line_that_names_the_flag(flags, says, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(command, "Making", lambda *_: pytest.fail("it ran before it had checked"))
    (tmp_path / "file").write_text("mine")
    (tmp_path / "taken" / "table1.json").mkdir(parents=True)
    assert main(["tables", *flags]) == 2
    seen = capsys.readouterr()
    assert seen.out == "" and seen.err.count("\n") == 1 and says in seen.err
    assert (tmp_path / "file").read_text() == "mine"


def test_help_is_light_and_names_the_choices():
    code = ("import sys; from app.cli import main; main(['tables', '--help']); main(['tables', '9', '--out', 'd']); "
            "sys.exit(any(name in sys.modules for name in ('taichi', 'viser', 'matplotlib')))")
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, timeout=HANG)
    assert done.returncode == 0 and "{1,2,3,all}" in done.stdout and "--out DIR" in done.stdout
