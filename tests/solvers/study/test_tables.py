"""``mpm-lab tables``: the paper's numbers beside ours, and what is written of them."""

import json

import pytest

from app.cli import main
from app.commands.study.paper_tables import PaperTables, table_markdown
from app.names_and_units import QUANTITIES
from app.pictures.paper_tables import table_figure
from solvers.problems import PROBLEMS
from solvers.scene.estimator_registry import ESTIMATORS
from solvers.study.row import failed_row, find_fault
from solvers.study.tables import paper_table_definitions
from solvers.study.tables.paper_table_definitions import format_digits
from solvers.study.tables.table_runs import MEASURED, all_runs, measure_in_worker, results_by_row, table_to_dict
from tests.support.fake_rows import InstantExecutor
from tests.support.paths import ROOT

#: Cut-down tables: the coarsest rows, the bar for a hundredth of the time.
CUT = {"1": paper_table_definitions.table_1({"bar": ("transport",)}, cells=(20,), end=0.01, long=0.02),
       "2": paper_table_definitions.table_2({"ring": ("transport",)}, cells=(12,), methods=("cpdi",)),
       "3": paper_table_definitions.table_3({"ring": ("transport",)}, cells=(12,), methods=("cpdi",))}


@pytest.fixture(autouse=True)
def cut_down(monkeypatch):
    monkeypatch.setattr(paper_table_definitions, "make_table", lambda number, estimators: CUT[number])


@pytest.fixture(scope="module")
def measured() -> dict[str, dict]:
    """The row of every run by its key, once for all tests."""
    found: list[dict] = []
    for task in all_runs(CUT.values()):
        measure_in_worker(task.to_dict(), found.append)
    return {row["key"]: json.loads(json.dumps(row, allow_nan=False)) for row in found}


@pytest.fixture(scope="module")
def results(measured) -> dict:
    return {name: runs for table in CUT.values() for name, runs in results_by_row(table, measured.values()).items()}


@pytest.fixture
def place(measured, monkeypatch) -> InstantExecutor:
    """Where runs are there at once."""
    place = InstantExecutor(lambda task: measured[task.key])
    monkeypatch.setattr("solvers.study.executors.LocalExecutor", place)
    return place


@pytest.fixture(scope="module")
def made(results) -> dict[str, dict]:
    """The three tables' objects, as they read in their files."""
    return {number: json.loads(json.dumps(table_to_dict(table, results), allow_nan=False)) for number,
            table in CUT.items()}


def test_the_papers_numbers_are_those_of_the_bars_reference():
    reference = json.loads((ROOT / "assets/reference/bar.json").read_text())["table1"]
    for case in ("small", "large"):
        for cells, row in reference[case]["rows"].items():
            printed = paper_table_definitions.printed_bar_row(reference[case]["modulus"], int(cells))
            assert {key: printed[key] for key in row["paper"]} == row["paper"]
            assert {q: printed[f"index_{q}"] for q in row["paper_index"]} == row["paper_index"]
    assert paper_table_definitions.printed_ring_errors("cpdi", 96) == {"x": 8.9e-6, "v": 1.4e-2, "a_nodes": 7.6e1}
    assert paper_table_definitions.printed_ring_index("ugimp", 12) == {"index_x": 0.69}
    assert (
        paper_table_definitions.printed_bar_row(4.0, 21)
        == paper_table_definitions.printed_ring_errors("cpdi", 13)
        == {}
        == paper_table_definitions.printed_ring_index("mpm", 12)
    )


def test_whole_tables_have_the_papers_rows_twice(monkeypatch):
    monkeypatch.undo()
    first, second, third = (paper_table_definitions.make_table(number,
                                                    {name: PROBLEMS[name].estimators for name in ("bar", "ring")})
                            for number in paper_table_definitions.NUMBERS)
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
    refused = results["ring-ours-cpdi-12"]["errors"]  # the paper's estimator has its index where it is not valid, too
    assert index["ours"]["index_x"] == refused["refused"]["transport"]["index"]["x"] and refused["not_valid"]
    assert bar["inputs"]["t_end_crossings"] == pytest.approx(0.02)
    large = results["bar-large-node-20"]
    assert large["crossings"]["grid_crossings"] > large["errors"]["grid_crossings"] > 0
    assert large["crossings"]["effects"] == ["crossings", "body_force", "linearity_preserving"]


@pytest.fixture
def retold(results):
    """``retold(make)`` is Table 3's first row with the runs' objects as ``make`` has them."""
    def table(make):
        row = CUT["3"].rows[0]
        runs = {name: result | make(result) for name, result in results[row.name].items()}
        return table_to_dict(paper_table_definitions.PaperTableDefinition("3", "t", "c", (), (row,)), {row.name: runs})

    return table


def test_several_estimators_are_told_apart(retold, made):
    table = retold(lambda run: {
        "scene": {**run["scene"], "estimator": ["transport", "recovered"]},
        "not_valid": {"recovered": "not valid here: a wall"},
        **{kind: {"transport": run[kind], "recovered": None} for kind in ("index", "distance")}})
    said, nothing = table["rows"][0]["estimators"], dict.fromkeys(QUANTITIES)
    assert said["transport"]["index"] == made["3"]["rows"][0]["estimators"]["transport"]["index"]
    assert said["recovered"] == {"index": nothing, "cost": None, "distance": nothing,
                                 "not_valid": "not valid here: a wall"}
    text = table_markdown(table)
    assert "| –[^1] |" in text and "| recovered[^1] | – |" in text
    assert text.count("[^1]: recovered: not valid here: a wall") == 1
    assert any("no index: recovered" in words.get_text() for axes in table_figure(table).subfigs[0].axes
               for words in axes.texts)


def test_pictures_have_a_colour_an_estimator_and_no_dead_panel(retold):
    """A quantity without any index has no row of panels, and a part without one has words and no axes."""
    names = ("transport", "companion")
    table = retold(lambda run: {"scene": {**run["scene"], "estimator": [*names]}, "not_valid": {},
                                "index": {"transport": run["index"], "companion": {**run["index"], "sigma": None}},
                                "distance": dict.fromkeys(names, run["distance"])})
    assert table["rows"][0]["estimators"]["transport"]["index"]["sigma"] is None
    panels = table_figure(table).subfigs[0].axes
    assert [panel.get_ylabel() for panel in panels] == [f"index of {QUANTITIES[q]}" for q in ("x", "v", "a")]
    colours = {line.get_label(): line.get_color() for line in panels[0].get_lines()}
    assert {name: colours[name] for name in names} == {name: ESTIMATORS[name].colour for name in names}
    stressed = {**table["rows"][0], "inputs": {**table["rows"][0]["inputs"], "method": "ugimp"}, "estimators": {
        "companion": {"index": dict.fromkeys(QUANTITIES, 1.0)}}}
    panels = table_figure({**table, "rows": [*table["rows"], stressed]}).subfigs[0].axes
    dead = [panel for panel in panels if not panel.axison]
    assert [text.get_text() for panel in dead for text in panel.texts] == ["no index of σ here"]


def test_markdown_has_the_setup_the_papers_numbers_ours_and_the_ratio(made):
    for number, table in made.items():
        text = table_markdown(table)
        assert text.startswith(f"# Table {number}. ") and all(line in text for line in table["setup"])
        rows = [line for line in text.splitlines() if line.startswith("|")]
        assert {line.count("|") for line in rows if "cells" in line} <= {line.count("|") for line in rows}
        assert all(f"## {row['part']}" in text for row in table["rows"])
    ours = format_digits(made["1"]["rows"][0]["ours"]["x"], 3)
    assert f"| 20 | {ours} | 3.6e-6 |" in table_markdown(made["1"])
    assert "| 17,000 |" in table_markdown(made["1"]) and "| 20 | the paper's, printed | 0.89 | 0.14 | 1.6 |" \
        in table_markdown(made["1"])
    assert f"| CPDI | 12 | {format_digits(made['2']['rows'][0]['ours']['x'], 3)} | 4.1e-4 |" in table_markdown(
        made["2"]
    )
    assert "| 250 |" in table_markdown(made["2"]) and "| 10 |" in table_markdown(made["3"])


@pytest.mark.parametrize(("value", "count", "text"), [
    (3.49e-6, 3, "3.49e-6"), (0.05806, 3, "0.0581"), (0.2, 2, "0.20"), (9.162, 3, "9.16"), (448.2, 3, "448"),
    (9999.0, 2, "1.0e4"), (0.0999, 2, "0.10"), (3.5e5, 2, "3.5e5"), (700.0, 2, "700")])
def test_digits(value, count, text):
    assert format_digits(value, count) == text


def test_pictures_show_ours_and_the_papers(made):
    for table in made.values():
        drawn = [line for part in table_figure(table).subfigs for axes in part.axes for line in axes.get_lines()]
        labels = {line.get_label() for line in drawn}
        assert "the paper's, printed" in labels
        for row in table["rows"]:
            values = [value for line in drawn for value in line.get_ydata()]
            shown = {"1": ("x", "v", "sigma_log", "index_x"), "2": ("x", "v", "a_nodes"), "3": ("index_x",)}
            for key in shown[table["table"]]:
                assert row["ours"][key] in values and row["paper"][key] in values


def test_runs_are_made_once_those_that_are_timed_alone(measured):
    """All that is only computed side by side, the longest first; then one at a time, with the price of estimators.
    Tables 2 and 3 share their runs."""
    wanted = all_runs(CUT.values())
    together, *alone = PaperTables.parallel_groups(PaperTables.__new__(PaperTables), wanted)
    work = [task.scene().particles * task.scene().steps for task in together]
    assert work == sorted(work, reverse=True) and len(together) == 4 * 2 + 2
    assert [len(group) for group in alone] == [1] * 6
    assert all(task.scene().sample_every is None and task.repeats for [task] in alone)
    for task in wanted:
        assert find_fault(measured[task.key], MEASURED) is None
        assert bool(measured[task.key]["result"]["seconds"]["estimators"]) == bool(task.repeats)


def test_all_writes_nine_files_and_goes_on_where_it_was(place, tmp_path, monkeypatch, capsys):
    """A run is not made again for another table, but by another version of the solvers, or after it had failed."""
    out = ["--out", str(tmp_path / "new" / "dir")]
    assert main(["tables", "2", *out]) == 0
    asked = len(place.asked)
    assert main(["tables", "all", *out, "--quiet"]) == 0
    folder = tmp_path / "new" / "dir"
    assert {path.name for path in folder.iterdir()} == {"rows.jsonl", *(f"table{n}.{kind}" for n in "123"
                                                                        for kind in ("md", "json", "png"))}
    for number in "123":
        table = json.loads((folder / f"table{number}.json").read_text())
        assert (folder / f"table{number}.md").read_text() == table_markdown(table)
        assert (folder / f"table{number}.png").read_bytes().startswith(b"\x89PNG\r\n\x1a\n")
    assert asked == 4 and len(place.asked) == len(all_runs(CUT.values())) == (folder / "rows.jsonl").read_text().count(
        "\n"
    )
    said = capsys.readouterr()
    assert said.out == "" and "4/4 ring, cpdi, 12 cells: ok" in said.err
    first = (folder / "table3.md").read_text()
    assert main(["tables", "3", *out]) == 0
    assert capsys.readouterr().err == "mpm-lab: 4 rows, 4 of them there already\n"
    assert len(place.asked) == 16 and (folder / "table3.md").read_text() == first
    monkeypatch.setattr("solvers.study.row_store.solver_source_hash", lambda: "another")
    assert main(["tables", "3", *out]) == 0
    assert len(place.asked) == 20


def test_an_unstable_row_is_marked_and_exits_3(place, measured, tmp_path, capsys):
    reason = "the run went unstable"
    place._answer = lambda task: {**measured[task.key], "result": {
        **measured[task.key]["result"], "status": "unstable", "reason": reason}}
    assert main(["tables", "2", "--out", str(tmp_path), "--quiet"]) == 3
    said = capsys.readouterr().err
    assert said == "".join(f"mpm-lab: ring-{name}-cpdi-12: {reason}\n" for name in ("ours", "fitted"))
    text = (tmp_path / "table2.md").read_text()
    assert "| 12[^1] |" in text and f"[^1]: {reason}" in text


def test_a_run_that_failed_makes_no_table_and_is_made_again(place, tmp_path, capsys):
    answer, place._answer = place._answer, lambda task: failed_row(task, "MemoryError: no room")
    assert main(["tables", "2", "--out", str(tmp_path), "--quiet"]) == 1
    said = capsys.readouterr().err
    assert said == "mpm-lab: 4 runs failed, the first of them: MemoryError: no room; the others are kept\n"
    place._answer = answer
    assert main(["tables", "2", "--out", str(tmp_path), "--quiet"]) == 0 and len(place.asked) == 8
