"""The pool of worker processes: one queue, futures, what is heard on the way, and every way to end."""

import os
import signal
import time
from contextlib import closing

import pytest

from solvers.workers.worker_pool import WorkerPool, one_of_each_first
from solvers.workers.worker_process import ProcessDied, WorkerTimeout
from tests.support.processes import wait_until

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
        heard = []
        killed = pool.submit({"seconds": 600}, heard.append)
        wait_until(lambda: heard, "the question has reached the process")
        os.kill(first, signal.SIGKILL)
        with pytest.raises(ProcessDied, match="SIGKILL"):
            killed.result()
        assert pool.submit({}).result()["process"] != first


def test_patience_is_for_one_question():
    with closing(WorkerPool(WORK)) as pool:
        with pytest.raises(WorkerTimeout, match=r"no answer within 0\.5 seconds"):
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
    wait_until(lambda: waiting[0].running(), "work under way")
    end(pool)
    for one in (*waiting, pool.submit({})):
        with pytest.raises(ProcessDied):
            one.result()
    wait_until(lambda: not pool.process_ids, "the process has ended")
    pool.close()


def kinds(asked, processes, several=1):
    """Which kinds each process has had, of questions of these kinds that take so many seconds, and in which order."""
    with closing(WorkerPool(WORK, processes, several=several)) as pool:
        found = [(kind, pool.submit({"seconds": seconds}, kind=kind)) for kind, seconds in asked]
        had: dict[int, list[str]] = {}
        for kind, one in found:
            had.setdefault(one.result()["process"], []).append(kind)
    return had


def test_a_process_goes_on_with_the_kind_that_it_has_had():
    """Two processes begin with a kind each, and go on with it though both come in turns."""
    had = kinds([("a", 0.5), ("b", 0.5), *[("a", 0.3), ("b", 0.3)] * 3], 2)
    assert sorted(one[:3] for one in had.values()) == [["a"] * 3, ["b"] * 3]


def test_a_process_helps_with_another_kind_rather_than_rest():
    assert len(kinds([("a", 0.3), ("a", 0.3)], 2)) == 2
    assert len(kinds([("a", 0.3), ("a", 0.0)], 2, several=3)) == 1  # the one who knows how is done with it sooner
    assert len(kinds([("a", 0.3)] * 6, 2, several=3)) == 2


def test_one_of_each_kind_is_put_first():
    assert one_of_each_first(["a1", "a2", "b1", "a3", "c1", "b2"], lambda text: text[0]) == [
        "a1", "b1", "c1", "a2", "a3", "b2"]


def test_questions_of_no_kind_are_done_by_all():
    assert len(kinds([(None, 0.3), (None, 0.3)], 2)) == 2
