"""Sweeps: tasks, rows, their safety on disk and lost workers."""

import json
import os
from concurrent.futures import Future

import numpy as np
import pytest

from solvers import SceneError
from solvers.problems.bar.scene import BarScene
from solvers.study import row
from solvers.study.executors import ATTEMPTS, ExecutorLost, LocalExecutor, execute
from solvers.study.parameter_grid import Task, combinations, plan_tasks
from solvers.study.row_store import RowStore, StoreError
from solvers.study.sweep import Rows
from solvers.workers.worker_process import ProcessDied
from tests.support.fake_rows import fake_row

QUICK = {"cells": 8, "ppc": 2, "periods": 0.2}


def test_every_combination_once_in_order():
    assert combinations({"a": [1, 2], "b": "xy"}) == [{"a": 1, "b": "x"}, {"a": 1, "b": "y"}, {"a": 2, "b": "x"},
                                                      {"a": 2, "b": "y"}]
    tasks = plan_tasks("bar", {"method": ["mpm", "ugimp"], "cells": [20, 40, 20]})
    assert [tuple(task.inputs.values()) for task in tasks] == [("mpm", 20), ("mpm", 40), ("ugimp", 20), ("ugimp", 40)]


def test_a_key_belongs_to_the_scene_not_to_its_wording():
    key = Task("bar", {"cells": 40}).key
    assert key == Task("bar", {"cells": 40, "cfl": 0.05, "modulus": 4, "ppc": None or 4}, repeats=9).key
    assert key != Task("bar", {"cells": 41}).key != Task("ring", {"cells": 41}).key
    refused = [Task("bar", {"amplitude": a}).key for a in (0.2, 0.3)]
    assert len({key, *refused}) == 3


def test_a_task_survives_json():
    task = plan_tasks("bar", {"estimator": [("transport",)], "effects": [()], "amplitude": [0.1, float("nan")]},
                      repeats=2)[1]
    assert Task(**json.loads(json.dumps(task.to_dict(), allow_nan=False))).key == task.key
    assert task.refusal().field == "amplitude" and task.remarks() == [f"refused: {task.refusal()}"]
    with pytest.raises(SceneError, match="amplitude"):
        plan_tasks("bar", {"amplitude": [0.2, 0.3]})


def test_a_row_holds_the_run_and_what_it_cost():
    found = row.measure(Task("bar", QUICK, repeats=2, price_effects=True, version="7"))
    assert (found["status"], found["reason"], found["version"], found["h"]) == ("ok", None, "7", 1 / 8)
    assert found["scene"] == BarScene(cells=8, ppc=2, periods=0.2).to_dict()
    assert found["particle_steps"] == found["steps"] * found["particles"] > 0
    for part in ("estimate", "index", "distance"):
        assert set(found[part]) == {"companion"} and found[part]["companion"]["x"] is not None
    seconds = found["seconds"]
    assert len(seconds["repeats"]) >= 2 and seconds["min"] == min(seconds["repeats"]) > 0
    assert set(seconds["effects"]) == {"truth", "crossings", "energy", "acceleration", "soundness", "margin"}
    assert found["rate"] == pytest.approx(1e-6 * found["particle_steps"] / seconds["min"])
    json.dumps(found, allow_nan=False)


def test_the_timed_run_computes_nothing_but_the_method(monkeypatch):
    import solvers.running.run
    seen, real = [], solvers.running.run.run
    monkeypatch.setattr(solvers.running.run, "run",
                        lambda scene, **options: seen.append(scene) or real(scene, **options))
    row.time_bare(BarScene(cells=8), 2)
    assert len(seen) > 2 and seen[0].steps < seen[1].steps  # warmed up first
    assert {(scene.effects, scene.estimators) for scene in seen} == {((), ())}


def test_bad_runs_are_rows(monkeypatch):
    unstable = row.measure(Task("bar", {**QUICK, "periods": 5, "cfl": 1.5}, repeats=1))
    assert unstable["status"] == "unstable" and "unstable" in unstable["reason"] and unstable["seconds"]["min"] > 0
    refused = row.measure(Task("bar", {"amplitude": 0.2}))
    assert refused["status"] == "refused" and "inverts" in refused["reason"] and refused["scene"] is None
    monkeypatch.setattr("solvers.running.run._idle_solvers", None)  # one that another test has left needs no room
    monkeypatch.setattr("solvers.running.run.build", lambda scene: (_ for _ in ()).throw(MemoryError("no\nroom")))
    failed = row.measure(Task("bar", QUICK))
    assert (failed["status"], failed["reason"]) == ("failed", "MemoryError: no room")


class Fragile:
    """A place that loses the workers of some tasks so many times."""

    def __init__(self, losses: dict[int, int]):
        self.losses, self.calls = losses, 0

    def submit(self, task: Task) -> Future:
        self.calls += 1
        future, cells = Future(), task.inputs["cells"]
        self.losses[cells] = self.losses.get(cells, 0) - 1
        if self.losses[cells] >= 0:
            future.set_exception(ProcessDied("was ended by SIGKILL"))
        else:
            future.set_result({"key": task.key, "status": "ok", "cells": cells})
        return future

    def check(self) -> None: ...


def test_lost_workers_are_replaced_and_a_deadly_row_is_given_up():
    rows, place = [], Fragile({8: ATTEMPTS - 1, 9: 100})
    tasks = plan_tasks("bar", {"cells": [7, 8, 9, 10]})
    execute(tasks, place, rows.append)
    found = {row["key"]: row for row in rows}
    assert [found[task.key]["status"] for task in tasks] == ["ok", "ok", "failed", "ok"]
    assert place.calls == 2 + 2 * ATTEMPTS and len(rows) == 4
    assert f"{ATTEMPTS} times" in found[tasks[2].key]["reason"] and "SIGKILL" in found[tasks[2].key]["reason"]


def test_a_place_that_is_gone_ends_the_sweep():
    class Gone(Fragile):
        def submit(self, task):
            future = Future()
            future.cancel()
            future.set_running_or_notify_cancel()
            return future

    with pytest.raises(ExecutorLost, match="lost"):
        execute(plan_tasks("bar", {"cells": [8]}), Gone({}), pytest.fail)


def test_rows_run_in_processes_of_their_own_and_these_end():
    place, rows = LocalExecutor(workers=2), []
    execute(plan_tasks("bar", {**{name: [value] for name, value in QUICK.items()}, "cells": [8, 9, 10]}, repeats=1),
            place, rows.append)
    processes = place.pool.process_ids
    place.close()
    assert sorted(row["scene"]["cells"] for row in rows) == [8, 9, 10] and 1 <= len(processes) <= 2
    assert os.getpid() not in processes
    for process in processes:
        with pytest.raises(ProcessLookupError):
            os.kill(process, 0)


def test_a_row_cut_short_is_measured_again(tmp_path):
    store = RowStore(tmp_path / "new", "bar")
    kept, lost = fake_row(cells=20), fake_row(cells=40)
    store.append(kept)
    store.append(lost)
    store.close()
    path = tmp_path / "new" / "rows.jsonl"
    path.write_bytes(path.read_bytes()[:-40])
    store = RowStore(tmp_path / "new", "bar", resume=True)
    assert store.is_finished(kept["key"]) and not store.is_finished(lost["key"])
    store.append(lost)
    store.close()
    assert [json.loads(line) for line in path.read_text().splitlines()] == [kept, lost]


def test_what_failed_is_tried_again(tmp_path):
    store = RowStore(tmp_path, "bar")
    store.append(fake_row(status="failed"))
    assert not store.is_finished(fake_row()["key"])
    store.append(fake_row(status="unstable"))
    assert store.is_finished(fake_row()["key"]) and len(store.rows) == 1
    store.close()


@pytest.mark.parametrize(("content", "problem", "resume", "says"), [
    ({"rows.jsonl": "{}\n"}, "bar", False, "--resume"),
    ({"letter.txt": "dear"}, "bar", False, "is not empty"),
    ({"letter.txt": "dear"}, "bar", True, "no rows.jsonl"),
    ({"rows.jsonl": "what\n"}, "bar", True, "line 1"),
    ({"rows.jsonl": json.dumps(fake_row()) + "\n"}, "ring", True, "rows of the bar"),
])
def test_a_directory_that_is_not_ours_is_refused(tmp_path, content, problem, resume, says):
    for name, text in content.items():
        (tmp_path / name).write_text(text)
    with pytest.raises(StoreError, match=says):
        RowStore(tmp_path, problem, resume)
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == content


@pytest.mark.skipif(os.name == "nt", reason="POSIX locks")
def test_two_sweeps_do_not_write_to_one_file(tmp_path):
    store = RowStore(tmp_path, "bar")
    with pytest.raises(StoreError, match="another sweep"):
        RowStore(tmp_path, "bar", resume=True)
    store.close()


# ---- columns of rows, as a user of Python asks for them ---------------------------------------------------------

ROWS = Rows([{"cells": 10, "error": 0.5, "method": "mpm", "on": True, "reason": None},
             {"cells": 20, "error": None, "method": "ugimp", "on": False, "reason": "lost"}])


def test_a_name_gives_a_column():
    assert ROWS["cells"].dtype.kind == "i" and ROWS["cells"].tolist() == [10, 20]
    assert ROWS["error"].dtype == float and ROWS["error"][0] == 0.5 and np.isnan(ROWS["error"][1])
    assert (ROWS["method"] == "mpm").tolist() == [True, False]
    assert ROWS["on"].tolist() == [True, False] and ROWS["reason"].tolist() == [None, "lost"]


def test_it_is_still_a_list_of_rows():
    assert ROWS[0]["cells"] == 10 and ROWS[-1] == ROWS[1] and len(ROWS) == 2
    assert isinstance(ROWS[:1], Rows) and ROWS[:1]["cells"].tolist() == [10]
    assert Rows(row for row in ROWS if row["on"])["cells"].tolist() == [10]
    assert ROWS.columns == ["cells", "error", "method", "on", "reason"] and Rows().columns == []


@pytest.mark.parametrize(("rows", "name", "says"), [
    (ROWS, "eror", "did you mean error"), (ROWS, "x", "they have cells, error, method"), (Rows(), "cells", "none")])
def test_a_column_that_there_is_not(rows, name, says):
    with pytest.raises(SceneError, match=says):
        rows[name]
