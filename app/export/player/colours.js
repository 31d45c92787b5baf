// The colour scale that estimate and truth share. Its top is a round number that holds the largest error so far, from
// the first period on, which a recording knows; it only grows, as in app/frame/colour_scale.py.

const {tops: TOPS, decades: DECADES, beyond: BEYOND, smallest: SMALLEST} = DATA.scale;
const {exact: TRUTH, pinned: PINNED, crossing: CROSSING, dot: DOT, axis: AXIS, grid: GRID, ground: GROUND, stem: STEM, unknown: UNKNOWN} = DATA.colours;
const TABLE = Uint8Array.from(atob(DATA.colours.map), (letter) => letter.charCodeAt(0));
const SHADES = Array.from({length: 256}, (_, k) => `rgb(${TABLE[3 * k]},${TABLE[3 * k + 1]},${TABLE[3 * k + 2]})`);

// The tops of all pictures of a run as it is looked at, and whether something is beyond them.
function topsOf(run, view) {
  const key = ["tops", view.quantity, view.estimator, view.difference].join();
  if (run[key]) return run[key];
  const times = run.tracks.time.values, sizes = [], least = (run.least[view.quantity] || [0])[0];
  for (let k = 0; k < times.length; k++) {
    const truth = largest(trueSizes(run, view.quantity, k));
    const estimate = largest(estimatedSizes(run, view.quantity, view.estimator, view.difference, k));
    sizes.push([Math.max(truth, estimate), truth > 0 ? Math.max(truth, Math.min(estimate, BEYOND * truth)) : estimate]);
  }
  let peak = Math.max(least, ...sizes.filter((_, k) => times[k] <= run.period).map(([, size]) => size));
  const tops = sizes.map(([most, size]) => {
    peak = Math.max(peak, size);
    const [top, step] = peak > SMALLEST ? roundUp(peak, TOPS.map(([step]) => step)) : [1, 1];
    return {top, parts: TOPS.find(([other]) => other === step)[1], exceeded: most > top};
  });
  return run[key] = tops;
}

const shareOf = (size, scale) => scale.logarithmic ? 1 + Math.log10(size / scale.top) / DECADES : size / scale.top;

function shade(size, scale) {
  const share = shareOf(size, scale);
  return SHADES[share < 0 ? 0 : share < 1 ? Math.floor(255 * share) : 255];
}

// All in the unit of the last one, which says it; on a logarithmic scale each in its own.
function ticksOf(scale, unit) {
  const {top, parts} = scale, last = withUnit(top, unit), power = Math.floor(Math.log10(top) / 3 + 1e-9), ticks = [];
  const size = power in PREFIXES ? 1000 ** power : top / Number(last.split(" ")[0]);
  for (let k = 0; k <= (scale.logarithmic ? DECADES : parts); k++) {
    if (scale.logarithmic) ticks.push([k / DECADES, withUnit(top * 10 ** (k - DECADES), unit)]);
    else ticks.push([k / parts, k === 0 ? DATA.scale.zero : k === parts ? last : number(top * k / parts / size)]);
  }
  if (scale.exceeded) ticks[ticks.length - 1][1] = "≥ " + ticks[ticks.length - 1][1];
  return ticks;
}

// The colour bar; returns its title and its numbers as labels.
function drawColourBar(pen, place, scale, quantity) {
  const {middle, high, numbers} = place.bar, steps = Math.ceil(place.across);
  for (let k = 0; k < steps; k++) {
    pen.fillStyle = SHADES[Math.floor(255 * k / steps)];
    pen.fillRect(place.left + k, place.y(middle + high / 2), Math.min(1.5, steps - k), place.unit * high);
  }
  return [...ticksOf(scale, DATA.quantities[quantity].unit).map(([x, text], k) => ({name: `tick${k}`, text, x, y: numbers,
    anchor: x === 0 ? "top-left" : x === 1 ? "top-right" : "top-center", role: "number", size: 1, tone: "plain"}))];
}
