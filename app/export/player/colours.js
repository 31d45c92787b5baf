// The colour scale that estimate and truth share. Its top is a round number that holds the largest error so far, from
// the first period on, which a recording knows; it only grows, as in app/frame/colour_scale.py.

const {tops: TOPS, decades: DECADES, beyond: BEYOND, smallest: SMALLEST, over: OVER} = DATA.scale;
const {exact: TRUTH, pinned: PINNED, crossing: CROSSING, dot: DOT, axis: AXIS, grid: GRID, ground: GROUND, stem: STEM, unknown: UNKNOWN} = DATA.colours;
const TABLE = Uint8Array.from(atob(DATA.colours.map), (letter) => letter.charCodeAt(0));
const SHADES = Array.from({length: 256}, (_, k) => `rgb(${TABLE[3 * k]},${TABLE[3 * k + 1]},${TABLE[3 * k + 2]})`);

// The largest exact value of the quantity that is looked at, of which errors are shares.
const wholeOf = (run, view) => saidOf(run, view).errors.size;

// The tops of all pictures of a run as it is looked at, also as a share of the whole, and whether something is beyond them.
function topsOf(run, view) {
  const key = ["tops", view.quantity, view.estimator, view.difference].join();
  if (run[key]) return run[key];
  const times = run.tracks.time.values, sizes = [], least = (run.least[view.quantity] || [0])[0], whole = wholeOf(run, view);
  for (let k = 0; k < times.length; k++) {
    const truth = largest(trueSizes(run, view.quantity, k));
    const estimate = largest(estimatedSizes(run, view.quantity, view.estimator, view.difference, k));
    sizes.push([Math.max(truth, estimate), truth > 0 ? Math.max(truth, Math.min(estimate, BEYOND * truth)) : estimate]);
  }
  let peak = Math.max(OVER * least, ...sizes.filter((_, k) => times[k] <= run.period).map(([, size]) => size));
  const tops = sizes.map(([most, size]) => {
    peak = Math.max(peak, size);
    const [rounded, step] = peak > SMALLEST ? roundUp(peak / whole / OVER, TOPS.map(([step]) => step)) : [1, 1], share = Math.min(rounded, 1);
    return {share, top: share * whole, parts: TOPS.find(([other]) => other === (share < 1 ? step : 1))[1], unit: saidOf(run, view).errors.absolute && DATA.quantities[view.quantity].unit, exceeded: most > share * whole};
  });
  return run[key] = tops;
}

const shareOf = (size, scale) => scale.logarithmic ? 1 + Math.log10(size / scale.top) / DECADES : size / scale.top;

function shade(size, scale) {
  const share = shareOf(size, scale);
  return SHADES[share < 0 ? 0 : share < 1 ? Math.floor(255 * share) : 255];
}

// In per cent of the largest exact value, which the last one says where the quantity has a name; where nobody knows that, in the unit.
function ticksOf({share, top, unit, parts, logarithmic, exceeded}, noun) {
  const count = logarithmic ? DECADES : parts, text = (part) => unit ? withUnit(top * part, unit) : `${number(100 * share * part)} %`;
  const ticks = Array.from({length: count + 1}, (_, k) => [k / count, text(logarithmic ? 10 ** (k - DECADES) : k / parts)]), last = ticks[count];
  if (!logarithmic) ticks[0][1] = DATA.scale.zero;
  if (noun && !unit) last[1] = tr("{share} of the largest {noun}", {share: last[1], noun});
  if (exceeded) last[1] = `≥ ${last[1]}`;
  return ticks;
}

// The colour bar; returns its title and its numbers as labels.
function drawColourBar(pen, place, scale, quantity) {
  const {middle, high, numbers} = place.bar, steps = Math.ceil(place.across);
  for (let k = 0; k < steps; k++) {
    pen.fillStyle = SHADES[Math.floor(255 * k / steps)];
    pen.fillRect(place.left + k, place.y(middle + high / 2), Math.min(1.5, steps - k), place.unit * high);
  }
  const ticks = ticksOf(scale, DATA.quantities[quantity].noun), wide = (text) => pen.measureText(text).width / place.unit;
  const free = 0.98 - wide(ticks[ticks.length - 1][1]);  // what the last one says is longer
  const zero = wide(`${ticks[0][1]} `);
  return ticks.filter(([x, text]) => x === 0 || x === 1 || (x - wide(text) / 2 > zero && x + wide(text) / 2 < free)).map(([x, text], k) => ({name: `tick${k}`, text, x, y: numbers,
    anchor: x === 0 ? "top-left" : x === 1 ? "top-right" : "top-center", role: "number", size: 1, tone: "plain"}));
}
