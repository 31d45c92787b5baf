"""Results of a lesson's runs: each scene is run once, in a worker process, and cached."""

import os
import threading
from collections.abc import Callable, Hashable, Iterable, Mapping
from concurrent.futures import Future, as_completed
from typing import Any

from app import shareable_state
from app.lessons.body_runs import body_of_run, is_body_run
from app.lessons.claims import ClaimNamespace, RunOutcome, runs_needed
from app.lessons.interval_bets import ABOUT_BETS, Ends, judge_bets_for_claims
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
    """Thread-safe cache of the results of scenes, run in so many worker ``processes``, which start when needed, at the
    nice value ``politeness``. Scenes are given as texts of states, of which only the scene counts."""

    def __init__(self, processes: int = 1, politeness: int = 0):
        self._pool, self._politeness = WorkerPool(WORK, processes, several=SEVERAL), politeness
        self._lock = threading.Lock()
        self._runs: dict[tuple[str, bool], Future[dict[str, Any]]] = {}

    def close(self) -> None:
        self._pool.close()

    def result(self, text: str) -> dict[str, Any]:
        """Returns the JSON object of a scene's result; waits for the run. Raises :class:`RunFailed`."""
        return self._await_result(text, False)

    def judge_bets(self, text: str) -> dict[str, dict[str, Ends | None]]:
        """Returns judges' bets (low, high), or None, on final errors (SI units), by quantity and judge."""
        return self._await_result(text, True)

    def _await_result(self, text: str, judged: bool) -> dict[str, Any]:
        try:
            return self._submit_run(text, judged).result()
        except ProcessDied as error:
            raise RunFailed(f"{_scene_text(text)} could not be run: the process {error}") from None

    def _submit_run(self, text: str, judged: bool = False) -> Future[dict[str, Any]]:
        """Returns the future result of a scene or, if ``judged``, the judges' bets on it; repeats a failed run."""
        scene = _scene_text(text)
        with self._lock:
            run = self._runs.get((scene, judged))
            if run is None or (run.done() and run.exception()):
                if len(self._runs) >= KEPT:
                    self._runs.pop(next(iter(self._runs)))
                run = self._runs[scene, judged] = self._pool.submit(
                    {"scene": scene, "politeness": self._politeness, "judged": judged},
                    kind=_kernels(scene))
            return run

    def scope(self, lesson: Lesson, step: Step, numbers: Numbers, texts: Iterable[str]) -> ClaimNamespace:
        """Returns the scope to evaluate expressions and claims of a step with a variant's ``numbers``; runs only the
        scenes that these ``texts`` need. Raises :class:`RunFailed`."""
        main, runs = lesson.main_run(step), lesson.runs
        texts = list(texts)
        asked = set().union(*(runs_needed(text, runs, main) for text in texts))
        result = self._result_with_bets if any(map(ABOUT_BETS.search, texts)) else self.result
        return ClaimNamespace({name: RunOutcome([result(fill_numbers(text, numbers)) for text in run.texts], run.varied)
                               for name, run in runs.items() if name in asked}, main)

    def _result_with_bets(self, text: str) -> dict[str, Any]:
        """Returns the JSON object of a scene's result with the judges' bets, as claims name them, under "bet"."""
        found = self.result(text)
        if is_body_run(text):
            return found
        return {**found, "bet": judge_bets_for_claims(self.judge_bets(text), found["error"])}

    def prepare(self, texts: Iterable[str], on_progress: Callable[[int, int], None]) -> None:
        """Runs scenes in parallel; ``on_progress`` gets the numbers done and in all; :meth:`result` raises failures."""
        longest_first = sorted(set(texts), key=lambda text: (-_particle_steps(text), text))
        ordered = one_of_each_first(longest_first, _kernels)
        runs = dict.fromkeys(map(self._submit_run, ordered))
        for done, _ in enumerate(as_completed(runs), 1):
            on_progress(done, len(runs))


def _scene_text(text: str) -> str:
    """Returns the text of a state with only its scene, without view and pinned run; that of a body as it is."""
    if is_body_run(text):
        return text
    return shareable_state.write_state(shareable_state.State(shareable_state.parse_state(text).scene))


def _kernels(text: str) -> Hashable:
    """Returns a key of a run's compiled kernels: runs with equal ones share them."""
    return body_of_run(text).method if is_body_run(text) else kernel_key(shareable_state.parse_state(text).scene)


def _particle_steps(text: str) -> float:
    """Returns the number of particles times steps of a run."""
    if is_body_run(text):
        return body_of_run(text).particle_steps
    scene = shareable_state.parse_state(text).scene
    return scene.particles * scene.steps


def scene_texts(lesson: Lesson, numbers: Numbers) -> list[str]:
    """Returns the scenes of all runs of a lesson, as texts of states, with a variant's numbers filled in."""
    return [fill_numbers(text, numbers) for run in lesson.runs.values() for text in run.texts]


def run_in_worker(question: Mapping[str, Any], answer: Callable[[dict], None]) -> None:
    """Runs the scene in ``question`` in a worker process, or computes the judges' bets; sends the JSON object."""
    from solvers.bodies.run import run_body
    from solvers.running.run import run
    from solvers.study.coverage.track_record_and_bets import bets
    if nice := getattr(os, "nice", None):  # not on every system
        nice(max(0, question["politeness"] - nice(0)))
    if is_body_run(question["scene"]):
        answer(run_body(body_of_run(question["scene"])).to_dict())
        return
    scene = shareable_state.parse_state(question["scene"]).scene
    answer(bets(scene) if question["judged"] else run(scene, prices=False, mid_run=False).to_dict())
