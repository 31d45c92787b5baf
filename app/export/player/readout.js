// Numbers of the run that is shown: time, norms, index and distance of each estimator, its status, and norms over time.

const COLUMN = Object.fromEntries(Object.keys(DATA.quantities).map((key, k) => [key, k]));
const ROWS = {true: tr("true"), estimated: tr("estimated")};  // beside those of estimators
const chart = document.getElementById("chart");
function cell(run, track, at, quantity) {
  const found = run.tracks[track];
  return found ? found.values[Math.floor(at) * found.width + COLUMN[quantity]] : NaN;
}

function readout() {
  const {run, view} = stage;
  if (!run) return;
  const at = pictureAt(run, stage.time), quantity = DATA.quantities[view.quantity], time = stage.time;
  const told = [[tr("time"), tr("{time} s = {periods} periods", {time: number(time, 4), periods: fixed(time / run.period, 2)})],
    [tr("steps"), tr("{count} of {step}", {count: whole(time / run.step), step: withUnit(run.step, "s")})],
    [tr("step"), marginText(run.tracks.margin.values[Math.floor(at)])],
    [tr("crossings"), Number.isFinite(run.tracks.crossed.values[Math.floor(at)])
      ? tr("{count} so far", {count: whole(run.tracks.crossed.values[Math.floor(at)])}) : DATA.sentences.not_counted],
    [tr("shown"), run.shown < run.particles ? tr("{shown} of {all} particles", {shown: run.shown, all: whole(run.particles)})
      : tr("{all} particles", {all: run.particles})]];
  document.getElementById("facts").replaceChildren(...told.map(([name, text]) => tableRow(name, text)));
  const rows = [tableRow(tr("error of {symbol}", quantity), tr("norm"), tr("index"), tr("distance"))];
  rows[0].className = "head";
  const norm = (track, of = run, when = at) => known(cell(of, track, when, view.quantity), withUnit, quantity.unit);
  for (const [name, silence] of Object.entries(saidOf(run, view).rows)) {
    const own = name === "true", ratios = own ? ["", ""] : ["index", "distance"].map((kind) => short(cell(run, `${kind}.${name}`, at, view.quantity)));
    const made = silence ? silentRow(ROWS[name] || name, silence) : tableRow(ROWS[name] || name, norm(`norm.${name}`), ...ratios);
    rows.push(DATA.estimators[name] ? marked(made, ...lookOf(name)) : own ? marked(made, TRUTH, []) : made);
  }
  if (stage.pinned) {
    const other = pictureAt(stage.pinned, time);
    rows.push(marked(tableRow(tr("pinned"), norm("norm.true", stage.pinned, other), "", ""), PINNED, []));
  }
  document.getElementById("norms").replaceChildren(...rows);
  status(run);
  drawChart(run, view);
}

// A time as an axis counts it: in periods, but where nothing swings.
function counted(time, run) {
  const periods = number(time / run.period);
  return run.moves_on ? `${number(time)} s` : periods === "1" ? tr("1 period") : tr("{periods} periods", {periods});
}

// The step over the bound of what the present configuration bears; beyond 1 it will not hold.
const marginText = (margin) => Number.isFinite(margin) ? tr("{ratio} of its bound", {ratio: ratio(margin)}) : NOTHING;

// A ratio in a column: else it would seem to go on from the number before.
const short = (value) => known(value, ratio).replace(" × ", "×");

const lookOf = (name) => [DATA.estimators[name].colour, DATA.estimators[name].dashes];

// A row that says why there is no number.
function silentRow(name, silence) {
  const made = tableRow(name, silence);
  made.className = "silent";
  made.lastChild.colSpan = 3;
  return made;
}

// A row with the line that stands for it in the chart.
function marked(row, colour, dashes) {
  const line = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  line.setAttribute("viewBox", "0 0 18 6");
  line.setAttribute("aria-hidden", "true");
  const path = document.createElementNS("http://www.w3.org/2000/svg", "path");
  for (const [name, value] of Object.entries({d: "M0 3H18", stroke: colour, "stroke-width": 3, "stroke-dasharray": dashes.join(" ")}))
    path.setAttribute(name, value);
  line.append(path);
  row.firstChild.prepend(line);
  return row;
}

// What has become of the run, and in a sentence what is seen.
function status(run) {
  const box = document.getElementById("status"), broken = isBroken(run);
  const said = broken || (run.status === "ok" && run.reason);  // ok for positions, not for all
  put(box, !stage.refusal && said ? capital(run.reason) + "." : "");
  box.hidden = !box.textContent;
  put(document.getElementById("title"), stage.plan.says[flatNumber(stage.plan, stage.chosen)] || "");
  put(document.getElementById("summary"), summary(run));
  canvas.setAttribute("aria-label", summary(run));
}

const isBroken = (run) => run.status !== "ok" && run.since <= stage.time + run.step;

function summary(run) {
  if (stage.refusal) return capital(stage.refusal) + ".";
  const {unstable, last, lost, now, paused} = DATA.sentences, when = {time: number(stage.time)};
  const sentences = run.status === "unstable" && stage.time >= endOf(run) ? [fill(unstable, when), last]
    : errors(run, stage.view, stage.playing ? now : fill(paused, when));
  if (isBroken(run) && sentences[1] !== last) sentences[0] = `${fill(lost, {since: number(run.since, 4)})}: ${sentences[0]}`;
  return sentences.filter(Boolean).map((said) => `${capital(said)}.`).join(" ");
}

// A run's title: its name, with the settings where there is room for them, and at the other end facts.
function titleOf(pen, run, view, place) {
  const facts = factsOf(run, view), long = `${run.name}, ${run.settings}`;
  return {name: pen.measureText(long + facts).width < 0.8 * place.unit ? long : run.name, facts};
}

// The facts: how wrong it is, and how much of that the estimate finds, as app/frame/headline.py says it.
function factsOf(run, view) {
  const at = pictureAt(run, stage.time), of = (track) => cell(run, track, at, view.quantity), wrong = of("norm.true") / wholeOf(run, view);
  if (isBroken(run)) return tr("run is lost");
  if (wrong > 1) return tr("over 100 % wrong");
  const index = of(`norm.${view.estimator}`) / of("norm.true"), who = view.estimator, found = index < DATA.sentences.twice
    ? tr("{who} finds {share}", {who, share: perCent(index)}) : tr("{who} estimates {factor} times as much", {who, factor: ratio(index)});
  return [Number.isFinite(wrong) && tr("{wrong} wrong", {wrong: perCent(wrong)}), Number.isFinite(index) && found].filter(Boolean).join(" · ");
}

// How wrong it is now and whether the estimate knows it, and further facts, as app/frame/headline.py says it.
function errors(run, view, before) {
  const said = saidOf(run, view).errors, at = pictureAt(run, stage.time), {unit} = DATA.quantities[view.quantity];
  const of = (track) => cell(run, track, at, view.quantity), truth = of("norm.true"), estimate = of(`norm.${view.estimator}`);
  const {less, more, twice} = DATA.sentences, index = truth ? estimate / truth : NaN, norm = Number.isFinite(truth) ? truth : estimate;
  const size = (value) => withUnit(value, unit, 2);
  if (truth <= said.least) return [before + said.still, fill(said.trace, {true: truth ? size(truth) : tr("zero")})];
  if (!said.told.includes("{wrong}")) return [said.told, said.why];
  if (!Number.isFinite(norm) || (said.told.includes("{found}") && !Number.isFinite(index))) return [before + said.unmeasured, said.why];
  const told = before + said.told.replace("{found}", index >= twice ? more : less);
  return [fill(told, {wrong: perCent(norm / said.size), share: perCent(index), factor: ratio(index), ...said.names}),
    fill(said.of, {true: size(norm)}), said.why];
}

// Norms over time: the truth broad, estimates with their dashes, and a line where the time is.
function drawChart(run, view) {
  const box = chart.getBoundingClientRect(), pixels = window.devicePixelRatio || 1, quantity = DATA.quantities[view.quantity];
  if (!box.width) return;
  chart.width = Math.round(box.width * pixels);
  chart.height = Math.round(box.height * pixels);
  const pen = chart.getContext("2d"), times = run.tracks.time.values, column = COLUMN[view.quantity];
  pen.scale(pixels, pixels);
  Object.assign(pen, {font: "12px 'Lab Inter', system-ui, sans-serif", lineJoin: "round"});
  const lines = [["norm.true", TRUTH, [], 4, run], ...run.estimators.filter((name) => !(name in run.not_valid))
    .map((name) => [`norm.${name}`, ...lookOf(name), 2, run])];
  if (stage.pinned) lines.unshift(["norm.true", PINNED, [], 2, stage.pinned]);
  const norms = ([track, , , , of]) => Array.from(of.tracks.time.values, (_, k) => of.tracks[track].values[4 * k + column] / wholeOf(of, view));
  const truth = largest(norms(lines.find(([track, , , , of]) => track === "norm.true" && of === run)));
  const most = Math.max(...lines.map((line) => largest(norms(line)))), shown = truth > 0 ? Math.min(most, 10 * truth) : most;
  const top = shown > 0 ? roundUp(shown, AXIS_STEPS)[0] : 1, end = times[times.length - 1] || 1;
  const left = 58, right = box.width - 8, high = 24, low = box.height - 20;
  const x = (time) => left + (right - left) * Math.min(time / end, 1), y = (size) => low - (low - high) * Math.min(size / top, 1.02);
  words(pen, tr("error norm of {symbol}", quantity), 0, 3, "left", "top");
  pen.strokeStyle = "#e2e5eb";
  for (const share of [0, 0.5, 1]) {
    stroke(pen, [[left, y(share * top)], [right, y(share * top)]]);
    words(pen, `${number(100 * share * top)} %`, left - 5, y(share * top), "right", "middle", "#454b58");
  }
  words(pen, "0", left, low + 4, "left", "top", "#454b58");
  words(pen, counted(end, run), right, low + 4, "right", "top", "#454b58");
  for (const line of lines) {
    const [, colour, dashes, thickness, of] = line, values = norms(line);
    Object.assign(pen, {strokeStyle: colour, lineWidth: thickness});
    pen.setLineDash(dashes);
    stroke(pen, Array.from(of.tracks.time.values, (time, k) => [x(time), y(values[k])]).filter(([, size]) => Number.isFinite(size)));
  }
  pen.setLineDash([]);
  Object.assign(pen, {strokeStyle: "#454b58", lineWidth: 1});
  stroke(pen, [[x(stage.time), high - 4], [x(stage.time), low]]);
}

stage.onChange.push(readout);
