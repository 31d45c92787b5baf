"""What comes of a lesson's runs: each scene run once, in processes of their own, and kept."""

import os
import threading
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import Future, as_completed
from typing import Any

from app import state
from app.lessons.bets import Ends, about_bets, bets_by_judge
from app.lessons.claims import Outcome, Scope, runs_needed
from app.lessons.lesson import Lesson, Numbers, Step, fill_numbers
from solvers.scene.kernel_options import combination
from solvers.workers.worker_pool import WorkerPool, one_of_each_first
from solvers.workers.worker_process import ProcessDied

WORK = "app.lessons.lesson_runs:work"
KEPT = 500  # results
SEVERAL = 4  # scenes that wait: most are run in a tenth of the time that their kernels take to translate


class RunFailed(Exception):
    """A scene could not be run; the message says why."""


class RunCache:
    """Runs scenes in so many ``processes``, which start when they are needed. Safe from any thread."""

    def __init__(self, processes: int = 1, politeness: int = 0):
        self._pool, self._politeness = WorkerPool(WORK, processes, several=SEVERAL), politeness
        self._lock = threading.Lock()
        self._runs: dict[tuple[str, bool], Future[dict[str, Any]]] = {}

    def close(self) -> None:
        self._pool.close()

    def result(self, text: str) -> dict[str, Any]:
        """The result's JSON object of the scene of a state; waits for it."""
        return self._waited(text, False)

    def bets(self, text: str) -> dict[str, dict[str, Ends | None]]:
        """What the judges bet on the errors at the end of such a scene: ends by quantity and judge; waits for it."""
        return self._waited(text, True)

    def _waited(self, text: str, judged: bool) -> dict[str, Any]:
        try:
            return self._run(text, judged).result()
        except ProcessDied as error:
            raise RunFailed(f"{_scene(text)} could not be run: the process {error}") from None

    def _run(self, text: str, judged: bool = False) -> Future[dict[str, Any]]:
        """The run of the scene of a state, or the judges' bets on it; one that failed once more."""
        scene = _scene(text)
        with self._lock:
            run = self._runs.get((scene, judged))
            if run is None or (run.done() and run.exception()):
                if len(self._runs) >= KEPT:
                    self._runs.pop(next(iter(self._runs)))
                run = self._runs[scene, judged] = self._pool.submit(
                    {"scene": scene, "politeness": self._politeness, "judged": judged}, kind=_compiled(scene))
            return run

    def scope(self, lesson: Lesson, step: Step, numbers: Numbers, texts: Iterable[str]) -> Scope:
        """What the names in these expressions mean in a step: only the runs that they need are run."""
        main, runs = lesson.main_run(step), lesson.runs
        texts = list(texts)
        asked = set().union(*(runs_needed(text, runs, main) for text in texts))
        result = self._with_bets if any(map(about_bets, texts)) else self.result
        return Scope({name: Outcome([result(fill_numbers(text, numbers)) for text in run.texts], run.varied)
                      for name, run in runs.items() if name in asked}, main)

    def _with_bets(self, text: str) -> dict[str, Any]:
        """A result with the judges' bets on it, as claims have them."""
        found = self.result(text)
        return {**found, "bet": bets_by_judge(self.bets(text), found["error"])}

    def prepare(self, texts: Iterable[str], on_progress: Callable[[int, int], None]) -> None:
        """Run all of these scenes, as many at a time as there are processes; failures show when they are asked for."""
        scenes = {text: state.parse_state(text).scene for text in texts}
        longest_first = sorted(scenes, key=lambda text: (-scenes[text].particles * scenes[text].steps, text))
        runs = dict.fromkeys(map(self._run, one_of_each_first(longest_first, _compiled)))
        for done, _ in enumerate(as_completed(runs), 1):
            on_progress(done, len(runs))


def _scene(text: str) -> str:
    """What of a state's text says the scene."""
    return state.write_state(state.State(state.parse_state(text).scene))


def _compiled(text: str) -> tuple:
    """What has to be compiled for the scene of a state."""
    return combination(state.parse_state(text).scene)


def scene_texts(lesson: Lesson, numbers: Numbers) -> list[str]:
    """The scenes of all runs of a lesson with these numbers."""
    return [fill_numbers(text, numbers) for run in lesson.runs.values() for text in run.texts]


def work(question: Mapping[str, Any], answer: Callable[[dict], None]) -> None:
    """In a process of its own: run one scene, or ask the judges for their bets on it."""
    from solvers.running.run import run
    from solvers.study.coverage.track_record import bets

    if nice := getattr(os, "nice", None):  # not on every system
        nice(max(0, question["politeness"] - nice(0)))
    scene = state.parse_state(question["scene"]).scene
    answer(bets(scene) if question["judged"] else run(scene, prices=False, mid_run=False).to_dict())
