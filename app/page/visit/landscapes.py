"""Landscapes of the scene on a visitor's stage: requests their points, and puts together what is known of them."""

import math
from collections.abc import Callable, Hashable, Iterable
from dataclasses import dataclass
from time import monotonic

from app.page.visit.run_session import RunSession
from app.problems.views import VIEWS
from solvers.engine.engine_messages import SurveyPoint
from solvers.scene.scene import Scene
from solvers.study.landscape.error_history import HistoryCache
from solvers.study.landscape.landscape import (
    MOST_PERIODS,
    PENDING,
    Landscape,
    LandscapeRequest,
    assemble_landscape,
    choose_costly,
)
from solvers.study.landscape.parameter_values import (
    choose_values,
    history_key,
    parameters_of,
    particle_steps,
    point_levels,
    present_value,
    values_at_cliff,
)

CFL = (0.01, 2.0)  # ends of the slider of the time step
LEAST_PERIODS = 0.05  # of a landscape: of a run that has not begun there is no error
HORIZONS = (0.25, 1.0, MOST_PERIODS)  # periods that points of a playing run last, so that few are run again
INSTANTS = 64  # per period, at which points of a run at rest end, so that another time step needs no others
BUDGET_SECONDS = {1: 1.0, 2: 2.0}  # of a processor for all points of a scene, by its dimensions
POINT_SECONDS = 0.3  # for one of them
EXPECTED_RATES = {1: 3e7, 2: 8e6}  # particle-steps per s, before the first measurement
START_SECONDS = {1: 0.002, 2: 0.015}  # that a run takes before its first step
PATIENCE = 1.5  # seconds without a result after which points are requested again, as an engine may have been replaced
LAST = 3  # rank of points that are not computed while a run plays and will soon need longer ones
CLIFFS = ("cfl", "modulus")  # parameters with values in between, of which the place of the cliff is of interest


@dataclass(frozen=True)
class _Point:
    """Point of a landscape: its parameter, value and history's key, its ``level``, from 0 for coarse, and its price in
    particle-steps."""

    parameter: str
    value: float
    key: Hashable
    level: int
    price: float


class Landscapes:
    """Landscapes of one visitor: of the parameters of the scene that the session has requested. The histories of their
    runs come from a cache that all visitors share; ``on_points`` is called when some have come of a run at rest."""

    def __init__(self, session: RunSession, histories: HistoryCache, on_points: Callable[[], None]):
        self._session, self._histories, self._on_points = session, histories, on_points
        histories.listeners.add(self._on_histories)
        self._shown: tuple = ()  # what the landscapes are of
        self._curves: dict[str, Landscape] = {}
        self.rate: float | None = None  # of these runs on one processor, in particle-steps per s, once measured
        self._missing: dict[Hashable, SurveyPoint] = {}  # by the keys of their histories, in their order
        self._requested: tuple[Scene | None, str | None, set[SurveyPoint]] = (None, None, set())  # of the engine
        self._requested_at = 0.0

    def close(self) -> None:
        """Ends the calls of ``on_points``."""
        self._histories.listeners.discard(self._on_histories)

    def curves(self) -> dict[str, Landscape]:
        """Returns what is known, by parameter; nothing for scenes of whose runs no landscape can be computed."""
        return self._curves

    def request(self, parameter_in_hand: str | None, until: float, quantity: str, estimator: str | None,
                held: bool = False) -> None:
        """Requests the landscapes of the session's scene until a time in periods, that of the parameter in hand first;
        called at every refresh. While its slider is ``held`` no run begins. Points that are outdated are given up."""
        scene, until = self._session.scene, round(min(max(until, LEAST_PERIODS), MOST_PERIODS), 9)
        shown = scene, until, quantity, estimator, parameter_in_hand, self._session.playing
        news = self._has_news
        if shown != self._shown or news:
            self._shown = shown
            self._update(scene, until, quantity, estimator, parameter_in_hand)
        self._send(scene, parameter_in_hand, set() if held else set(self._missing.values()), news)

    def _update(self, scene: Scene, until: float, quantity: str, estimator: str | None, in_hand: str | None) -> None:
        """Works out anew what is known, and which points are missing."""
        self._curves, self._missing = {}, {}
        if scene.arch != "cpu" or getattr(scene, "plan", "") == "parallel":  # in a fork only serial runs are possible
            self.rate = None
            return
        horizon = (next(h for h in HORIZONS if h >= until) if self._session.playing else
                   math.ceil(until * INSTANTS) / INSTANTS)
        coarse = self._session.playing and horizon < MOST_PERIODS
        requests = {name: LandscapeRequest(scene, name, until, quantity, estimator, _slider_reach(scene, name))
                    for name in parameters_of(scene)}
        points = [point for request in requests.values() for point in self._points(request, horizon)]
        points.sort(key=lambda one: (_rank(one, in_hand), one.level, one.price))
        rate = self.rate = self._measured_rate(points)
        D = scene.DIMENSIONS
        costly = choose_costly([START_SECONDS[D] + point.price / (rate or EXPECTED_RATES[D]) for point in points],
                               BUDGET_SECONDS[D], POINT_SECONDS)
        for point, dear in zip(points, costly, strict=True):
            if not (dear or self._is_known(point.key, horizon) or (coarse and _rank(point, in_hand) == LAST)):
                self._missing.setdefault(point.key, SurveyPoint(point.parameter, point.value, horizon, point.level))
        for name, request in requests.items():
            own = sorted((point.value, point.key, dear)
                         for point, dear in zip(points, costly, strict=True) if point.parameter == name)
            histories = [self._histories.get(key) for _, key, _ in own]
            self._curves[name] = assemble_landscape(request, [value for value, *_ in own], histories,
                                                    [dear for *_, dear in own], rate or math.nan)

    def _points(self, request: LandscapeRequest, horizon: float) -> list[_Point]:
        """Returns the points of a landscape, whose runs end at the ``horizon`` in periods. Where runs break, two more
        points show from which value on."""
        scene, name = request.scene, request.parameter
        values = choose_values(scene, name, request.reach, horizon)
        for _ in range(2 if name in CLIFFS else 0):
            known = [self._histories.get(history_key(scene, name, value)) for value in values]
            statuses = [history.status_at(horizon) if history else PENDING for history in known]
            values = tuple(sorted({*values, *values_at_cliff(values, statuses)}))
        prices = [particle_steps(scene, name, value, horizon) for value in values]
        levels = point_levels(values, present_value(scene, name))
        return [_Point(name, value, history_key(scene, name, value), level, price)
                for value, level, price in zip(values, levels, prices, strict=True)]

    @property
    def _has_news(self) -> bool:
        """Whether a missing point has become known."""
        return any(self._is_known(key, point.until) for key, point in tuple(self._missing.items()))

    def _on_histories(self) -> None:
        """Calls ``on_points`` if the run rests and its missing points have come; on a thread of an engine's."""
        if not self._session.playing and self._has_news:
            self._on_points()

    def _is_known(self, key: Hashable, until: float) -> bool:
        history = self._histories.get(key)
        return history is not None and history.until >= until

    def _measured_rate(self, points: Iterable[_Point]) -> float | None:
        """Returns the rate, in particle-steps per s, with which the longest of the known points was computed."""
        known = [(history.until * point.price, history.rate) for point in points
                 if (history := self._histories.get(point.key)) and history.rate > 0]
        return max(known)[1] if known else None

    def _send(self, scene: Scene, in_hand: str | None, points: set[SurveyPoint], news: bool) -> None:
        """Sends the missing points to the engine, unless it has them."""
        last_scene, last_hand, last = self._requested
        late = points and not news and monotonic() > self._requested_at + PATIENCE
        if news:
            self._requested_at = monotonic()
        if late or points - last or (last and scene != last_scene) or (points and in_hand != last_hand):
            self._requested, self._requested_at = (scene, in_hand, points), monotonic()
            self._session.link.survey(scene, [point for point in self._missing.values() if point in points])


def _rank(point: _Point, in_hand: str | None) -> int:
    """Returns the place of a point in the order: all of the parameter in hand, the others' coarse ones, the rest."""
    if point.level == 0:
        return 2 * (in_hand not in (None, point.parameter))
    return 1 if point.parameter == in_hand else LAST


def _slider_reach(scene: Scene, parameter: str) -> tuple[float, float, float]:
    """Returns the ends and the step of a parameter's slider; step 0 of a logarithmic one."""
    ranges = VIEWS[scene.problem].slider_ranges
    if parameter == "cells":
        return ranges.cells
    if parameter == "ppc":
        return *ranges.ppc, 1.0 if scene.swings else 0.5
    return *{"amplitude": ranges.amplitude, "modulus": ranges.modulus, "cfl": CFL}[parameter], 0.0
