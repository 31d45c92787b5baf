"""The exported file: one html page with style, script, data and recordings, which needs no network."""

import json
from collections.abc import Callable, Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any

from app import __version__, shareable_state
from app.colour_palette import css_variables
from app.export import slider_grid, stage_export_plan
from app.export.player_display_data import shared_display_data
from app.export.recording import RecordingRequest, record_scene, record_scenes
from app.export.stage_export_plan import StageExportPlan, export_plan_to_json, make_export_plan
from app.language.translation import current_language, load_catalogue, tr
from app.logo_and_font import ICON, MARK, font_faces_css
from app.names_and_units import number_format_script
from app.templates import render_template, script_source

PLAYER = Path(__file__).parent / "player"
#: In order of dependencies.
SCRIPTS = ("words", "tracks", "frame", "colours", "field", "bar", "plane", "stage", "readout", "budget", "controls",
           "sha256", "keeping", "progress", "core", "answers", "bets", "lesson", "main")
IN_A_COURSE = (*SCRIPTS[:-1], "scorm", "suspended", "course", "main")
USUAL = ("x", "v", "sigma")  # quantities whose errors are recorded; accelerations only on request

ProgressCallback = Callable[[float, str], None]  # receives the part done, 0 to 1, and what was done, "run 3 of 8"
Recordings = dict[tuple[int, str], dict[str, Any]]  # JSON objects by (index of the plan, text of the run)


def scene_page(text: str, processes: int, on_progress: ProgressCallback,
               counts: Mapping[str, int] = slider_grid.FULL) -> str:
    """Returns the html of an offline page with a scene and sliders; runs and records all of its scenes.

    ``text`` is that of a state, or a problem's name; ``counts`` the most values of each field on its slider."""
    shown = shareable_state.parse_state(text)
    one = make_export_plan(shown, (), recorded_quantities(shown))
    one = make_export_plan(one.state, slider_grid.axes_around(one.scene, counts), one.quantities)
    return assemble_page(_page_title(one), [one], record_plans([one], processes, on_progress), None)


def recorded_page(shown: shareable_state.State) -> str:
    """Returns the html of an offline page with a state's scene and no sliders, run and recorded in this process."""
    one = make_export_plan(shown, (), recorded_quantities(shown))
    recorded = _make_distinct_recordings([one], lambda once: [record_scene(wanted) for wanted in once])
    return assemble_page(_page_title(one), [one], recorded, None)


def _page_title(one: StageExportPlan) -> str:
    title = tr(one.scene.title)
    return title[:1].upper() + title[1:]


def recorded_quantities(shown: shareable_state.State) -> tuple[str, ...]:
    """Returns the keys of the quantities whose errors are recorded: x, v, sigma, and the one that the state shows."""
    return (*USUAL, *(key for key in (shown.quantity,) if key not in USUAL))


def record_plans(plans: Sequence[StageExportPlan], processes: int, on_progress: ProgressCallback) -> Recordings:
    """Runs and records all scenes of plans in so many parallel ``processes``; see ``Recordings`` for the result."""
    return _make_distinct_recordings(plans, lambda once: record_scenes(
        once, processes, lambda done: on_progress(done / len(once), f"run {done} of {len(once)}")))


def _make_distinct_recordings(plans: Sequence[StageExportPlan],
                              make: Callable[[list[RecordingRequest]], list[dict[str, Any]]]) -> Recordings:
    """Returns the recordings of plans; equal requests are passed to ``make`` once, which returns one for each."""
    wanted = stage_export_plan.recordings_needed(plans)
    once = list(dict.fromkeys(wanted.values()))
    found = dict(zip(once, make(once), strict=True))
    return {key: found[one] for key, one in wanted.items()}


def assemble_page(heading: str, plans: Sequence[StageExportPlan], recorded: Recordings,
                  lesson: Mapping[str, Any] | None, scripts: Sequence[str] = SCRIPTS) -> str:
    """Returns the html of an offline page: its title, a stage for each plan with its recordings, the JSON object of a
    lesson or None for a scene alone, and the player's scripts (names of files in ``player/``, in this order)."""
    runs = list({id(run): run for run in recorded.values()}.values())
    places = {id(run): number for number, run in enumerate(runs)}
    stages = [export_plan_to_json(one, {text: places[id(recorded[k, text])] for text in one.run_texts})
              for k, one in enumerate(plans)]
    texts = list({_script_safe_json(run["texts"]): run["texts"] for run in runs}.values())  # equal for most runs
    data = {**shared_display_data({one.scene.problem for one in plans}), "stages": stages, "lesson": lesson,
            "texts": texts, "runs": [{"head": run["head"], "tracks": run["tracks"], "texts": texts.index(run["texts"])}
                                     for run in runs]}
    own = f" lang=\"{lesson['language']}\"" if lesson and lesson["language"] != current_language() else ""
    return render_player(heading, data, [run["data"] for run in runs], scripts, own)


def render_player(heading: str, data: Mapping[str, Any], packed: Sequence[str], scripts: Sequence[str],
                  own: str = "") -> str:
    """Returns the html of an offline page: its title, its ``data`` as JSON, the ``packed`` tracks of its runs, its
    scripts; ``own`` is an attribute of its heading."""
    runs = "\n".join(f'<script type="text/plain" id="run-{k}">{text}</script>' for k, text in enumerate(packed))
    data = {"words": load_catalogue(current_language()).translations_for_files("app/export/player/"), **data}
    code = "\n".join(_read_player_file(f"{name}.js") for name in scripts)
    script = "(() => { \"use strict\";\nconst DATA = JSON.parse(document.getElementById(\"data\").textContent);\n" \
             f"{number_format_script()}{code}\n}})();"
    parts = {"title": escape(heading), "lang": own, "version": __version__,
             "kind": "lesson" if data["lesson"] else "scene", "language": current_language(),
             "empty": tr("Press <b>On the stage</b> in the lesson: its run begins here."),
             "style": font_faces_css() + css_variables() + _read_player_file("player.css"), "mark": MARK, "icon": ICON,
             "data": _script_safe_json(data), "runs": runs,
             "script": script, "own": script_source(script)}
    return render_template(PLAYER / "player.html", **parts)


def _read_player_file(name: str) -> str:
    return (PLAYER / name).read_text(encoding="utf-8")


def _script_safe_json(values: Mapping[str, Any]) -> str:
    """Returns JSON without ``<``, which could end an html script."""
    return json.dumps(values, ensure_ascii=False, separators=(",", ":")).replace("<", "\\u003c")
