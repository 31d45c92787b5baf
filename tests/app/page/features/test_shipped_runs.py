"""The runs that the Cost tab opens with: for which scenes there are any, and that their errors are those of today."""

from dataclasses import replace

import pytest

from app import shareable_state
from app.page.features.cost import shipped_runs
from app.page.features.cost.jobs import sweep_tasks
from app.page.features.cost.shipped_runs import measure_errors, scenes_to_ship, shipped_rows
from app.page.features.cost.visitor_run_list import (
    SHIPPED,
    VisitorRunList,
    cheapest_run,
    comparable_runs,
    pareto_front,
    run_of_scene,
    runs_in_chart,
)
from app.page.features.opening_tour import OPENING
from app.page.visit.first_scene import first_scene
from solvers.solver.soundness import UNSTABLE

OPENED = {"opening": OPENING.scene} | {name: first_scene(name) for name in shipped_runs.BUILT_IN}
LINKED = {"a link to the ring": replace(first_scene("ring"), periods=None)}  # which ends at the same time


def shipped(scene, quantity="x"):
    """What the chart of a scene opens with."""
    runs = VisitorRunList()
    runs.count_errors_of(quantity)
    for row in shipped_rows(scene.problem):
        runs.add(row, SHIPPED)
    return runs_in_chart(runs.all(), scene)


@pytest.mark.parametrize("name", [*OPENED, *LINKED])
def test_stages_that_the_page_opens_with_have_a_chart_at_once(name):
    """Every grid of every method, the stage's run among them, and times that grow with the cells."""
    scene = (OPENED | LINKED)[name]
    runs = shipped(scene)
    assert len(runs) == len(comparable_runs(runs, scene)) == len(sweep_tasks(scene))
    assert run_of_scene(runs, scene) and len(pareto_front(runs)) > 1
    for method in scene.choices("method"):
        times = [run.seconds for run in sorted(runs, key=lambda run: run.scene.cells)
                 if run.method == method and run.drawable and not run.broken]
        assert times == sorted(times)


def test_opening_run_is_as_wrong_as_it_says():
    """The figures of the opening: 6.4 % of the largest stress, of which the estimator finds 91 %."""
    runs = shipped(OPENING.scene, "sigma")
    own = run_of_scene(runs, OPENING.scene)
    assert own.error == pytest.approx(0.064, rel=0.01) and own.estimate / own.error == pytest.approx(0.91, abs=0.01)
    assert cheapest_run(runs, own.error).seconds < own.seconds


def test_a_motion_without_runs_has_those_of_another_as_an_example():
    runs = shipped(replace(OPENING.scene, amplitude=0.01))
    assert len({run.scene.amplitude for run in runs}) == 1 and len(runs) == len(sweep_tasks(OPENING.scene))


def same_errors(found, stored):
    """Whether two measurements of a run agree; round-off of another processor changes less. The numbers of an unstable
    run are those of rounding."""
    return found["status"] == stored["status"] and (found["status"] == UNSTABLE or all(
        found[kind] == pytest.approx(stored[kind], rel=1e-9) for kind in ("error", "estimate")))


@pytest.mark.parametrize("number", range(len(OPENED)), ids=OPENED)
def test_shipped_errors_are_those_of_runs_of_today(number):
    text, runs = list(shipped_runs.read_file().items())[number]
    scene = shareable_state.parse_state(text).scene
    for run in runs:
        assert same_errors(measure_errors(replace(scene, method=run["method"], cells=run["cells"])), run), run


def test_what_is_shipped_can_be_measured_anew(monkeypatch, tmp_path):
    before = next(iter(shipped_runs.read_file().values()))
    monkeypatch.setattr(shipped_runs, "FILE", tmp_path / "runs.json")
    monkeypatch.setattr(shipped_runs, "scenes_to_ship", lambda: dict([next(iter(scenes_to_ship().items()))]))
    monkeypatch.setattr(shipped_runs, "sweep_tasks", lambda scene: sweep_tasks(scene)[:2])
    shipped_runs.main()
    [runs] = shipped_runs.read_file().values()
    assert runs[0]["cells"] == 40 and runs[1]["cells"] == 20 and 0 < runs[1]["seconds"] < runs[0]["seconds"]
    assert all(same_errors(found, stored) for found, stored in zip(runs, before[:2], strict=True))
