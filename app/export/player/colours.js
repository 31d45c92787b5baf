// The colour scale that estimate and truth share. Its top follows the largest error of the last period, in round numbers,
// as in app/frame/scale.py.

const {tops: TOPS, decades: DECADES, beyond: BEYOND, memory: MEMORY, smallest: SMALLEST} = DATA.scale;
const {truth: TRUTH, pinned: PINNED, flash: FLASH, dot: DOT, faint: FAINT, cell: CELL, unknown: UNKNOWN} = DATA.colours;
const TABLE = Uint8Array.from(atob(DATA.colours.map), (letter) => letter.charCodeAt(0));
const SHADES = Array.from({length: 256}, (_, k) => `rgb(${TABLE[3 * k]},${TABLE[3 * k + 1]},${TABLE[3 * k + 2]})`);

// The tops of all pictures of a run as it is looked at, and whether something is beyond them.
function topsOf(run, view) {
  const key = ["tops", view.quantity, view.estimator, view.difference].join();
  if (run[key]) return run[key];
  const times = run.tracks.time.values, peaks = [], tops = [], least = (run.least[view.quantity] || [0])[0];
  for (let k = 0; k < times.length; k++) {
    const truth = largest(trueSizes(run, view.quantity, k));
    const estimate = largest(estimatedSizes(run, view.quantity, view.estimator, view.difference, k));
    peaks.push(truth > 0 ? Math.max(truth, Math.min(estimate, BEYOND * truth)) : estimate);
    const since = times[k] - MEMORY * run.period;
    let peak = least;
    for (let j = k; j >= 0 && times[j] >= since; j--) peak = Math.max(peak, peaks[j]);
    const [top, step] = peak > SMALLEST ? roundUp(peak, TOPS.map(([step]) => step)) : [1, 1];
    tops.push({top, parts: TOPS.find(([other]) => other === step)[1], exceeded: Math.max(truth, estimate) > top});
  }
  return run[key] = tops;
}

function shade(size, scale) {
  const share = scale.logarithmic ? 1 + Math.log10(size / scale.top) / DECADES : size / scale.top;
  return SHADES[share < 0 ? 0 : share < 1 ? Math.floor(255 * share) : 255];
}

function ticksOf(scale) {
  const ticks = [];
  if (scale.logarithmic) {
    for (let k = 0; k <= DECADES; k++) ticks.push([k / DECADES, number(scale.top * 10 ** (k - DECADES))]);
  } else {
    const power = powerOfTen(scale.top);
    for (let k = 0; k <= scale.parts; k++) ticks.push([k / scale.parts, number(scale.top * k / scale.parts / 10 ** power)]);
  }
  if (scale.exceeded) ticks[ticks.length - 1][1] = "≥ " + ticks[ticks.length - 1][1];
  return ticks;
}

// The colour bar; returns its title and its numbers as labels.
function drawColourBar(pen, place, scale, measures, unit) {
  const {middle, height, gap} = DATA.scale.bar, steps = Math.ceil(place.across), power = scale.logarithmic ? 0 : powerOfTen(scale.top);
  for (let k = 0; k < steps; k++) {
    pen.fillStyle = SHADES[Math.floor(255 * k / steps)];
    pen.fillRect(place.left + k, place.y(middle + height / 2), 1.5, place.unit * height);
  }
  return [{name: "scale", text: `${measures} / ${powerText(power)}${unit}`, x: 0, y: middle + gap, anchor: "bottom-left"},
    ...ticksOf(scale).map(([x, text], k) => ({name: `tick${k}`, text, x, y: middle - gap, anchor: "top-center"}))];
}
