"""Exported files: recordings keep a run's numbers as well as they say, the file stays small, bad input is told; and a
package for a course's own system: what names its parts is as the standard has it; the same lessons, the same bytes."""

from __future__ import annotations

import base64
import hashlib
import io
import json
import re
import zipfile
import zlib
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest

from app import shareable_state
from app.cli import main
from app.export import slider_grid, stage_export_plan
from app.export.html_file import _page_title, scene_page
from app.export.lesson_export import lesson_page, make_scorm_package, marking_rules, scorm_manifest
from app.export.recording import RecordingRequest, record_scene
from app.export.recording_compression import NONE, NUMBER, PLACE, SIGNED, SIZE, TOPS, Track, pack_tracks
from app.frame.stage import marking_stride
from app.lessons.lesson_parser import parse_lesson
from app.problems.views import VIEWS
from solvers.problems.planar.particle_layout import particle_layout
from solvers.scene.error_causes import FIELDS
from tests.app.lessons.test_lesson_format import TEXT

BAR = "bar cells=10 periods=0.25 estimators=recovered,transport"
RING = "ring cells=12 periods=0.25 cfl=0.2"
VORTEX = "vortex cells=12 ppc=2 t-end=0.1"
ALL = ("x", "v", "sigma", "a")


def tracks(headers: list[dict], data: bytes) -> dict[str, np.ndarray]:
    """The player's half: numbers of all tracks by their names."""
    raw, at, found = zlib.decompress(data), 0, {}

    def take(count: int, kind: str) -> np.ndarray:
        nonlocal at
        part = np.frombuffer(raw, kind, count, at)
        at += part.nbytes
        return part

    for header in headers:
        kind, shape = header["kind"], (header["rows"], header["width"])
        if kind == NUMBER:
            found[header["name"]] = take(shape[0] * shape[1], "<f4").reshape(shape)
            continue
        scales = take(1 if kind == PLACE else shape[0], "<f4").reshape(-1, 1)
        steps = take(shape[0] * shape[1], "u1").reshape(shape).astype(int)
        if kind == PLACE:
            steps = steps + 256 * take(shape[0] * shape[1], "u1").reshape(shape).astype(int)
        codes = np.cumsum(steps, axis=0) % (65536 if kind == PLACE else 256)
        codes = codes if kind == SIZE else codes.astype(np.int16 if kind == PLACE else np.int8)
        found[header["name"]] = np.where(codes == NONE[kind], np.nan, codes * (scales.astype(float) / TOPS[kind]))
    assert at == len(raw)
    return found


def decoded(recorded: dict) -> dict[str, np.ndarray]:
    return tracks(recorded["tracks"], base64.b64decode(recorded["data"]))


def near(found: np.ndarray, expected: np.ndarray, share: float) -> bool:
    """Whether numbers are off by no more than a share of the largest."""
    return np.abs(found - expected).max() <= share * np.abs(expected).max() * (1 + 1e-5)


@pytest.mark.parametrize("kind, share", [(SIZE, 1 / 508), (SIGNED, 1 / 254), (PLACE, 1 / 65534)])
def test_a_track_is_as_exact_as_it_says(kind, share):
    values = np.random.default_rng(1).normal(size=(7, 50)) * 10.0 ** np.arange(-3, 4)[:, None]
    values = np.abs(values) if kind == SIZE else values
    values[3, 5], values[4, 6] = np.nan, np.inf
    track = Track("it", kind, values)
    found = tracks([track.header], pack_tracks([track]))["it"]
    known = np.isfinite(values)
    assert (np.isnan(found) == ~known).all()
    largest = np.abs(np.where(known, values, 0)).max(axis=None if kind == PLACE else 1, keepdims=True)
    assert (np.abs(np.where(known, found - values, 0)) <= share * largest * (1 + 1e-5)).all()


@pytest.mark.parametrize("kind", [SIZE, SIGNED, PLACE, NUMBER])
def test_a_track_of_a_run_gone_bad_is_written(kind):
    """Numbers beyond what 32 bits hold, and below: no warning, what is a number stays one, large ones stay large."""
    values = np.array([[1e300, 2.0, np.nan, np.inf], [3e-45, 2e-45, 0.0, 1e-300], [1e39, 1e31, 1.0, 1e-39]])
    track = Track("it", kind, values)
    with np.errstate(all="raise"):
        found = tracks([track.header], pack_tracks([track]))["it"].astype(float)
    assert (np.isnan(found) == (np.isnan(values) | (np.isinf(values) & (kind != NUMBER)))).all()
    assert found[0, 0] > 1e29 and found[2, 0] > 1e29 and (found[1, [0, 1]] >= 0).all()
    assert np.nanmax(found[1]) < 1e-43 and found[2, 2] < 2e28


@pytest.mark.parametrize("text, heading", [
    ("bar motion=patch cells=10 periods=0.1", "Patch test of the bar"), ("bar cells=10 periods=0.1", "Vibrating bar"),
    ("ring cells=12 periods=0.02", "Expanding ring")])
def test_a_file_is_titled_by_what_it_shows(text, heading):
    assert _page_title(stage_export_plan.make_export_plan(shareable_state.parse_state(text), (), ("x",))) == heading


def test_zeros_and_nothing_stay_what_they_are():
    for values in (np.zeros((3, 4)), np.empty((0, 1)), np.full((2, 2), np.nan)):
        track = Track("it", SIZE, values)
        found = tracks([track.header], pack_tracks([track]))["it"]
        assert np.array_equal(found, values, equal_nan=True)


@pytest.mark.parametrize("text", [BAR, RING, VORTEX])
def test_a_recording_holds_the_numbers_of_the_run(text, simulate):
    scene = shareable_state.parse_state(text).scene
    result, made = simulate(scene), record_scene(RecordingRequest(text, 9, 1000, ALL))
    found, head = decoded(made), made["head"]
    assert (head["status"], head["steps"], head["shown"]) == ("ok", scene.steps, result.particles)
    assert len(found["time"]) == 9 and found["time"][-1] == pytest.approx(result.time)
    assert near(found["position"][-1], result.final.position.T.ravel(), 1 / 65534)
    for k, key in enumerate(ALL):
        sizes = np.abs(found[f"{'deviation' if scene.DIMENSIONS == 1 else 'error'}.{key}"])[-1]
        assert near(sizes, np.abs(result.final.error[:, k]), 1 / 254)
        assert found["norm.true"][-1, k] == pytest.approx(result.series[f"error_{key}"][-1], rel=1e-6)
        for name in scene.active_estimators:
            size = np.abs(result.final.estimate[name][:, k])
            assert near(found[f"estimate.{name}.{key}"][-1], size, 1 / 508) or not np.isfinite(size).all()
            index = result.index[name][key]
            assert index is None or found[f"index.{name}"][-1, k] == pytest.approx(index, rel=1e-5)
    crossed = found["crossings.who"].round().astype(int)[:, 0]
    every = marking_stride(len(result.final.position), VIEWS[scene.problem].stage.MOST_MARKED)
    assert set(crossed) == {p for p in np.flatnonzero(result.final.last_crossing > 0) if p % every == 0} != set()
    assert (np.diff(found["crossings.time"][:, 0]) >= 0).all()


def test_who_made_the_error_is_kept_where_the_run_has_it(simulate):
    """The shares are those of the run, and the parts of each picture add up to its error; elsewhere nothing is kept."""
    text = "bar cells=10 periods=0.25 estimators=none effects=truth,budget"
    result, made = (simulate(shareable_state.parse_state(text).scene),
                    record_scene(RecordingRequest(text, 9, 1000, ("x",))))
    found, said = decoded(made), made["head"]["budget"]
    assert said["not_valid"] is None and said["whose"] == "" and said["causes"]["crossings"] == "crossings"
    still = record_scene(RecordingRequest(f"{text},crossings amplitude=1e-3", 3, 1000, ("x",)))
    assert still["head"]["budget"]["causes"]["crossings"] == "particle sums"
    for field in FIELDS:
        assert said["shares"][field] == pytest.approx(result.budget[field], abs=1e-9)
        error, *parts = found[f"budget.{field}"].T
        assert near(error[-1:], result.series[f"budget/error_{field}"][-1:], 1 / 254)
        assert np.abs(sum(parts) - error).max() <= 5 / 254 * np.abs(found[f"budget.{field}"]).max()
    plain = record_scene(RecordingRequest(BAR, 3, 1000, ("x",)))
    assert plain["head"]["budget"] is None and not any(name.startswith("budget") for name in decoded(plain))


def test_domains_are_kept_where_they_are_asked_for():
    one, scene = RecordingRequest("ring cells=12 periods=0.1", 3, 1000, ("x",),
                                  domains=True), shareable_state.parse_state("ring cells=12").scene
    found = decoded(record_scene(one))
    half = found["edges"][0].reshape(2, 2, -1)
    undeformed = np.tile(np.eye(2), (scene.particles, 1, 1))
    edges = VIEWS["ring"].stage.half_edge_vectors(scene, undeformed)  # (P, edge, x or y)
    assert near(half, edges.transpose(1, 2, 0), 0.01) and not near(half, edges.transpose(2, 1, 0), 0.2)
    area = 4 * np.abs(half[0, 0] * half[1, 1] - half[0, 1] * half[1, 0])
    assert near(area, particle_layout(scene).volume, 0.03)
    assert "edges" not in decoded(record_scene(replace(one, domains=False)))


def test_a_run_gone_bad_ends_there_and_says_why():
    made = record_scene(RecordingRequest("bar cells=10 cfl=3 periods=2", 40, 1000, ("x",)))
    assert made["head"]["status"] == "unstable" and "went unstable at t =" in made["head"]["reason"]
    assert len(decoded(made)["time"]) < 40


def test_of_many_particles_some_are_kept():
    assert record_scene(RecordingRequest("bar cells=40 periods=0.02", 2, 100, ("x",)))["head"]["shown"] == 80
    assert record_scene(RecordingRequest("ring cells=24 periods=0.02", 2, 100, ("x",)))["head"]["shown"] == 100


@pytest.mark.parametrize("problem", ["bar", "ring"])
def test_a_lattice_has_sixty_runs_and_stays_within_the_budget(problem):
    shown = shareable_state.parse_state(f"{problem} estimators=recovered,transport")
    axes = slider_grid.axes_around(shown.scene, slider_grid.FULL)
    one = stage_export_plan.make_export_plan(shown, axes, ("x", "v", "sigma"))
    assert [len(axis.values) for axis in axes] == [5, 4, 3] and len(one.run_texts) == 60
    assert all(axis.values[axis.start] == getattr(shown.scene, axis.field) for axis in axes)
    most = next(iter(stage_export_plan.recordings_needed([one]).values())).particles
    sizes = [stage_export_plan._recording_bytes(one,
                                          min(shareable_state.parse_state(text).scene.particles,
                                              most)) for text in one.run_texts]
    assert sum(sizes) <= stage_export_plan.BUDGET


def test_what_a_lesson_names_is_on_the_sliders():
    text = "- Set **Cells** to `80`.\n- Choose **Method** `B-spline`.\n- Set **CFL number** to `0.025`.\nRead **norm**."
    axes = {
        axis.field: axis.values
        for axis in slider_grid.axes_for_instructions(shareable_state.parse_state("bar cells=20 cfl=0.4").scene, text)
    }
    assert axes == {"cells": (20, 80), "method": ("ugimp", "bspline"), "cfl": (0.025, 0.4)}


def test_what_cannot_be_says_why():
    axes = [slider_grid.SliderAxis("method", ("cpgimp", "ugimp"), 0)]
    texts = list(slider_grid.scene_texts(shareable_state.parse_state("bar method=cpgimp velocity=corners").scene, axes))
    assert texts[0].startswith("bar;") and texts[1].startswith("!moves the corners")


def test_a_file_is_small_and_asks_nobody_for_anything():
    page = scene_page(f"{BAR};error-of=a", 1, lambda part, what: None, {"cells": 2})
    assert len(page.encode()) < 1_000_000
    [script] = re.findall(r"<script>(.*?)</script>", page, re.DOTALL)
    own = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    assert f"default-src 'none'; style-src 'unsafe-inline'; script-src 'sha256-{own}';" in page
    assert "<title>Vibrating bar</title>" in page and "<h1>Vibrating bar</h1>" in page
    assert not re.findall(r"(?:src|href|url\()\s*=?\s*[\"']?(?:https?:)?//", page)
    data = json.loads(re.search(r"id=\"data\">(.*?)</script>", page, re.DOTALL)[1])
    assert len(data["runs"]) == 2 and data["stages"][0]["quantities"] == ["x", "v", "sigma", "a"]


def test_what_is_right_is_known_for_every_variant():
    found = marking_rules(parse_lesson(TEXT, "99-test"), 1, lambda part, what: None)
    assert [rule["options"] for rule in found["what-happens"]] == [[2], [2]]
    first, second = (rule["value"] for rule in found["and"])
    assert 0 < first < second


HEAD = '+++\ntitle = "<Öl> & \\"Wasser\\""\ngoals = ["see"]\n+++\n\nBegin.\n'
READ = parse_lesson(HEAD + "\n## Explain: Only read\n\nNothing is asked.\n", "10-read")
LESSONS = [READ, replace(READ, name="11 zwei&drei", fingerprint="f" * 64)]
IMS, ADL = "{http://www.imsproject.org/xsd/imscp_rootv1p1p2}", "{http://www.adlnet.org/xsd/adlcp_rootv1p2}"


def silent(part, what):
    """Nobody looks at the progress."""


@pytest.fixture(scope="module")
def archive():
    made = make_scorm_package(LESSONS, 1, silent)
    assert made == make_scorm_package(LESSONS, 1, silent)
    with zipfile.ZipFile(io.BytesIO(made)) as files:
        yield files


def test_the_manifest_names_every_page_as_the_standard_has_it(archive):
    root = ElementTree.fromstring(archive.read("imsmanifest.xml"))
    assert root.tag == f"{IMS}manifest"
    assert [part.tag for part in root] == [f"{IMS}{name}" for name in ("metadata", "organizations", "resources")]
    said = {part.tag: part.text for part in root[0]}
    assert said == {f"{IMS}schema": "ADL SCORM", f"{IMS}schemaversion": "1.2"}
    (organization,), resources = root[1], {one.get("identifier"): one for one in root[2]}
    assert root[1].get("default") == organization.get("identifier")
    assert organization[0].tag == f"{IMS}title"
    items = organization.findall(f"{IMS}item")
    assert [item.find(f"{IMS}title").text for item in items] == ['<Öl> & "Wasser"'] * 2
    pages = [resources[item.get("identifierref")] for item in items]
    assert [(one.get("type"), one.get(f"{ADL}scormtype")) for one in pages] == [("webcontent", "sco")] * 2
    assert [one.get("href") for one in pages] == ["10-read.html", "11%20zwei%26drei.html"]
    assert all(one.find(f"{IMS}file").get("href") == one.get("href") for one in pages)
    assert archive.namelist() == ["imsmanifest.xml", "10-read.html", "11 zwei&drei.html"]
    identifiers = [one.get("identifier") for one in root.iter() if one.get("identifier")]
    assert len(set(identifiers)) == len(identifiers) and all(
        name[0].isalpha() and not set(name) & set(" &/:") for name in identifiers)


def test_a_lesson_that_has_changed_is_another_package():
    one, other = (scorm_manifest([replace(READ, fingerprint=letter * 64)]) for letter in "ab")
    assert "mpm-lab-10-read-aaaaaaaaaaaa" in one and "mpm-lab-10-read-bbbbbbbbbbbb" in other


def test_only_a_package_speaks_to_a_system(archive):
    page, plain = archive.read("10-read.html").decode(), lesson_page(READ, 1, silent)
    assert "LMSInitialize" in page and "LMSInitialize" not in plain
    heads = [re.sub(r"'sha256-[^']+'", "", text.partition("<script>")[0]) for text in (page, plain)]
    assert heads[0] == heads[1], "as strict a policy, and the same page"


def test_several_lessons_are_packed_once_each(capsys, monkeypatch, tmp_path):
    asked = []
    monkeypatch.setattr("app.export.lesson_export.make_scorm_package", lambda lessons, *others,
                        core: asked.extend(lessons) or b"PK")
    assert main(["export", "1", "04", "1", "--scorm", "--quiet", "--out", str(tmp_path / "a.zip")]) == 0
    assert [lesson.name for lesson in asked] == ["01-one-step", "04-grid-crossing"]
    assert (tmp_path / "a.zip").read_bytes() == b"PK"


def test_a_value_may_cost_as_much_as_the_scene_that_was_asked_for(monkeypatch):
    """However much that is; a dearer one only up to what is allowed beside it."""
    scene = shareable_state.parse_state("bar cells=20").scene
    for most, values in ((0.0, (10, 20)), (1e12, (10, 20, 40))):
        monkeypatch.setattr(slider_grid, "MOST_WORK", most)
        assert slider_grid.axis_through(scene, "cells", (10, 40), 3).values == values
