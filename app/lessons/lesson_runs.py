"""Results of a lesson's runs: each scene is run once, in a worker process, and cached."""

import os
import threading
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import Future, as_completed
from typing import Any

from app import state
from app.lessons.claims import ClaimScope, RunOutcome, runs_needed
from app.lessons.interval_bets import Ends, is_about_bets, judge_bets_for_claims
from app.lessons.lesson import Lesson, Numbers, Step, fill_numbers
from solvers.scene.kernel_options import kernel_key
from solvers.workers.worker_pool import WorkerPool, one_of_each_first
from solvers.workers.worker_process import ProcessDied

WORK = "app.lessons.lesson_runs:run_in_worker"
KEPT = 500  # results
SEVERAL = 4  # waiting scenes per process: most run in a tenth of the time of compilation


class RunFailed(Exception):
    """Raised if a scene could not be run; the message gives the reason."""


class RunCache:
    """Thread-safe cache of runs, made in so many ``processes``, which start when needed."""

    def __init__(self, processes: int = 1, politeness: int = 0):
        self._pool, self._politeness = WorkerPool(WORK, processes, several=SEVERAL), politeness
        self._lock = threading.Lock()
        self._runs: dict[tuple[str, bool], Future[dict[str, Any]]] = {}

    def close(self) -> None:
        self._pool.close()

    def result(self, text: str) -> dict[str, Any]:
        """Returns the result's JSON object for the scene of a state; waits for it."""
        return self._await_result(text, False)

    def judge_bets(self, text: str) -> dict[str, dict[str, Ends | None]]:
        """Returns the judges' bets on the final errors of a scene, by quantity and judge; waits for them."""
        return self._await_result(text, True)

    def _await_result(self, text: str, judged: bool) -> dict[str, Any]:
        try:
            return self._submit_run(text, judged).result()
        except ProcessDied as error:
            raise RunFailed(f"{_scene_text(text)} could not be run: the process {error}") from None

    def _submit_run(self, text: str, judged: bool = False) -> Future[dict[str, Any]]:
        """Returns the run of a state's scene, or the judges' bets on it; repeats a failed one."""
        scene = _scene_text(text)
        with self._lock:
            run = self._runs.get((scene, judged))
            if run is None or (run.done() and run.exception()):
                if len(self._runs) >= KEPT:
                    self._runs.pop(next(iter(self._runs)))
                run = self._runs[scene, judged] = self._pool.submit(
                    {"scene": scene, "politeness": self._politeness, "judged": judged}, kind=_scene_kernel_key(scene))
            return run

    def scope(self, lesson: Lesson, step: Step, numbers: Numbers, texts: Iterable[str]) -> ClaimScope:
        """Returns the scope of these expressions in a step; runs only what they need."""
        main, runs = lesson.main_run(step), lesson.runs
        texts = list(texts)
        asked = set().union(*(runs_needed(text, runs, main) for text in texts))
        result = self._result_with_bets if any(map(is_about_bets, texts)) else self.result
        return ClaimScope({name: RunOutcome([result(fill_numbers(text, numbers)) for text in run.texts], run.varied)
                           for name, run in runs.items() if name in asked}, main)

    def _result_with_bets(self, text: str) -> dict[str, Any]:
        """Returns a result with the judges' bets on it, in the form of claims."""
        found = self.result(text)
        return {**found, "bet": judge_bets_for_claims(self.judge_bets(text), found["error"])}

    def prepare(self, texts: Iterable[str], on_progress: Callable[[int, int], None]) -> None:
        """Runs all of these scenes in parallel; failures are raised when a result is requested."""
        scenes = {text: state.parse_state(text).scene for text in texts}
        longest_first = sorted(scenes, key=lambda text: (-scenes[text].particles * scenes[text].steps, text))
        runs = dict.fromkeys(map(self._submit_run, one_of_each_first(longest_first, _scene_kernel_key)))
        for done, _ in enumerate(as_completed(runs), 1):
            on_progress(done, len(runs))


def _scene_text(text: str) -> str:
    """Returns a state's text reduced to its scene."""
    return state.write_state(state.State(state.parse_state(text).scene))


def _scene_kernel_key(text: str) -> tuple:
    """Returns the key of the kernels that a state's scene needs."""
    return kernel_key(state.parse_state(text).scene)


def scene_texts(lesson: Lesson, numbers: Numbers) -> list[str]:
    """Returns the scenes of all runs of a lesson with these numbers."""
    return [fill_numbers(text, numbers) for run in lesson.runs.values() for text in run.texts]


def run_in_worker(question: Mapping[str, Any], answer: Callable[[dict], None]) -> None:
    """Runs one scene, or computes the judges' bets on it, in a worker process."""
    from solvers.running.run import run
    from solvers.study.coverage.track_record import bets

    if nice := getattr(os, "nice", None):  # not on every system
        nice(max(0, question["politeness"] - nice(0)))
    scene = state.parse_state(question["scene"]).scene
    answer(bets(scene) if question["judged"] else run(scene, prices=False, mid_run=False).to_dict())
