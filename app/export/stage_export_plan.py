"""Plan of the stage in an exported file: a state, the runs around it, and how finely they are recorded."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from app.export import slider_grid
from app.export.recording import CURVE_POINTS, RecordingRequest
from app.export.slider_grid import SliderAxis
from app.language.translation import current_language, tr
from app.names_and_units import METHODS, in_a_line, unit_of, with_unit
from app.problems.views import VIEWS
from app.shareable_state import State, parse_state, write_state
from solvers.scene.error_causes import CAUSES, FIELDS
from solvers.scene.scene import Scene

LABELS = {field: name for name, field in slider_grid.CONTROLS.items()}
BUDGET = 8_000_000  # bytes of all recordings before they are compressed, about what they take in the file afterwards
LEAST, STRIDE = 40, 40  # least particles kept of a run, and step of the search
MOST = {1: 200, 2: 1040}  # by dimensions: more along a bar are indistinguishable
#: Pictures per period (at least one period's), and at most in all, by the problem's dimensions.
PICTURES = {1: (48, 240), 2: (30, 120)}


@dataclass(frozen=True)
class StageExportPlan:
    """Plan of one stage in an exported file: its ``state``, the sliders' ``axes`` around that scene, the keys of the
    ``quantities`` whose errors are recorded, and the scenes at all combinations of the axes' values, as ``texts`` of
    states, the last axis fastest; or "!" and the reason where a combination is invalid."""

    state: State
    axes: tuple[SliderAxis, ...]
    quantities: tuple[str, ...]
    texts: tuple[str, ...]

    @property
    def scene(self) -> Scene:
        return self.state.scene

    @property
    def pinned(self) -> str | None:
        """The pinned scene as the text of a state, with an end time; None if nothing is pinned."""
        return None if self.state.pinned is None else write_state(State(with_end_time(self.state.pinned, self.scene)))

    @property
    def frame_count(self) -> int:
        """Number of instants recorded of each run: the start, and the end of each interval between pictures."""
        scene = self.scene
        a_period, most = PICTURES[scene.DIMENSIONS]
        return 1 + round(min(max(scene.end_time / scene.period, 1.0) * a_period, most))

    @property
    def run_texts(self) -> list[str]:
        """Texts of states of all runs to record: the valid ones of ``texts``, and the pinned one."""
        return [text for text in (*self.texts, *([self.pinned] if self.pinned else [])) if not text.startswith("!")]


def make_export_plan(state: State, axes: Sequence[SliderAxis], quantities: Sequence[str]) -> StageExportPlan:
    """Returns the plan to record a state's scene, all combinations of the axes' values and its pinned scene, with the
    errors of ``quantities`` (keys). A scene without an end gets one (see :func:`with_end_time`)."""
    state = replace(state, scene=with_end_time(state.scene))
    return StageExportPlan(state, tuple(axes), tuple(quantities), tuple(slider_grid.scene_texts(state.scene, axes)))


def with_end_time(scene: Scene, like: Scene | None = None) -> Scene:
    """Returns the scene with an end: its own, else that of ``like``, else a period and a quarter, where the motion is
    at its largest and errors are seen, or a shorter default."""
    if scene.t_end is not None or scene.periods is not None:
        return scene
    if like is not None:
        return replace(scene, periods=like.periods, t_end=like.t_end)
    return replace(scene, periods=min(1.25, scene.DEFAULT_PERIODS))


def recordings_needed(plans: Sequence[StageExportPlan]) -> dict[tuple[int, str], RecordingRequest]:
    """Returns requests by (index in ``plans``, run's text), for so few particles that all fit into ``BUDGET`` bytes."""
    counts = [(plan, min(parse_state(text).scene.particles, MOST[plan.scene.DIMENSIONS]))
              for plan in plans for text in plan.run_texts]
    # The most particles for which all recordings fit into the budget; smaller runs need less.
    most = next((most for most in range(max(MOST.values()), LEAST, -STRIDE)
                 if sum(_recording_bytes(plan, min(count, most)) for plan, count in counts) <= BUDGET), LEAST)
    return {(number, text): RecordingRequest(text, plan.frame_count, min(most, MOST[plan.scene.DIMENSIONS]),
                                             plan.quantities, plan.state.difference, plan.state.domains,
                                             current_language())
            for number, plan in enumerate(plans) for text in plan.run_texts}


def _recording_bytes(plan: StageExportPlan, particles: int) -> int:
    """Returns the uncompressed size in bytes of a plan's recording of one run with so many ``particles`` kept."""
    scene, quantities = plan.scene, len(plan.quantities)
    norms = 4 * (3 + 4 * (1 + 3 * len(scene.estimators)))
    each = scene.DIMENSIONS + len(scene.estimators) * (1 + plan.state.difference)
    parts = len(FIELDS) * (5 + len(CAUSES)) * scene.has("budget")
    return plan.frame_count * (norms + parts + 2 * CURVE_POINTS * quantities
                               + particles * ((2 + 2 * plan.state.domains) * scene.DIMENSIONS + quantities * each))


def export_plan_to_json(plan: StageExportPlan, numbers: Mapping[str, int]) -> dict[str, Any]:
    """Returns the plan as a JSON object for the player; ``numbers`` maps a run's text to the index of its recording."""
    state, scene = plan.state, plan.scene
    return {"axes": [{"field": axis.field, "label": tr(LABELS[axis.field]), "start": axis.start, "values": axis.values,
                      "says": [format_axis_label(type(scene), axis.field, value) for value in axis.values]}
                     for axis in plan.axes],
            "runs": [text[1:] if text.startswith("!") else numbers[text] for text in plan.texts],
            "says": ["" if text.startswith("!") else in_a_line(parse_state(text).scene) for text in plan.texts],
            "pinned": numbers[plan.pinned] if plan.pinned else None,
            "quantities": plan.quantities, "estimators": scene.estimators, "compares": state.difference,
            "magnifies": scene.DIMENSIONS == 1,
            "outlines": state.domains and bool(VIEWS[scene.problem].stage.DOMAINS_HINT),
            "view": {"quantity": state.quantity, "difference": state.difference, "domains": state.domains,
                     "magnified": state.magnified, "logarithmic": state.logarithmic,
                     "speed": state.speed or VIEWS[scene.problem].speed,
                     "estimator": state.estimator or scene.first_estimator or ""}}


def format_axis_label(kind: type[Scene], field: str, value: Any) -> str:
    """Formats a value of a scene's ``field`` (SI units) for a slider, with its unit; ``kind`` is the scene's class."""
    if field == "method":
        return str(METHODS[value])
    unit = unit_of(kind, field)
    return with_unit(value, unit) if unit else f"{value:g}"
