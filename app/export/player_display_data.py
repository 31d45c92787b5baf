"""Data that the player shares with the live page: number formats, scales, colours, names and texts."""

import base64
from collections.abc import Collection, Iterable, Mapping
from dataclasses import asdict
from typing import Any

from app import names_and_units
from app.colour_palette import CAUSES, PALETTE, PINNED, colour_table
from app.export import recording_compression
from app.frame import budget_chart_data, colour_scale, error_view_captions, field_plot, headline, layout
from app.frame.layout import ComparedRunSlot
from app.frame.primitives import LIGHT, StageMetrics
from app.frame.stage import MOST_CHANGED, Stage, StageLabels
from app.language.translation import tr
from app.problems.views import VIEWS
from solvers.scene import error_causes
from solvers.scene.estimator_registry import ESTIMATORS
from solvers.scene.scene import Scene

#: Bounds in which stages are laid out: for a window, and for a phone. The player scales them.
ROOMS = {"wide": StageMetrics(720.0, high=0.58, gutter=0.18), "narrow": StageMetrics(336.0, high=0.84)}
LATER = "…"  # placeholder for a text of a run or frame


def shared_display_data(problems: Iterable[str]) -> dict[str, Any]:
    """Returns what the player shares with the live page as a JSON object, with static data of the problems' stages."""
    return {"codes": recording_compression.CODES,
            "scale": {"tops": list(colour_scale.TOPS.items()), "decades": colour_scale.DECADES,
                      "beyond": colour_scale.BEYOND, "smallest": colour_scale.SMALLEST,
                      "over": colour_scale.OVER, "zero": tr(colour_scale.ZERO)},
            "axis": {"steps": field_plot.STEPS, "room": field_plot.ROOM, "stems": field_plot.MOST_STEMS},
            "most_changed": MOST_CHANGED,
            "colours": _colour_map_data(), "edge": layout.EDGE,
            "quantities": {key: {"noun": of.noun, "symbol": of.symbol, "unit": of.unit}
                           for key, of in names_and_units.QUANTITIES.items()},
            "compare": (tr(error_view_captions.SIDE_BY_SIDE), tr(error_view_captions.DIFFERENCE)),
            "unknown": error_view_captions.add_unknown_count("{remark}", "{unknown}"),
            "sentences": {"unstable": tr(headline.UNSTABLE), "last": tr(headline.LAST), "lost": tr(headline.LOST),
                          "now": tr(headline.NOW), "paused": tr(headline.PAUSED), "less": tr(headline.LESS),
                          "more": tr(headline.MORE), "twice": headline.TWICE,
                          "not_counted": tr(error_view_captions.NOT_COUNTED)},
            "budget": {"causes": {name: {"meaning": tr(budget_chart_data.MEANINGS[name]), "colour": CAUSES[name].light}
                                  for name in error_causes.CAUSES},
                       "fields": error_causes.FIELDS, "units": budget_chart_data.UNITS, "seen": budget_chart_data.SEEN,
                       "caption": tr(budget_chart_data.CAPTION), "below": tr(budget_chart_data.BELOW_ZERO),
                       "question": tr(budget_chart_data.QUESTION)},
            "magnifications": names_and_units.MAGNIFICATIONS,
            "estimators": {name: {"colour": one.colour, "dashes": one.dashes} for name, one in ESTIMATORS.items()},
            "problems": {name: static_stage_data(VIEWS[name].stage) for name in sorted(problems)}}


def static_stage_data(stage: type[Stage]) -> dict[str, Any]:
    """Returns a JSON object with what all frames of a problem's stage share: mirror images, and layout and labels in
    the bounds of a window and of a phone. A label's text is ``LATER`` if a run or frame has it."""
    return {"mirrors": stage.MIRRORS, "outlined": stage.OUTLINED, "lines": stage.LINES,
            "alike": tr(error_view_captions.ALIKE).format(tr(stage.HALVES)),
            "rooms": {name: _stage_layout(stage, room.rounded()) for name, room in ROOMS.items()}}


def _stage_layout(stage: type[Stage], room: StageMetrics) -> dict[str, Any]:
    """Returns a JSON object with the boxes and labels of a stage with these bounds (stage units, 1 = its width)."""
    places = stage.layout(room, ComparedRunSlot.ALONE)
    top = layout.colour_bar_box(room, room.high)
    halves = tr(error_view_captions.ESTIMATE[0]), tr(error_view_captions.TRUTH)
    later = (("", LATER),)
    said = StageLabels(halves, (LATER, LATER), (LATER, LATER), later, later, note=LATER, crossings=LATER, alike=LATER)
    labels = list(stage.labels(said, places))
    if isinstance(places, layout.FieldPlotLayout):
        labels += field_plot.plot_labels(places, stage.PLOT.ends, error_view_captions.FieldPlotCaption(LATER, LATER), 1,
                                         LATER)
    of = [label for label in layout.colour_bar_labels(top, room, "x", []) if label.text]
    own = {name: value for name, value in asdict(places).items() if name not in ("stage_metrics", "slot", "rectangle")}
    return {"pixels": room.pixels, "high": room.high, "gutter": room.gutter, **own, "bar": asdict(top),
            "labels": [asdict(label) for label in (*of, *labels)]}


def _colour_map_data() -> dict[str, Any]:
    """Returns a JSON object with the colour map (bytes r, g, b in base64) and the named colours as CSS."""
    marks = {name: f"rgb{colour}" for name, colour in vars(LIGHT).items()}
    tones = {"plain": "ink2", "bold": "ink", "faint": "ink3", "estimate": "estimate-ink", "truth": "truth-ink",
             "crossing": "cross", "before": "before"}
    return {"map": base64.b64encode(colour_table().tobytes()).decode(), "pinned": PINNED, **marks,
            "tones": {tone: PALETTE[name].light for tone, name in tones.items()}}


def missing_value_texts(scene: Scene, not_valid: Mapping[str, str], silent: Mapping[str, Collection[str]],
                        difference: bool) -> dict[str, Any]:
    """Returns a JSON object of texts by quantity (x, v, ...): why a row of the readout has no number, the field plot's
    caption, and by estimator ("" if none) captions of both halves and headline templates. ``not_valid`` maps estimators
    to reasons, ``silent`` quantities to estimators without values; ``difference`` adds captions of that view."""
    return {key: {"rows": error_view_captions.why_no_numbers(scene, not_valid, key, silent[key]),
                  "field": vars(error_view_captions.field_plot_caption(scene, key)),
                  "by": {name: _estimator_texts(scene, not_valid, key, name, silent[key], difference)
                         for name in scene.estimators or ("",)}} for key in silent}


def stage_notes(scene: Scene, stride: int) -> dict[str, str]:
    """Returns a stage's notes: the run's ``name`` and ``settings``, ``note`` on its scale, ``marks`` on crossings, on
    every ``stride``-th particle."""
    stage = VIEWS[scene.problem].stage
    return {"name": names_and_units.functions_name(scene.method),
            "settings": names_and_units.main_settings_text(scene), "note": stage.scale_note(scene),
            "marks": error_view_captions.crossing_marks_legend(stage.MARKED, stride)}


def _estimator_texts(scene: Scene, not_valid: Mapping[str, str], quantity: str, name: str, silent: Collection[str],
                     difference: bool) -> dict[str, Any]:
    """Returns captions and headline templates of one quantity by one estimator, or none if its ``name`` is ""."""
    estimator, no_truth = name or None, error_view_captions.why_no_truth(scene, quantity)
    no_estimate = error_view_captions.why_no_estimate(scene, not_valid, estimator, quantity) \
        or f"{name} {error_view_captions.not_estimated_text(quantity)}" * (name in silent)
    return {"captions": [vars(error_view_captions.make_captions(quantity, estimator, apart, no_estimate, no_truth))
                         for apart in (False, True)[:1 + difference]],
            "errors": vars(headline.error_headline_templates(scene, quantity, estimator, no_estimate, no_truth))}
