"""What the player's pictures mean, by its own scripts in a browser: which half and which lane show which error, and
that a colour at a tick is that of its number."""

from __future__ import annotations

import json
import math

import pytest

from app import words
from app.export.page import PLAYER
from app.export.vocabulary import vocabulary
from app.frame.scale import TOPS, ZERO
from solvers.problems import PROBLEMS

SCRIPTS = ("words", "tracks", "frame", "colours", "field", "bar", "plane")
#: What is filled on a canvas: its colour and where its middle is, in pixels to the right and down.
PEN = """
class Pen {
  constructor() { this.filled = []; }
  fillRect(x, y, wide, high) { this.filled.push([this.fillStyle, x + wide / 2, y + high / 2]); }
  arc(x, y) { this.at = [x, y]; }
  fill() { this.filled.push([this.fillStyle, ...this.at]); }
  beginPath() {} moveTo() {} lineTo() {} stroke() {}
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
  const what = {sizes: [new Float32Array(n), new Float32Array(n).fill(1)], scale, flashed: []};
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
    data = json.dumps(vocabulary(PROBLEMS), ensure_ascii=False)
    scripts = [(PLAYER / f"{name}.js").read_text(encoding="utf-8") for name in SCRIPTS]
    page.evaluate("(text) => (0, eval)(text)", "\n".join([f"var DATA = {data};", PEN, *scripts,
                                                         f"var drawBare = {DRAW}; var shadeOf = shade;",
                                                         "var rows = SHADES, ticks = ticksOf;"]))
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
@pytest.mark.parametrize("top", [4e-4, 0.8, 1.2e6])
def test_the_colour_at_a_tick_is_that_of_its_number(player, top, logarithmic):
    """To one of 256 shades, or two on a logarithmic scale."""
    parts = TOPS[round(top / 10.0 ** math.floor(math.log10(top)), 6)]
    scale = {"top": top, "parts": parts, "logarithmic": logarithmic, "exceeded": False}
    ticks = player.evaluate("(scale) => ticks(scale, 'm')", scale)
    assert len(ticks) > 3 and ticks[0][0] == 0 and ticks[-1][0] == 1
    unit = "" if logarithmic else ticks[-1][1].split()[1]
    for at, text in ticks:
        value = 0.0 if text == ZERO else words.size_in(text if text.endswith("m") else f"{text} {unit}", "m")
        row = player.evaluate("([value, scale]) => rows.indexOf(shadeOf(value, scale))", [value, scale])
        assert abs(row - 255 * at) <= 1 + logarithmic
