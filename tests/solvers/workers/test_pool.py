"""The pool of worker processes: one queue, futures, what is heard on the way, and every way to end."""

from __future__ import annotations

import os
import signal
import time
from contextlib import closing

import pytest

from solvers.workers.pool import WorkerPool
from solvers.workers.processes import ProcessDied, TookTooLong
from tests.processes import until

WORK = f"{__name__}:work"


def work(question, answer):
    """What a process does: answer its number so many times, after so many seconds."""
    for k in range(question.get("answers", 1)):
        answer({"process": os.getpid(), "k": k})
    time.sleep(question.get("seconds", 0))
    if "status" in question:
        os._exit(question["status"])


def test_questions_are_answered_in_their_order_by_the_process_that_is_warm():
    with closing(WorkerPool(WORK, 2)) as pool:
        found = [pool.submit({}).result()["process"] for _ in range(3)]
        assert len(set(found)) == 1 and pool.process_ids == [found[0]] and os.getpid() not in found
        heard = []
        both = [pool.submit({"answers": 3, "seconds": 0.3}, heard.append) for _ in range(2)]
        assert {one.result()["process"] for one in both} == set(pool.process_ids) and len(pool.process_ids) == 2
        assert [one.result()["k"] for one in both] == [2, 2] and sorted(message["k"] for message in heard) == [
            0, 0, 1, 1, 2, 2]


def test_a_process_that_dies_is_said_and_the_next_question_has_another():
    with closing(WorkerPool(WORK)) as pool:
        lost, after = pool.submit({"status": 3}), pool.submit({})
        with pytest.raises(ProcessDied, match="ended with status 3"):
            lost.result()
        first = after.result()["process"]
        killed = pool.submit({"seconds": 600})
        until(lambda: killed.running(), "the question is asked")
        os.kill(first, signal.SIGKILL)
        with pytest.raises(ProcessDied, match="SIGKILL"):
            killed.result()
        assert pool.submit({}).result()["process"] != first


def test_patience_is_for_one_question():
    with closing(WorkerPool(WORK)) as pool:
        with pytest.raises(TookTooLong, match=r"no answer within 0\.5 seconds"):
            pool.submit({"seconds": 600}, patience=0.5).result()
        assert pool.submit({}, patience=600).result()["k"] == 0


def test_who_fails_to_listen_learns_it_and_the_pool_goes_on():
    def fail(_):
        raise ValueError("cannot hear")

    with closing(WorkerPool(WORK)) as pool:
        with pytest.raises(ValueError, match="cannot hear"):
            pool.submit({"answers": 2, "seconds": 600}, fail).result()
        assert pool.submit({}).result()["k"] == 0


@pytest.mark.parametrize("end", [WorkerPool.kill, WorkerPool.close])
def test_who_waits_learns_of_the_end(end):
    pool = WorkerPool(WORK)
    waiting = [pool.submit({"seconds": 600}), pool.submit({}), pool.submit({})]
    until(lambda: waiting[0].running(), "work under way")
    end(pool)
    for one in (*waiting, pool.submit({})):
        with pytest.raises(ProcessDied):
            one.result()
    until(lambda: not pool.process_ids, "the process has ended")
    pool.close()
