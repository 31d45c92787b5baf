"""What the player's pictures, numbers and bets mean, by its own scripts in a browser: which half and which lane show
which error, that a colour at a tick is that of its number, and that all is read and written as in Python."""

import json
import math

import numpy as np
import pytest

from app import names_and_units
from app.export.html_file import PLAYER
from app.export.lesson_export import bet_chart_texts
from app.export.player_display_data import shared_display_data
from app.frame.colour_scale import TOPS
from app.lessons.interval_bet_chart import make_bet_chart
from app.lessons.interval_bets import BY_ROUND, YOURS, Bettor, IntervalBet
from app.page.features.lesson.answer_widgets import parse_number
from solvers.problems import PROBLEMS
from tests.app.frame.test_meaning import assert_shades

SCRIPTS = ("words", "tracks", "frame", "colours", "field", "bar", "plane", "answers", "bets")
#: What is filled on a canvas: its colour and where its middle is, in pixels to the right and down.
PEN = """
class Pen {
  constructor() { this.filled = []; }
  fillRect(x, y, wide, high) { this.filled.push([this.fillStyle, x + wide / 2, y + high / 2]); }
  arc(x, y) { this.at = [x, y]; }
  fill() { this.filled.push([this.fillStyle, ...this.at]); }
  beginPath() {} moveTo() {} lineTo() {} stroke() {} setLineDash() {}
}
"""
#: A body of eight particles, each estimate 0 and each true error 1; returns what is filled, and the titles' places.
DRAW = """
(problem) => {
  const place = placeOf(problem, 900, 600), n = 8, pen = new Pen();
  const angles = Array.from({length: n}, (_, k) => (k + 0.5) * (place.radius ? Math.PI / 2 : 1) / n);
  const x = place.radius ? [...angles.map(Math.cos), ...angles.map(Math.sin)] : angles;
  const whole = place.radius && !DATA.problems[problem].mirrors.some(([side]) => side < 0);
  if (whole) for (let k = 0; k < n; k += 2) x[k] = -x[k];
  const run = {problem, outermost: 1.2, spacing: 0.1, first_line: 0, shown: n, particles: n, tile: ["square", 0.1],
               tracks: {position: {rows: 1, width: x.length, values: Float32Array.from(x)}}};
  const scale = {top: 1, parts: 4, logarithmic: false, exceeded: false};
  const what = {sizes: [new Float32Array(n), new Float32Array(n).fill(1)], scale, changed: []};
  (place.radius ? drawBody : drawLanes)(pen, run, {domains: false}, 0, place, what);
  const titles = ["estimate", "truth"].map((half) => place.labels.find(({name}) => name === `${half}-title`));
  const axis = place.radius ? 0 : 1;
  const middle = axis ? place.y((place.estimate + place.truth) / 2) : place.x(place.middle[0]);
  return {filled: pen.filled.map(([colour, ...at]) => [at[axis] < middle, colour]), middle,
          titles: titles.map(({x, y}) => [place.x(x), place.y(y)][axis]), lowest: SHADES[0], highest: SHADES[255]};
}
"""


@pytest.fixture(scope="module")
def player(chromium):
    """A page that knows the player's functions, and no run."""
    page = chromium.new_page()
    data = json.dumps(shared_display_data(PROBLEMS), ensure_ascii=False)
    lesson = json.dumps({"bets": bet_chart_texts()}, ensure_ascii=False)
    scripts = [(PLAYER / f"{name}.js").read_text(encoding="utf-8") for name in SCRIPTS]
    page.evaluate("(text) => (0, eval)(text)", "\n".join([f"var DATA = {data}, LESSON = {lesson};", PEN,
                                                         names_and_units.number_format_script(), *scripts,
                                                         f"var drawBare = {DRAW}; var shadeOf = shade;",
                                                         "var rows = SHADES, ticks = ticksOf;",
                                                         "Object.assign(globalThis, numbers);",
                                                         "var bet = betOf, picture = betsDrawn, figure = betsFigure;"]))
    yield page
    page.close()


@pytest.mark.parametrize("problem", PROBLEMS)
def test_each_error_is_shown_where_its_name_stands(player, problem):
    """The estimate in the lane above, or on the left half, where its title is; the truth below, or on the right."""
    drawn = player.evaluate("(problem) => drawBare(problem)", problem)
    estimate, truth = drawn["titles"]
    assert estimate < drawn["middle"] < truth  # pixels go to the right and down
    assert {tuple(one) for one in drawn["filled"]} == {(True, drawn["lowest"]), (False, drawn["highest"])}


@pytest.mark.parametrize("logarithmic", [False, True], ids=["linear", "logarithmic"])
@pytest.mark.parametrize("top", [3e-4, 0.1, 1.0])
def test_the_colour_at_a_tick_is_that_of_its_number(player, top, logarithmic):
    """To one of 256 shades, or two on a logarithmic scale."""
    parts = TOPS[round(top / 10.0 ** math.floor(math.log10(top)), 6)]
    scale = {"top": top, "share": top, "parts": parts, "logarithmic": logarithmic, "exceeded": False}
    ticks = player.evaluate("(scale) => ticks(scale)", scale)
    assert_shades(ticks, logarithmic, lambda value: player.evaluate(
        "([value, scale]) => rows.indexOf(shadeOf(value, scale))", [value, scale]))


def test_bets_are_scored_and_drawn_as_in_python(player):
    """Scores to the last digit but for a logarithm's rounding, of which there are three and a factor of 20: 1e-13; and
    the picture, with all that it says."""
    chance = np.random.default_rng(5)

    def bet(level):
        low, high = sorted(map(float, 10 ** chance.uniform(-9, -2, 2)))
        return None if chance.uniform() < 0.2 else IntervalBet(low, high, float(10 ** chance.uniform(-8, -3)), level)

    made = [[bet((0.5, 0.8, 0.9)[k % 3]) for k in range(8)] for _ in range(12)]
    bettors = [Bettor(YOURS, tuple(made[0])), Bettor(BY_ROUND, tuple(made[1]), 2), Bettor("transport", (None, None)),
               *(Bettor("GCI", tuple(one)) for one in made[2:])]
    told = [{"name": bettor.name, "round": bettor.round, "bets": [
        bet and [[bet.low, bet.high], bet.truth, bet.level] for bet in bettor.bets]} for bettor in bettors]
    again = "told.map((one) => ({...one, bets: one.bets.map((each) => each && bet(...each))}))"
    scores = player.evaluate(
        f"(told) => {again}.map(({{bets}}) => bets.map((one) => one && [one.score, one.holds]))", told)
    for found, bettor in zip(scores, bettors, strict=True):
        for one, bet in zip(found, bettor.bets, strict=True):
            assert (one is None) == (bet is None)
            assert bet is None or (one[1] == bet.holds and one[0] == pytest.approx(bet.score, rel=1e-13, abs=1e-13))
    for some in (bettors, bettors[2:3], bettors[:1]):
        picture, seen = make_bet_chart(some), player.evaluate(f"(told) => picture({again})", [
            told[bettors.index(one)] for one in some])
        assert (seen["reach"], seen["said"]) == (picture.reach, picture.description)
        assert [tuple(tick) for tick in seen["ticks"]] == picture.ticks
        for lines, one in zip(seen["bettors"], picture.bettors, strict=True):
            assert (lines["name"], lines["told"], lines["own"]) == (one.name, one.result, one.own)
            assert [line and line[2] for line in lines["lines"]] == [line and line[2] for line in one.lines]
            for line, drawn_line in zip(lines["lines"], one.lines, strict=True):
                assert line is None or line[:2] == pytest.approx(drawn_line[:2], abs=1e-9)
    labels = player.evaluate(f"(told) => [...figure({again}).querySelectorAll('svg')].map((one) => "
                             "one.getAttribute('aria-label'))", told)
    assert labels == [f"{one.name}: {one.result}" for one in make_bet_chart(bettors).bettors]


def test_an_answer_is_read_as_on_the_page(player):
    """With the unit asked for, another prefix of it, or none."""
    asked = [(text, unit) for unit in ("", "µm", "mm/s", "m", "m/s", "Pa", "kPa", "s", "%", "m/s²")
             for text in ("330 nm", "2,5", "-1e-3", "0.33 µm", "2.75 mm/s", "3 m/s", "4 kPa", "4 Pa", "12 %", "5 m",
                          "5 mm", "1 ms", "7 µm/s²", "nothing", "", "-3 mm", "1 mmm")]
    found = player.evaluate("(asked) => asked.map((one) => numberIn(...one))", asked)
    for (text, unit), value in zip(asked, found, strict=True):
        meant = parse_number(text, unit)
        assert value == (meant if meant is None else pytest.approx(meant, rel=1e-11)), (text, unit)


def sizes():
    """Of all sizes and signs, round and not, midway between two that can be written, at edges of a form, and none."""
    edges = [0.0949, 0.095, 0.0951, 0.00949, 0.0095, 0.99, 0.994, 0.995, 0.996, 0.9995, 0.99949, 9.995, 99.95, 999.4,
             999.5, 999.6, 999.949, 999.95, 999.995, 999.999, 1000.0, 1000.5, 9994.9, 9995.0, 9999.5, 99995.0, 1e5, 0.1,
             0.125, 0.375, 0.625, 2.125, 2.5, 3.5, 0.5, 1.5, 12.25, 100.5, 1005.0, 1015.0, 1025.0, 0.0625, 0.03125]
    powers = [10.0**k for k in (*range(-300, 301, 20), *range(-18, 19))]
    beside = [math.nextafter(power, to) for power in powers[-37:] for to in (0.0, math.inf)]
    random = np.random.default_rng(7)
    some = random.choice([-1, 1], 250) * random.uniform(1, 10, 250) * 10.0 ** random.integers(-20, 20, 250)
    found = [*edges, *powers, *beside, *(3.0 * power for power in powers)]
    return [*found, *(-size for size in found), *some.tolist(), 0.0, -0.0, math.inf, -math.inf, math.nan]


def test_a_number_is_written_as_on_the_page(player):
    """Every form of ``numbers.js`` beside that of ``app.names_and_units``, to the letter."""
    values = sizes()
    forms = {"number(x)": names_and_units.format_number, "number(x, 4)": lambda x: f"{x:.4g}",
             "ratio(x)": names_and_units.format_ratio, "perCent(x)": names_and_units.per_cent,
             "powerOfTen(x)": names_and_units.power_of_ten, "fixed(x, 2)": lambda x: f"{x:.2f}",
             "withUnit(x, 'm')": lambda x: names_and_units.with_unit(x, "m"),
             "withUnit(x, 'Pa', 2)": lambda x: names_and_units.with_unit(x, "Pa", 2)}
    found = player.evaluate(f"(texts) => texts.map(Number).map((x) => [{', '.join(forms)}])",
                            [repr(value).replace("inf", "Infinity") for value in values])
    assert player.evaluate("(all) => all.map(powerText)", list(range(-30, 31))) == [
        names_and_units.format_power_of_ten(k) for k in range(-30, 31)]
    wrong = [(form, value, said, write(value)) for value, row in zip(values, found, strict=True)
             for (form, write), said in zip(forms.items(), row, strict=True)
             if said != write(value) and not (form.startswith("fixed") and abs(value) > 1e20)]
    assert wrong == []
