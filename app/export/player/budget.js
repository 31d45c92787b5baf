// Who made the error: parts of it stacked over time, as app/frame/budget_chart_data.py has them, and each cause's share over the run.

const made = document.getElementById("made"), {causes: CAUSES, fields: FIELDS, units: FIELD_UNITS, seen: PART_SEEN} = DATA.budget;

function budget() {
  const {run, view} = stage, there = Boolean(run && run.budget), box = document.getElementById("budget");
  box.hidden = !there;
  if (!there) return;
  const field = FIELDS.includes(view.quantity) ? view.quantity : FIELDS[FIELDS.length - 1], {shares, causes, not_valid: silence} = run.budget;
  const rows = Object.entries(CAUSES).map(([cause, {meaning, colour}]) => {
    const row = tableRow(causes[cause], percent(shares[field][cause])), swatch = element("i");
    swatch.style.background = colour;
    row.firstChild.prepend(swatch);
    row.firstChild.append(element("small", ` ${meaning}`));
    return row;
  });
  const head = tableRow(tr("share of the error of {field} over the run", {field}) + run.budget.whose
    + (rows.some(row => row.lastChild.textContent.startsWith("−")) ? DATA.budget.below : ""), "");
  head.className = "head";
  document.getElementById("causes").replaceChildren(...silence ? [] : [head, ...rows]);
  put(document.getElementById("divided"), silence ? capital(silence) + "." : DATA.budget.caption);
  made.hidden = Boolean(silence);
  if (!silence) drawMade(run, field);
}

// Whole per cent, as the page says them: 97 %, −4 %.
const percent = (share) => share === null ? NOTHING : `${(Math.round(100 * share) || 0)} %`.replace("-", "−");

// Of each picture the error, and of each cause the edges of its layer above and below zero.
function layersOf(run, field) {
  const {values, width} = run.tracks[`budget.${field}`], names = Object.keys(CAUSES), count = values.length / width;
  const at = (column) => Array.from({length: count}, (_, k) => Number.isFinite(values[k * width + column]) ? values[k * width + column] : 0);
  const error = at(0), most = largest(error), zero = error.map(() => 0), layers = [];
  let up = zero, down = zero;
  names.forEach((cause, c) => {
    const part = at(c + 1);
    if (Math.max(...part.map(Math.abs)) <= PART_SEEN * most) return;
    const above = up.map((edge, k) => edge + Math.max(part[k], 0)), below = down.map((edge, k) => edge + Math.min(part[k], 0));
    layers.push([CAUSES[cause].colour, up, above], [CAUSES[cause].colour, down, below]);
    [up, down] = [above, below];
  });
  return {error, layers, top: Math.max(largest(up), most), low: Math.min(...down)};
}

function drawMade(run, field) {
  const box = made.getBoundingClientRect(), pixels = window.devicePixelRatio || 1, unit = FIELD_UNITS[field];
  if (!box.width) return;
  made.width = Math.round(box.width * pixels);
  made.height = Math.round(box.height * pixels);
  const pen = made.getContext("2d"), times = Array.from(run.tracks.time.values), {error, layers, top: most, low} = layersOf(run, field);
  pen.scale(pixels, pixels);
  Object.assign(pen, {font: "12px 'Lab Inter', system-ui, sans-serif", lineJoin: "round"});
  const top = most > 0 ? roundUp(most, AXIS_STEPS)[0] : 1, end = times[times.length - 1] || 1;
  const left = 58, right = box.width - 8, high = 24, floor = box.height - 20;
  const x = (time) => left + (right - left) * time / end, y = (size) => high + (floor - high) * (top - size) / (top - low);
  const points = (edge) => edge.map((size, k) => [x(times[k]), y(size)]);
  words(pen, tr("error of {field}, RMS over particles", {field}), 0, 3, "left", "top");
  pen.strokeStyle = "#e2e5eb";
  for (const size of [0, top / 2, top]) {
    if (size) stroke(pen, [[left, y(size)], [right, y(size)]]);
    words(pen, !size ? "0" : unit ? withUnit(size, unit) : number(size), left - 5, y(size), "right", "middle", "#454b58");
  }
  for (const [colour, inner, outer] of layers) {
    pen.beginPath();
    [...points(outer), ...points(inner).reverse()].forEach(([along, down]) => pen.lineTo(along, down));
    pen.fillStyle = colour;
    pen.fill();
  }
  Object.assign(pen, {strokeStyle: "#15171c", lineWidth: 1.4});
  stroke(pen, points(error));
  words(pen, "0", left, floor + 4, "left", "top", "#454b58");
  words(pen, counted(end, run), right, floor + 4, "right", "top", "#454b58");
  Object.assign(pen, {strokeStyle: "#454b58", lineWidth: 1});
  stroke(pen, [[left, y(0)], [right, y(0)]]);
  stroke(pen, [[x(stage.time), high - 4], [x(stage.time), floor]]);
}

stage.onChange.push(budget);
