"""A visitor's own file: read and judged in a process of its own, and taken in at the doors part by part."""

import io
import json
import os
from dataclasses import asdict, replace
from pathlib import Path
from time import monotonic
from types import SimpleNamespace

import msgspec
import numpy as np
import pytest

from app.cli import main
from app.page.features.upload.judging_process import BUSY, JudgeJob
from app.page.features.upload.judging_process import question_sentence as question
from app.page.features.upload.panel import TO_BE_READ, UploadPanel
from app.page.features.upload.uploaded_run import UploadedRun, loaded_notice
from app.page.visit.engine_links import MOST_WATCHED
from app.page.visit.status_message import Notice
from app.problems.bar.stage import BarStage
from app.viewer import upload
from solvers.judging import particle_writers
from solvers.judging.error_norms import error_magnitudes
from solvers.judging.problem_handout import exact_frame
from solvers.judging.uploaded_file_worker import LIMITS, FileSummary, JudgeFileRequest
from solvers.problems import PROBLEMS
from solvers.study.parameter_grid import task_of
from solvers.untrusted.quoting import file_name
from solvers.workers.worker_pool import Slots
from solvers.workers.worker_process import WorkerProcess
from tests.app.serving.test_messages import page_of, settle
from tests.support.hostile_files import FILES
from tests.support.processes import wait_until
from tests.support.raw_client import RawClient, unknown_widget_id

QUICK = {"bar": ["--cells", "20", "--periods", "1"], "ring": ["--cells", "12", "--periods", "0.5"],
         "vortex": ["--cells", "24", "--periods", "0.25"]}


@pytest.fixture(scope="module")
def process():
    """The process that reads files: one for all that is asked here."""
    worker = WorkerProcess("solvers.judging.uploaded_file_worker:judge_in_worker")
    yield worker
    worker.close()


def shown_of(process, file, scene, folder, name="mine", chosen=False):
    """What the process says of a file, as one dictionary, and where its table is."""
    table = Path(folder) / "table"
    question = JudgeFileRequest(str(file), name, task_of(scene).to_dict(), str(table), MOST_WATCHED, chosen)
    answers = {}
    for answer in process.ask(asdict(question)):
        answers |= answer
    return answers, table


def run_of(process, file, scene, folder, name="mine"):
    """The run on the stage that comes of a file, estimated; and all that the process says of it."""
    answers, table = shown_of(process, file, scene, folder, name)
    run = UploadedRun(name, FileSummary(**answers["frames"]), table)
    run.add_estimate(answers["estimate"])
    return run, answers


@pytest.mark.parametrize("problem", ["bar", "ring", pytest.param("vortex", marks=pytest.mark.slow)])
def test_a_run_of_ours_is_shown_with_its_own_errors(problem, process, tmp_path):
    """Norms to rounding, as those of the judge; what is drawn in single precision."""
    file, report = tmp_path / "run.npz", tmp_path / "run.json"
    assert main(["run", problem, *QUICK[problem], "--particles", str(file), "--json", str(report), "--quiet"]) == 0
    error = json.loads(report.read_text())["error"]
    scene = PROBLEMS[problem].scene()
    run, answers = run_of(process, file, scene, tmp_path, "run.npz")
    assert run.scene.cells == int(QUICK[problem][1]) != scene.cells  # the file says it
    for q in ("x", "v", "sigma"):
        assert run.true[q][1:].max() == pytest.approx(error[q]["max"], rel=1e-12)
        assert run.true[q][-1] == pytest.approx(error[q]["final"], rel=1e-12)
        _, arrays = run.frame(len(run) - 1, q, False)
        drawn = run.view(arrays, q, False).right.sizes
        assert np.sqrt(np.mean(drawn.astype(float) ** 2)) == pytest.approx(error[q]["final"], rel=1e-6)
        assert run.series[f"companion/index_{q}"][-1] == pytest.approx(1, abs=1e-3)
        if problem == "bar":  # what the field plot shows, and what of it is missing to the exact curve
            assert np.isfinite(arrays.plotted).all()
            slack = 1e-5 * drawn + 1e-6 * np.abs(arrays.plotted[:, 0]).max()
            assert (np.abs(arrays.plotted[:, 1]) <= drawn + slack).all()
    assert answers["verdict"]["neighbour_gap"] is None and answers["verdict"]["files"] == ["run.npz"]


def test_a_file_of_another_problem_is_asked_about_and_one_that_says_its_scene_is_judged_with_it(process, tmp_path):
    """A ring's on the page of a bar; what its owner chooses holds against what it says."""
    bar, ring = PROBLEMS["bar"].scene(), PROBLEMS["ring"].scene(cells=12, amplitude=0.02)
    frames = [exact_frame(ring, 0.1 * ring.period)]
    theirs, ours, liar = (tmp_path / name for name in ("theirs.csv", "ours.npz", "liar.npz"))
    columns = particle_writers.frame_columns(frames)
    theirs.write_bytes(particle_writers.csv_text({name: columns[name] for name in ("t", "id", "x", "y")},
                                                 {"cells": 12}))
    ours.write_bytes(particle_writers.npz_bytes(frames, ring))
    liar.write_bytes(particle_writers.npz_bytes([exact_frame(bar, 0.1)], replace(ring, cells=bar.cells)))
    answers, _ = shown_of(process, theirs, bar, tmp_path)
    assert answers == {"asks": {"reason": "has positions in two directions, and the bar has one",
                                "problems": ["square", "ring", "vortex"]}}
    assert question("r.csv", **answers["asks"]) == (
        "The file r.csv has positions in two directions, and the bar has one. Is it of the axis-aligned "
        "square, the expanding ring or the generalized vortex?")
    answers, _ = shown_of(process, theirs, PROBLEMS["ring"].scene(amplitude=0.02), tmp_path, chosen=True)
    assert max(answers["frames"]["norms"]["x"]) < 1e-12
    run, _ = run_of(process, ours, bar, tmp_path, "ours.npz")
    assert run.scene.problem == "ring" and run.scene.amplitude == 0.02 and run.true["x"].max() < 1e-12
    assert (
        loaded_notice(run, PROBLEMS["ring"].scene(cells=12))
        == "The file ours.npz is on the stage, judged with A = 20 mm."
    )
    assert loaded_notice(run, PROBLEMS["ring"].scene(cells=12, amplitude=0.02)) == "The file ours.npz is on the stage."
    answers, _ = shown_of(process, liar, bar, tmp_path)
    assert answers["asks"]["problems"] == ["bar"]
    assert "is a file of the ring, and has" in answers["asks"]["reason"]
    answers, _ = shown_of(process, liar, bar, tmp_path, chosen=True)
    assert max(answers["frames"]["norms"]["x"]) < 1e-12


def test_the_field_of_exact_particles_is_on_the_exact_curve(process, tmp_path):
    """That of the stage's own plot, in single precision."""
    scene = PROBLEMS["bar"].scene(cells=12)
    t = 0.3 * scene.period
    frame = exact_frame(scene, t)
    file = tmp_path / "exact.csv"
    file.write_bytes(particle_writers.csv_text(particle_writers.frame_columns([frame])))
    run, _ = run_of(process, file, scene, tmp_path)
    at = frame.material_position[:, 0]
    for q in ("x", "v", "sigma"):
        _, arrays = run.frame(0, q, False)
        curve = BarStage.PLOT.exact(scene, q, at, t)
        assert arrays.plotted[:, 0] == pytest.approx(curve, abs=1e-6 * np.abs(curve).max())
        assert np.abs(arrays.plotted[:, 1]).max() < 1e-9 * np.abs(curve).max()


def test_where_no_solution_is_known_the_companion_alone_is_shown(process, tmp_path):
    scene = PROBLEMS["ring"].scene(cells=12, body_force="two-tone")
    frame = exact_frame(replace(scene, body_force="material"), 0.001)
    file = tmp_path / "mine.csv"
    bare = replace(frame, stress=None, deformation_gradient=None)
    file.write_bytes(particle_writers.csv_text(particle_writers.frame_columns([bare])))
    run, _ = run_of(process, file, scene, tmp_path)
    assert run.true is None and run.missing == ["sigma"]
    _, arrays = run.frame(0, "x", False)
    view = run.view(arrays, "x", False)
    assert view.right.sizes is None and "no exact solution" in view.right.silence
    assert np.isfinite(view.left.sizes).all() and run.estimate["x"][0] > 0
    assert run.view(arrays, "sigma", False).left.silence == "the file has no stress"


def test_particles_that_are_not_ours_and_not_always_the_same(process, tmp_path):
    """Known by material positions: other numbers at other times."""
    scene = PROBLEMS["ring"].scene(cells=12)
    frames = [exact_frame(scene, t) for t in (0.0, 0.002)]
    few = np.arange(0, len(frames[1].number), 3)
    frames[1] = replace(frames[1], number=few, **{name: getattr(frames[1], name)[few] for name in (
        "material_position", "position", "velocity", "deformation_gradient", "stress")})
    moved = frames[1].position + np.array([1e-3, 0.0])
    frames[1] = replace(frames[1], position=moved)
    columns = particle_writers.frame_columns(frames)
    del columns["id"]
    file = tmp_path / "mine.csv"
    file.write_bytes(particle_writers.csv_text(columns))
    run, _ = run_of(process, file, scene, tmp_path)
    assert [run.particle_count(0), run.particle_count(1)] == [len(frames[0].number), len(few)]
    _, arrays = run.frame(1, "x", False)
    assert arrays.position == pytest.approx(moved, abs=1e-6)
    assert arrays.error[:, 0] == pytest.approx(np.full(len(few), 1e-3), rel=1e-4)
    assert error_magnitudes(arrays.position - arrays.displacement - frames[1].material_position).max() < 1e-6


def npz(**arrays):
    out = io.BytesIO()
    np.savez_compressed(out, **arrays)
    return out.getvalue()


MANY = np.zeros((LIMITS.times + 1, 1, 1))
#: What the page alone refuses; what any judge does is in tests/solvers/judging/test_hostile_files.py.
BAD = [("columns.csv", b"a,b\n1,2\n", "holds no particles that are known by name"),
       ("cells.csv", b"# cells = 50000\nid,x,t\n0,0,0\n", "too many to watch"),
       ("times.npz", npz(t=np.arange(LIMITS.times + 1.0), id=np.arange(1), x=MANY),
        "has 2,001 times; give at most 2,000"),
       ("rows.npz", npz(t=np.array(0.0), x=np.zeros(LIMITS.rows + 1)), "2,000,001 particles of all times together"),
       ("late.csv", FILES["late.csv"], "has the time 1e+06 s, to which the companion")]


@pytest.mark.parametrize(("name", "content", "said"), BAD, ids=[name for name, *_ in BAD])
def test_a_bad_file_is_refused_in_one_sentence(name, content, said, process, tmp_path):
    """By the name that its owner knows, and the process goes on."""
    file = tmp_path / f"particles{Path(name).suffix}"
    file.write_bytes(content)
    before = process.process_id
    answers, _ = shown_of(process, file, PROBLEMS["bar"].scene(), tmp_path, name)
    assert list(answers) == ["refused"]
    assert said in answers["refused"] and answers["refused"].startswith(f"The file {name} ")
    assert str(tmp_path) not in answers["refused"] and "\n" not in answers["refused"]
    assert before in (None, process.process_id)


def test_memory_of_the_process_is_limited(process, tmp_path):
    """A page of XML that unpacks to whatever it likes ends in a sentence."""
    if not os.path.exists("/proc/self/limits"):
        pytest.skip("memory is limited on Linux only")
    shown_of(process, tmp_path / "none.csv", PROBLEMS["bar"].scene(), tmp_path)
    [line] = [line for line in Path(f"/proc/{process.process_id}/limits").read_text().splitlines()
              if line.startswith("Max address space")]
    assert line.split()[3] == "3000000000"


def test_a_file_that_takes_too_long_or_is_not_wanted_any_more_ends_its_process(tmp_path, monkeypatch):
    monkeypatch.setattr("app.page.features.upload.judging_process.PATIENCE", 0.05)
    heard = []
    file = tmp_path / "coming"
    file.write_bytes(b"x")
    judging = JudgeJob("a.csv", file, PROBLEMS["bar"].scene(), lambda _, message: heard.append(message))
    wait_until(lambda: heard, "a sentence")
    assert heard[0]["refused"].startswith("The file a.csv takes more than")
    file.write_bytes(b"x")
    cancelled = JudgeJob("a.csv", file, PROBLEMS["bar"].scene(), lambda _, message: heard.append(message))
    cancelled.cancel()
    wait_until(lambda: judging.process_id is None and cancelled.process_id is None, "both processes have ended")
    assert len(heard) == 1


def test_a_server_that_judges_enough_says_so(tmp_path):
    """And a place that was taken is given back."""
    heard, slots = [], Slots(1)
    assert slots.acquire()
    file = tmp_path / "coming"
    file.write_bytes(b"id,x\n")
    JudgeJob("a.csv", file, PROBLEMS["bar"].scene(), lambda _, message: heard.append(message), slots)
    wait_until(lambda: heard == [{"refused": BUSY}], "a sentence")
    slots.release()
    file.write_bytes(b"id,x\n")
    JudgeJob("a.csv", file, PROBLEMS["bar"].scene(), lambda _, message: heard.append(message), slots)
    wait_until(lambda: "holds no particles" in heard[-1]["refused"] and slots.taken == 0, "another, and a free place")


@pytest.mark.parametrize(("name", "said"), [
    ("/etc/passwd", "passwd"), ("..\\..\\x.csv", "x.csv"), ("a\nb\u202ec.csv", "a\\nb\\u202ec.csv"), ("", "the file"),
    ("x" * 500 + ".csv", "x" * 30 + "…" + "x" * 25 + ".csv")])
def test_names_of_files_are_shown_plainly(name, said):
    assert file_name(name) == said


@pytest.fixture
def arrived(monkeypatch):
    """What comes through the doors: name and content of each file; and what is refused in words."""
    files, refused = [], []
    monkeypatch.setattr(UploadPanel, "_on_file", lambda _, name, file: files.append((name, file.read_bytes())))
    monkeypatch.setattr(UploadPanel, "_refuse", lambda _, sentence: refused.append(sentence))
    return files, refused


class Sender:
    """A visitor without a browser who sends files, as the viewer's page does or otherwise."""

    def __init__(self, visitor):
        self.visitor, self.box = visitor, visitor.find("file of particles")

    def start(self, size, name="mine.csv", transfer="t1", **other):
        self.visitor.send({"type": upload.START, "source_component_uuid": self.box, "transfer_uuid": transfer,
                           "filename": name, "mime_type": "", "part_count": -(-size // upload.PART_BYTES),
                           "size_bytes": size} | other)

    def part(self, index, content, transfer="t1", **other):
        self.visitor.send({"type": upload.PART, "source_component_uuid": self.box, "transfer_uuid": transfer,
                           "part_index": index, "content": content} | other)


@pytest.fixture
def sender(here, arrived):
    with RawClient(here[1]) as one:
        one.find("Download CSV")  # the last of its controls
        yield Sender(one)


def test_a_file_comes_part_by_part(here, sender, arrived):
    """In the middle of other messages; and another after it, and an empty one."""
    content = os.urandom(2 * upload.PART_BYTES + 77)
    sender.start(len(content))
    for k in range(3):
        sender.part(k, content[k * upload.PART_BYTES:(k + 1) * upload.PART_BYTES])
        settle(here[0], sender.visitor)
    wait_until(lambda: len(arrived[0]) == 1, "the file")
    sender.start(3, "other.npz", "t2")
    sender.part(0, b"abc", "t2")
    sender.start(0, "none.csv", "t3")
    wait_until(lambda: len(arrived[0]) == 3, "the others")
    assert arrived == ([("mine.csv", content), ("other.npz", b"abc"), ("none.csv", b"")], [])
    wait_until(lambda: sender.visitor.kinds["FileTransferPartAck"] >= 3, "the browser is told of each")
    assert sender.visitor.closed is None


def test_what_is_no_file_is_refused_and_harms_nobody(here, sender, arrived):
    """Too large, too many, out of order, of other lengths, for other widgets, and in other words than a browser's: what
    was on its way comes all the same, the viewer holds nothing, and another visitor notices nothing."""
    one, raw = here[0], sender.visitor
    first, last = os.urandom(upload.PART_BYTES), b"end"
    whole = len(first) + len(last)
    with RawClient(here[1]) as neighbour:
        neighbour.find("Download CSV")
        sender.part(0, b"of nothing")
        sender.start(upload.LARGEST + 1)
        sender.start(2**53)
        for count in (0, 1, 3, 2**40):
            sender.start(whole, part_count=count)
        sender.start(-1)
        sender.start(10.5)
        sender.start(whole, filename="x" * 1001)
        sender.start(whole, filename=None)
        sender.start(whole, source_component_uuid=unknown_widget_id())
        sender.start(whole, source_component_uuid=raw.find("Choose a file"))
        sender.start(whole, more=1)
        settle(one, raw)
        sender.start(whole)
        sender.start(whole, transfer="t2")  # while one is on its way
        sender.part(1, last)
        sender.part(-1, last)
        sender.part(0, first[:-1])
        sender.part(0, first, transfer="t2")
        sender.part(0, first, source_component_uuid=raw.find("Choose a file"))
        sender.part(0, "text")
        settle(one, raw)
        sender.part(0, first)
        sender.part(0, first)
        sender.part(2, last)
        turned = {"part_index": 1, "type": upload.PART, "source_component_uuid": sender.box, "transfer_uuid": "t1",
                  "content": last}
        raw.send(turned)  # fields in another order
        raw.send(msgspec.msgpack.encode({"type": upload.PART})[:-1] + b"\x91" * 400_000)
        settle(one, raw)
        assert arrived[0] == []
        sender.part(1, last)
        wait_until(lambda: arrived[0], "the file")
        assert arrived[0] == [("mine.csv", first + last)] and arrived[1] == [upload.TOO_LARGE] * 2
        assert neighbour.closed is None
        for client in one._connected_clients.values():
            assert client.gui._current_file_upload_states == {}
            boxes = [h for h in client.gui._gui_input_handle_from_uuid.values() if upload.uploads_of_button(h)]
            assert [box.value.content for box in boxes] == [b""]


def test_nothing_of_a_file_stays_when_its_visitor_has_gone(here, arrived):
    with RawClient(here[1]) as raw:
        raw.find("Download CSV")
        sender = Sender(raw)
        [box] = [h for h in page_of(here[0]).values() if upload.uploads_of_button(h)]
        folder = upload.uploads_of_button(box).folder
        sender.start(2 * upload.PART_BYTES)
        sender.part(0, bytes(upload.PART_BYTES))
        wait_until(lambda: (folder / "coming").exists(), "the beginning of a file")
    wait_until(lambda: not folder.exists(), "its folder has gone")


@pytest.mark.parametrize("age, untouched, shown", [(2.0, 5.0, True), (2.0, 1.0, False), (TO_BE_READ + 1, 60.0, False)])
def test_what_is_said_of_a_file_ends_with_the_next_act(age, untouched, shown):
    """A refusal of something else, or that a run is lost, is not hidden behind it."""
    said = Notice("refused", "A file that is none.")
    panel = SimpleNamespace(_judging=None, _news=(monotonic() - age, said), _upload=SimpleNamespace(progress_text=""),
                            _session=SimpleNamespace(idle_seconds=untouched))
    assert UploadPanel.notice(panel) is (said if shown else None)
