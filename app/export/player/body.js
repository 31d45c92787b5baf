// A body whose exact solution nobody knows: its particles in the colours of their estimated errors, the verdict, and what
// its first goal is about over time, with its bar as a band.

function drawFreeBody(pen, run, view, at, place) {
  const {per_metre: metre, corner} = place, k = Math.floor(at), n = run.shown, [x0, x1, y0, y1] = run.extent;
  const x = (X) => place.x(corner[0] + metre * X), y = (Y) => place.y(corner[1] + metre * Y);
  Object.assign(pen, {strokeStyle: GRID, lineWidth: 1});
  if (run.lines) {
    for (let c = Math.ceil(x0 / run.lines); c <= x1 / run.lines; c++) stroke(pen, [[x(c * run.lines), y(y0)], [x(c * run.lines), y(y1)]]);
    for (let c = Math.ceil(y0 / run.lines); c <= y1 / run.lines; c++) stroke(pen, [[x(x0), y(c * run.lines)], [x(x1), y(c * run.lines)]]);
  }
  const places = row(run.tracks.position, at), sizes = estimatedSizes(run, view.quantity, view.estimator, false, k);
  const scale = {...topsOf(run, view)[k], logarithmic: view.logarithmic};
  for (let p = 0; p < n; p++) {
    pen.fillStyle = sizes && Number.isFinite(sizes[p]) ? shade(sizes[p], scale) : UNKNOWN;
    disc(pen, x(places[p]), y(places[n + p]), metre * place.unit * run.diameter / 2);
  }
  const short = (text) => place.gutter ? text : text.split(":")[0];  // what there is room for
  writeLabels(pen, place, [...drawColourBar(pen, place, scale, view.quantity), ...place.labels], {name: run.name,
    facts: place.gutter ? run.facts[view.quantity][k] : "", quantity: `${DATA.quantities[view.quantity].noun} ${DATA.quantities[view.quantity].symbol}`,
    "estimate-title": short(run.notes[view.quantity][k]), "truth-title": short(run.nobody)});
}

function describeBody() {
  const {run} = stage;
  if (!run) return;
  put(document.getElementById("summary"), run.summary);
  canvas.setAttribute("aria-label", run.summary);
  for (const [id, rows] of [["facts", run.goals], ["norms", run.estimates]]) {
    const made = rows.map((texts) => tableRow(...texts));
    made[0].className = "head";
    document.getElementById(id).replaceChildren(...(made.length > 1 ? made : []));
  }
  const box = document.getElementById("status");
  put(box, run.remarks);
  box.hidden = !run.remarks;
  drawGoal(run);
}

function drawGoal(run) {
  const chart = document.getElementById("chart"), box = chart.getBoundingClientRect(), pixels = window.devicePixelRatio || 1;
  chart.hidden = !run.goal;
  if (!box.width || !run.goal) return;
  chart.width = Math.round(box.width * pixels);
  chart.height = Math.round(box.height * pixels);
  chart.setAttribute("aria-label", run.goal.title);
  const pen = chart.getContext("2d"), {levels, says} = run.goal, times = run.tracks.time.values, values = run.tracks.goal.values;
  pen.scale(pixels, pixels);
  Object.assign(pen, {font: "12px 'Lab Inter', system-ui, sans-serif", lineJoin: "round"});
  const left = 58, right = box.width - 8, high = 24, low = box.height - 20, last = levels.length - 1;
  const x = (time) => left + (right - left) * time / run.period, y = (value) => low - (low - high) * (value - levels[0]) / (levels[last] - levels[0]);
  words(pen, run.goal.title, 0, 3, "left", "top");
  pen.strokeStyle = GRID;
  levels.forEach((level, k) => {
    stroke(pen, [[left, y(level)], [right, y(level)]]);
    if (k % Math.ceil(last / 4) === 0) words(pen, says[k], left - 5, y(level), "right", "middle", DATA.colours.tones.plain);
  });
  words(pen, "0", left, low + 4, "left", "top", DATA.colours.tones.plain);
  words(pen, `${number(run.period)} s`, right, low + 4, "right", "top", DATA.colours.tones.plain);
  const points = Array.from(times, (time, k) => [x(time), values[2 * k], values[2 * k + 1]]), sure = points.filter(([, , bar]) => Number.isFinite(bar));
  pen.fillStyle = DATA.colours.estimate;
  pen.globalAlpha = 0.4;
  pen.beginPath();
  for (const [across, value, bar] of sure) pen.lineTo(across, Math.min(y(value + bar), y(value) - 2));
  for (const [across, value, bar] of sure.reverse()) pen.lineTo(across, Math.max(y(value - bar), y(value) + 2));
  pen.fill();
  pen.globalAlpha = 1;
  Object.assign(pen, {strokeStyle: DOT, lineWidth: 2});
  stroke(pen, points.map(([across, value]) => [across, y(value)]));
  Object.assign(pen, {strokeStyle: DATA.colours.tones.plain, lineWidth: 1});
  stroke(pen, [[x(stage.time), high - 4], [x(stage.time), low]]);
}

stage.onChange.push(describeBody);
