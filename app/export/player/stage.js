// The stage: which run of a lattice is on it, at what time, and its drawing.

const stage = {
  plan: null,      // of DATA.stages
  chosen: [],      // the value of each axis, by its number
  run: null, pinned: null, refusal: "",
  view: null,
  time: 0, playing: false, last: 0,
  onChange: [],    // called when another run, view or picture is shown
};

const canvas = document.getElementById("stage");
const flatNumber = (plan, chosen) => plan.axes.reduce((sum, axis, k) => sum * axis.values.length + chosen[k], 0);

// Put one of the stages of the file on it, from its beginning.
async function putOnStage(id, play) {
  const plan = DATA.stages[id];
  Object.assign(stage, {plan, run: null, chosen: plan.axes.map((axis) => axis.start), view: {...plan.view}, time: 0, playing: false});
  stage.pinned = plan.pinned === null ? null : await recording(plan.pinned);
  document.body.classList.add("has-stage");
  buildControls();
  await choose();
  setPlaying(play);
}

// Show the run that the sliders say, at the time that is shown.
async function choose() {
  const found = stage.plan.runs[flatNumber(stage.plan, stage.chosen)];
  stage.refusal = typeof found === "string" ? found : "";
  if (!stage.refusal) {
    const run = await recording(found);
    if (stage.plan.runs[flatNumber(stage.plan, stage.chosen)] !== found) return;  // another one has been chosen since
    stage.run = run;
    stage.time = Math.min(stage.time, endOf(run));
  }
  changed();
}

const endOf = (run) => run.tracks.time.values[run.tracks.time.rows - 1];

// Which picture of a run is shown at a time: a number between two where the time is.
function pictureAt(run, time) {
  const times = run.tracks.time.values;
  let low = 0, high = times.length - 1;
  if (time >= times[high]) return high;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= time) low = middle; else high = middle;
  }
  return low + Math.max(0, time - times[low]) / (times[high] - times[low]);
}

function setPlaying(wanted) {
  if (wanted && stage.run && stage.time >= endOf(stage.run)) stage.time = 0;
  stage.playing = wanted && !stage.refusal;
  stage.last = 0;
  if (stage.playing) requestAnimationFrame(play);
  changed();
}

function play(now) {
  if (!stage.playing) return;
  const passed = stage.last ? Math.min(0.1, (now - stage.last) / 1000) : 0;
  stage.last = now;
  stage.time += passed * stage.view.speed * stage.run.period;
  if (stage.time >= endOf(stage.run)) {
    stage.time = endOf(stage.run);
    stage.playing = false;
  }
  changed();
  if (stage.playing) requestAnimationFrame(play);
}

function changed() {
  for (const act of stage.onChange) act();
}

// What is said of a run as it is looked at (app/export/texts.py).
function saidOf(run, view) {
  const {rows, field, by} = run.texts[view.quantity], {captions, errors} = by[view.estimator] || Object.values(by)[0];
  return {rows, field, ...captions[+view.difference], errors};
}

// Particles that have changed their cell since the start; none if these are too many to see.
function changedAt(run, time) {
  const who = run.tracks["crossings.who"].values, when = run.tracks["crossings.time"].values;
  const changed = new Set([...who].filter((_, k) => when[k] <= time).map(Math.round));
  return changed.size > DATA.most_changed * run.shown ? [] : [...changed];
}

function draw() {
  const box = canvas.getBoundingClientRect(), pixels = window.devicePixelRatio || 1;
  if (!box.width || !stage.run) return;
  canvas.width = Math.round(box.width * pixels);
  canvas.height = Math.round(box.height * pixels);
  const pen = canvas.getContext("2d"), {run, view} = stage, at = pictureAt(run, stage.time);
  pen.scale(pixels, pixels);
  const place = placeOf(run.problem, box.width, box.height);
  pen.font = fontOf(place.letters);
  if (stage.refusal) {
    const step = 1.4 * place.letters;
    linesOf(pen, capital(stage.refusal), 0.7 * box.width).forEach((line, k) => words(pen, line, box.width / 2, box.height / 2 + step * k, "center"));
    return;
  }
  if (run.extent) {
    drawFreeBody(pen, run, view, at, place);
    return;
  }
  const said = saidOf(run, view), pinned = stage.pinned && {run: stage.pinned, at: pictureAt(stage.pinned, stage.time)};
  const sizes = [estimatedSizes(run, view.quantity, view.estimator, view.difference, at), trueSizes(run, view.quantity, at)];
  const shown = sizes.map((each, half) => !said.silences[half] && each && each.some(Number.isFinite) ? each : null);
  const changed = changedAt(run, stage.time), scale = {...topsOf(run, view)[Math.floor(at)], logarithmic: view.logarithmic};
  const measured = drawColourBar(pen, place, scale, view.quantity);
  (place.radius ? drawBody : drawLanes)(pen, run, view, at, place, {scale, changed, sizes: shown});
  const field = place.field ? drawField(pen, run, pinned, view, at, said.field, place, changed)
    : drawErrors(pen, run, place, ticksOf(scale), shown, scale, said.titles);
  const halves = ["estimate", "truth"].flatMap((half, k) => [[`${half}-title`, said.titles[k]], [`${half}-by`, said.by[k]], [`${half}-silence`, said.silences[k]]]);
  const alike = place.gutter && shown[0] && shown[1] && !view.difference && !isBroken(run) ? DATA.problems[run.problem].alike : "";
  writeLabels(pen, place, [...measured, ...place.labels], {...Object.fromEntries(halves), alike, ...titleOf(pen, run, view, place),
    quantity: `${DATA.quantities[view.quantity].noun} ${DATA.quantities[view.quantity].symbol}`, "size-note": run.note, "crossings-note": run.marks, ...field});
}

stage.onChange.push(draw);
new ResizeObserver(draw).observe(canvas);
