"""Runs of visitors' bodies on one server: how many run at once, and who waits."""

from concurrent.futures import Future
from pathlib import Path

import pytest

from app.page.features.body import body_runs
from app.page.features.body.body_runs import BUSY, BodyRuns, BodySource
from solvers.bodies.body_file import library_text, parse_body, read_body
from solvers.untrusted.quoting import FileError
from solvers.workers.worker_pool import Slots
from solvers.workers.worker_process import ProcessDied

SOURCE = BodySource(Path("mine.toml"), "mine")


class Pool:
    """Answers nothing by itself."""

    def __init__(self, _):
        self.futures = []

    def submit(self, *_):
        self.futures.append(Future())
        return self.futures[-1]

    def lower_priority(self):
        """There is no process."""

    def kill(self):
        for future in self.futures:
            if not future.done():
                future.set_exception(ProcessDied("has ended"))


@pytest.fixture
def visitors(monkeypatch):
    """Two visitors of a server with one slot: runs and messages of each."""
    monkeypatch.setattr(body_runs, "SLOTS", Slots(1))
    monkeypatch.setattr(body_runs, "WorkerPool", Pool)
    return [(BodyRuns(lambda source, table, message, said=said: said.append(message)), said) for said in ([], [])]


def refused(runs, said):
    said.clear()
    runs.begin(SOURCE)
    return said == [{"refused": BUSY}]


def test_another_visitor_waits_only_while_the_first_computes(visitors):
    """Also while a run that has been replaced by another is about to end; the same visitor never waits."""
    (first, said), (second, heard) = visitors
    assert not refused(first, said)
    assert refused(second, heard)
    assert not refused(first, said)
    replaced, present = first._pool.futures
    replaced.set_result({})
    assert refused(second, heard)
    present.set_result({})
    assert not refused(second, heard)
    assert refused(first, said)


def test_who_leaves_frees_the_slot(visitors):
    (first, said), (second, heard) = visitors
    assert not refused(first, said)
    first.close()
    assert not refused(second, heard)
    assert said == []  # nobody is there to hear of it


def test_an_uploaded_file_is_read_after_the_next_has_come(visitors, tmp_path):
    """And one that is too long is refused for that."""
    (runs, _), upload = visitors[0], tmp_path / "upload"
    upload.write_text(library_text("cantilever"), encoding="utf-8")
    mine = runs.take_file(upload)
    upload.write_bytes(b"# more\n" * 200_000)
    assert read_body(str(mine)) == parse_body(library_text("cantilever"))
    with pytest.raises(FileError, match="is longer than 100,000 bytes"):
        read_body(str(runs.take_file(upload)))
