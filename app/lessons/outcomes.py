"""What comes of a lesson's runs: each scene run once, in processes of their own, and kept."""

import os
import threading
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from typing import Any

from app import state
from app.lessons.claims import Outcome, Scope, needed
from app.lessons.lesson import Lesson, Run, Step
from app.lessons.variants import Numbers, filled
from solvers.workers.processes import ProcessDied, WorkerPool

WORK = "app.lessons.outcomes:work"
KEPT = 500  # results


class RunFailed(Exception):
    """A scene could not be run; the message says why."""


class Outcomes:
    """Runs scenes in so many ``processes``, which start when they are needed. Safe from any thread."""

    def __init__(self, processes: int = 1, politeness: int = 0):
        self._processes, self._politeness, self._lock = processes, politeness, threading.Lock()
        self._kept: dict[str, dict[str, Any]] = {}
        self._pool = WorkerPool(WORK, processes)

    def close(self) -> None:
        """End all processes."""
        self._pool.close()

    def result(self, text: str) -> dict[str, Any]:
        """The result's JSON object of the scene of a state; waits for it."""
        scene = state.write(state.State(state.read(text).scene))
        if found := self._known(scene):
            return found
        with self._pool.lent() as process:
            if found := self._known(scene):  # somebody else has had it run meanwhile
                return found
            try:
                [found] = process.ask({"scene": scene, "politeness": self._politeness})
            except ProcessDied as error:
                raise RunFailed(f"{scene} could not be run: the process {error}") from None
        with self._lock:
            if len(self._kept) >= KEPT:
                self._kept.pop(next(iter(self._kept)))
            self._kept[scene] = found
        return found

    def _known(self, scene: str) -> dict[str, Any] | None:
        with self._lock:
            return self._kept.get(scene)

    def outcome(self, run: Run, numbers: Numbers) -> Outcome:
        """What comes of a run with these numbers."""
        return Outcome([self.result(filled(text, numbers)) for text in run.texts], run.varied)

    def scope(self, lesson: Lesson, step: Step, numbers: Numbers, texts: Iterable[str]) -> Scope:
        """What the names in these expressions mean in a step: only the runs that they need are run."""
        main, runs = lesson.main_run(step), lesson.runs
        asked = set().union(*(needed(text, runs, main) for text in texts))
        return Scope({name: self.outcome(runs[name], numbers) for name in runs if name in asked}, main)

    def prepare(self, texts: Iterable[str], on_progress: Callable[[int, int], None]) -> None:
        """Run all of these scenes, as many at a time as there are processes; failures show when they are asked for."""
        scenes, done = sorted(set(texts)), 0
        with ThreadPoolExecutor(self._processes) as threads:
            for _ in threads.map(self._try, scenes):
                done += 1
                on_progress(done, len(scenes))

    def _try(self, text: str) -> None:
        with suppress(RunFailed):
            self.result(text)


def scene_texts(lesson: Lesson, numbers: Numbers) -> list[str]:
    """The scenes of all runs of a lesson with these numbers."""
    return [filled(text, numbers) for run in lesson.runs.values() for text in run.texts]


def work(question: Mapping[str, Any], answer: Callable[[dict], None]) -> None:
    """In a process of its own: run one scene."""
    from solvers.running.run import run

    if os.nice(0) < question["politeness"]:
        os.nice(question["politeness"] - os.nice(0))
    answer(run(state.read(question["scene"]).scene, prices=False, mid_run=False).to_dict())
