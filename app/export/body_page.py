"""An exported file with a body's run: its particles in the colours of their estimated errors, and a goal in its bar."""

import base64
import tempfile
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from app.export.html_file import USUAL, render_player
from app.export.player_display_data import LATER, ROOMS, shared_display_data
from app.export.recording import select_particles
from app.export.recording_compression import NUMBER, PLACE, SIZE, Track, pack_tracks
from app.frame.body_drawing import NO_TRUTH, estimate_note, unit_of_scale
from app.frame.body_sentences import body_facts, body_headline, body_name, estimate_rows, goal_rows
from app.frame.body_stage import AROUND, DIAMETER, MOST_LINES, body_labels, body_placement, stage_height
from app.frame.goal_curve import round_levels
from app.frame.layout import colour_bar_box, colour_bar_labels
from app.frame.primitives import StageMetrics
from app.frame.shown_body import BodySource, ShownBody
from app.frame.value_and_bar import in_one_unit
from app.language.translation import tr, translate_message
from solvers.bodies.body import MOST_PARTICLES
from solvers.bodies.body_run_worker import BodyRunRequest, run_in_worker
from solvers.scene.estimator_registry import COMPANION
from solvers.untrusted.quoting import file_name

SCRIPTS = ("words", "tracks", "frame", "colours", "stage", "controls", "body", "main")
MOST = 6000  # particles recorded
SPEED = 0.15  # of the run's length in a second


def body_page(path: str, on_progress: Callable[[float], None]) -> str:
    """Returns the html of an offline page with the run of the body in the file at ``path``; runs it in this process.
    Raises ValueError, with a sentence, for a body without a run."""
    with tempfile.TemporaryDirectory() as folder:
        body = _run(path, Path(folder) / "table", on_progress)
        tracks = _tracks(body)
        head = _head(body, tracks)
    scene = {"rooms": {name: _layout(body, metrics.rounded()) for name, metrics in ROOMS.items()}}
    texts = {quantity: {"rows": {}, "field": {}, "by": {COMPANION: {"captions": [{}], "errors": {
        "size": unit_of_scale(body, quantity), "absolute": True}}}} for quantity in USUAL}
    view = {"quantity": USUAL[0], "difference": False, "logarithmic": False, "speed": SPEED, "estimator": COMPANION}
    plan = {"axes": [], "runs": [0], "says": [""], "pinned": None, "quantities": USUAL, "estimators": (COMPANION,),
            "keeps_its_speed": True, "view": view}
    data = {**shared_display_data(()), "problems": {"body": scene}, "stages": [plan], "lesson": None, "texts": [texts],
            "runs": [{"head": head, "texts": 0, "tracks": [track.header for track in tracks]}]}
    return render_player(body.source.name, data, [base64.b64encode(pack_tracks(tracks)).decode()], SCRIPTS)


def _run(path: str, table: Path, on_progress: Callable[[float], None]) -> ShownBody:
    source, shown = BodySource(Path(path), file_name(path)), list[ShownBody]()

    def receive(message: dict) -> None:
        if "refused" in message:
            raise ValueError(message["refused"])
        if "begins" in message:
            shown.append(ShownBody(source, table, message["begins"]))
        elif "sample" in message:
            shown[0].add(message["sample"])
            on_progress((len(shown[0].times) - 1) / shown[0].samples)
        else:
            shown[0].result = message["ends"]

    table.touch()
    run_in_worker(asdict(BodyRunRequest(path, source.name, {}, str(table), MOST_PARTICLES)), receive)
    return shown[0]


def _tracks(body: ShownBody) -> list[Track]:
    frames = range(len(body.times))
    kept = select_particles(2, body.particles, MOST)
    tracks = [Track("time", NUMBER, np.array(body.times)[:, None]),
              Track("position", PLACE, np.stack([body.position(k)[kept].T.ravel() for k in frames]))]
    for quantity in USUAL:
        sizes = [body.believed_sizes(k, quantity) for k in frames]
        tracks.append(Track(f"estimate.{COMPANION}.{quantity}", SIZE, np.stack(
            [np.full(len(kept), np.nan) if one is None else one[kept] for one in sizes])))
    if body.goals:
        curve = body.curve(next(iter(body.goals)))
        tracks.append(Track("goal", NUMBER, np.stack([curve.values, curve.bars], axis=1)))
    return tracks


def _head(body: ShownBody, tracks: list[Track]) -> dict[str, Any]:
    """Returns a JSON object that describes the run for the player, with all texts; ``tracks`` are its own."""
    frames, headline = range(len(body.times)), body_headline(body)
    curve = body.curve(next(iter(body.goals))) if body.goals else None
    levels = round_levels(curve) if curve else []
    x0, x1, y0, y1 = body.extent
    dense = (x1 - x0 + y1 - y0) / body.spacing >= MOST_LINES
    return {"problem": "body", "extent": body.extent, "lines": 0 if dense else body.spacing,
            "shown": (shown := tracks[1].values.shape[1] // 2),
            "diameter": DIAMETER * body.width * (body.particles / shown) ** 0.5, "period": body.body["t_end"],
            "known": False, "least": {}, "name": "".join(text for _, text in body_name(body)),
            "facts": {quantity: ["".join(text for _, text in body_facts(body, k, quantity)) for k in frames]
                      for quantity in USUAL},
            "notes": {quantity: [estimate_note(body, k, quantity) for k in frames] for quantity in USUAL},
            "nobody": tr(NO_TRUTH), "summary": "".join(text for _, text in headline.spans),
            "remarks": " ".join([*(f"{text[:1].upper()}{text[1:]}." for text in map(translate_message, body.warnings)),
                                 *headline.fact_sentences]),
            "goals": goal_rows(body), "estimates": estimate_rows(body),
            "goal": curve and {"title": f"{curve.name}: {curve.symbol} {tr('and its bar')}", "levels": levels,
                               "says": in_one_unit(levels, curve.unit)}}


def _layout(body: ShownBody, metrics: StageMetrics) -> dict[str, Any]:
    """Returns a JSON object with the layout of a stage with these ``metrics``, and how positions in m are placed."""
    high, later = stage_height(metrics), (("", LATER),)
    bar = colour_bar_box(metrics, high)
    per_metre, corner = body_placement(body.extent, metrics, high)
    labels = [*(label for label in colour_bar_labels(bar, metrics, USUAL[0], []) if label.text),
              *body_labels(later, later, (LATER, LATER), metrics, high)]
    return {"pixels": metrics.pixels, "high": high, "gutter": metrics.gutter, "bar": asdict(bar), "radius": AROUND,
            "per_metre": per_metre, "corner": corner, "labels": [
                {**asdict(label), "text": LATER if label.name == "quantity" else label.text} for label in labels]}
